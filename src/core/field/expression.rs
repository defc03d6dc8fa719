//! Arithmetic expressions over a template's parameters, such as `length_m/2 - 16.5`, parsed by
//! recursive descent. They are data and cannot run code.
//!
//! Grammar: `sum = product (("+" | "-") product)*`, `product = factor (("*" | "/") factor)*`,
//! `factor = "-" factor | number | name | "sqrt" "(" sum ")" | "(" sum ")"`.

use std::collections::BTreeMap;
use std::fmt;
use thiserror::Error;

/// Maximum length of an expression, which also bounds the depth of the tree.
const MAX_CHARACTERS: usize = 400;
/// Maximum nesting depth of parentheses and signs, which bounds the recursion of the parser.
const MAX_DEPTH: usize = 32;

/// What is wrong with an expression; positions count characters from 1.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// Nothing but blanks.
    #[error("the expression is empty")]
    Empty,
    /// More text than any dimension needs.
    #[error("the expression has {characters} characters, more than {MAX_CHARACTERS}")]
    TooLong {
        /// How many it has.
        characters: usize,
    },
    /// Parentheses within parentheses without end.
    #[error("more than {MAX_DEPTH} nested parentheses or signs at position {position}")]
    TooDeep {
        /// Where the limit is passed.
        position: usize,
    },
    /// An unexpected character or word.
    #[error("unexpected {found} at position {position}: {wanted} was expected")]
    Unexpected {
        /// The character or word found.
        found: String,
        /// Its position.
        position: usize,
        /// What was expected.
        wanted: &'static str,
    },
    /// A parenthesis is never closed.
    #[error("the \"(\" at position {position} is never closed")]
    Unclosed {
        /// Where it was opened.
        position: usize,
    },
    /// A number that cannot be read, such as `1.2.3`.
    #[error("{text:?} at position {position} is not a number")]
    BadNumber {
        /// As written.
        text: String,
        /// Where it starts.
        position: usize,
    },
    /// A name that is neither a parameter nor a dimension.
    #[error("unknown name {name:?} at position {position} (known here: {known})")]
    UnknownName {
        /// As written.
        name: String,
        /// Where it starts.
        position: usize,
        /// The names that exist, in order.
        known: String,
    },
    /// The divisor is zero.
    #[error("division by zero at position {position}")]
    DivisionByZero {
        /// The position of the sign.
        position: usize,
    },
    /// The root of a negative number.
    #[error("square root of the negative number {value} at position {position}")]
    NegativeRoot {
        /// The number.
        value: f64,
        /// The position of `sqrt`.
        position: usize,
    },
    /// The result overflows.
    #[error("the result is not a finite number")]
    NotFinite,
}

/// A parsed expression.
#[derive(Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: Node,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Name {
        name: String,
        position: usize,
    },
    Negated(Box<Node>),
    Root {
        of: Box<Node>,
        position: usize,
    },
    Binary {
        operator: Operator,
        left: Box<Node>,
        right: Box<Node>,
        position: usize,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl Expression {
    /// Reads an expression.
    ///
    /// # Errors
    /// An unexpected token, with its position.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        // Characters, not bytes, because errors state positions in characters.
        let characters = text.chars().count();
        if characters > MAX_CHARACTERS {
            return Err(ExpressionError::TooLong { characters });
        }
        if text.trim().is_empty() {
            return Err(ExpressionError::Empty);
        }
        let mut parser = Parser {
            characters: text.chars().collect(),
            at: 0,
        };
        // A sum that ends before the text does is an error: "2 3" begins with a valid sum.
        let root = parser.sum(0)?;
        match parser.peek() {
            None => Ok(Self {
                text: text.to_owned(),
                root,
            }),
            Some(_) => Err(parser.syntax_error("an operator or the end")),
        }
    }

    /// A plain number.
    pub fn number(value: f64) -> Self {
        Self {
            text: value.to_string(),
            root: Node::Number(value),
        }
    }

    /// The expression as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The value, with the names of `scope` and those of `more`.
    ///
    /// # Errors
    /// An unknown name, a division by zero, the root of a negative number, or overflow.
    pub fn evaluate(
        &self,
        scope: &BTreeMap<String, f64>,
        more: &[(&str, f64)],
    ) -> Result<f64, ExpressionError> {
        // Checked once at the end: infinity and NaN propagate to the result, unless a number is
        // divided by infinity.
        let value = Scope { names: scope, more }.evaluate(&self.root)?;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ExpressionError::NotFinite)
        }
    }
}

/// The names that an expression may use, with their values.
struct Scope<'a> {
    names: &'a BTreeMap<String, f64>,
    more: &'a [(&'a str, f64)],
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}

impl Scope<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        let more = self
            .more
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, value)| *value);
        more.or_else(|| self.names.get(name).copied())
    }

    /// The value of a part. The recursion is bounded: the tree is not deeper than the text has
    /// characters.
    fn evaluate(&self, node: &Node) -> Result<f64, ExpressionError> {
        match node {
            Node::Number(value) => Ok(*value),
            Node::Name { name, position } => self.value(name).ok_or_else(|| {
                let known = self
                    .names
                    .keys()
                    .map(String::as_str)
                    .chain(self.more.iter().map(|(name, _)| *name));
                let known = known.collect::<Vec<_>>().join(", ");
                ExpressionError::UnknownName {
                    name: name.clone(),
                    position: *position,
                    known,
                }
            }),
            Node::Negated(of) => Ok(-self.evaluate(of)?),
            Node::Root { of, position } => {
                let value = self.evaluate(of)?;
                if value < 0.0 {
                    return Err(ExpressionError::NegativeRoot {
                        value,
                        position: *position,
                    });
                }
                Ok(value.sqrt())
            }
            Node::Binary {
                operator,
                left,
                right,
                position,
            } => {
                let (left, right) = (self.evaluate(left)?, self.evaluate(right)?);
                match operator {
                    Operator::Add => Ok(left + right),
                    Operator::Subtract => Ok(left - right),
                    Operator::Multiply => Ok(left * right),
                    Operator::Divide if right == 0.0 => Err(ExpressionError::DivisionByZero {
                        position: *position,
                    }),
                    Operator::Divide => Ok(left / right),
                }
            }
        }
    }
}

struct Parser {
    characters: Vec<char>,
    at: usize,
}

impl Parser {
    /// The next character that is not blank, without taking it.
    fn peek(&mut self) -> Option<char> {
        while self
            .characters
            .get(self.at)
            .is_some_and(|c| c.is_whitespace())
        {
            self.at += 1;
        }
        self.characters.get(self.at).copied()
    }

    fn position(&self) -> usize {
        self.at + 1
    }

    fn syntax_error(&mut self, wanted: &'static str) -> ExpressionError {
        // The debug form escapes what a terminal would obey; the quotes are those of the message.
        let found = self.peek().map_or_else(
            || "end".to_owned(),
            |c| format!("{c:?}").replace('\'', "\""),
        );
        ExpressionError::Unexpected {
            found,
            position: self.position(),
            wanted,
        }
    }

    fn sum(&mut self, depth: usize) -> Result<Node, ExpressionError> {
        self.chain(depth, Self::product, |c| match c {
            '+' => Some(Operator::Add),
            '-' => Some(Operator::Subtract),
            _ => None,
        })
    }

    fn product(&mut self, depth: usize) -> Result<Node, ExpressionError> {
        self.chain(depth, Self::factor, |c| match c {
            '*' => Some(Operator::Multiply),
            '/' => Some(Operator::Divide),
            _ => None,
        })
    }

    /// Operands joined by operators of one precedence, left-associative.
    fn chain(
        &mut self,
        depth: usize,
        operand: fn(&mut Self, usize) -> Result<Node, ExpressionError>,
        operator_of: fn(char) -> Option<Operator>,
    ) -> Result<Node, ExpressionError> {
        // A loop instead of recursion, which would make `a - b - c` mean a − (b − c).
        let mut left = operand(self, depth)?;
        while let Some(operator) = self.peek().and_then(operator_of) {
            let position = self.position();
            self.at += 1;
            let right = operand(self, depth)?;
            left = Node::Binary {
                operator,
                left: Box::new(left),
                right: Box::new(right),
                position,
            };
        }
        Ok(left)
    }

    fn factor(&mut self, depth: usize) -> Result<Node, ExpressionError> {
        // Blanks are skipped before the position is taken.
        let next = self.peek();
        let position = self.position();
        // Every recursion of the parser leads through a factor, so the depth is checked here alone.
        if depth > MAX_DEPTH {
            return Err(ExpressionError::TooDeep { position });
        }
        match next {
            Some('-') => {
                self.at += 1;
                Ok(Node::Negated(Box::new(self.factor(depth + 1)?)))
            }
            Some('(') => self.parenthesis(depth),
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(position),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => {
                // Whether the name exists shows when the expression is evaluated: dimensions are
                // known only then.
                let name = self.take_while(|c| c.is_ascii_alphanumeric() || c == '_');
                if name != "sqrt" {
                    return Ok(Node::Name { name, position });
                }
                if self.peek() != Some('(') {
                    return Err(self.syntax_error("the \"(\" of sqrt"));
                }
                Ok(Node::Root {
                    of: Box::new(self.parenthesis(depth)?),
                    position,
                })
            }
            _ => Err(self.syntax_error("a number, a name or \"(\"")),
        }
    }

    /// `( sum )`; the opening parenthesis is next.
    fn parenthesis(&mut self, depth: usize) -> Result<Node, ExpressionError> {
        let position = self.position();
        self.at += 1;
        let inside = self.sum(depth + 1)?;
        match self.peek() {
            Some(')') => {
                self.at += 1;
                Ok(inside)
            }
            None => Err(ExpressionError::Unclosed { position }),
            Some(_) => Err(self.syntax_error("an operator or \")\"")),
        }
    }

    fn number(&mut self, position: usize) -> Result<Node, ExpressionError> {
        // Without an exponent: rule books state plain decimals.
        let text = self.take_while(|c| c.is_ascii_digit() || c == '.');
        let value: f64 = text
            .parse()
            .map_err(|_| ExpressionError::BadNumber { text, position })?;
        Ok(Node::Number(value))
    }

    fn take_while(&mut self, belongs: fn(char) -> bool) -> String {
        let taken: String = self.characters[self.at..]
            .iter()
            .take_while(|c| belongs(**c))
            .collect();
        self.at += taken.chars().count();
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(text: &str) -> Result<f64, String> {
        let scope = BTreeMap::from([("length_m".to_owned(), 105.0), ("width_m".to_owned(), 68.0)]);
        Expression::parse(text)
            .and_then(|expression| expression.evaluate(&scope, &[]))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn arithmetic_is_the_usual_one() {
        for (text, expected) in [
            ("length_m/2 - 16.5", 36.0),
            ("-length_m / 2 + 11", -41.5),
            ("2 + 3 * 4 - 6 / 3", 12.0),
            ("10 - 4 - 3", 3.0),
            ("24 / 4 / 3", 2.0),
            ("-(width_m - 8) * --2", -120.0),
            ("sqrt(9.15*9.15 - 5.5*5.5)", 7.312_489_316_231_510_5),
            (" .5+ 1. ", 1.5),
        ] {
            assert!((value(text).unwrap() - expected).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn every_mistake_has_its_message_and_position() {
        let long = "1+".repeat(300);
        let deep = "(".repeat(60);
        for (text, message) in [
            ("  ", "the expression is empty"),
            (
                "length_m/2 -",
                "unexpected end at position 13: a number, a name or \"(\" was expected",
            ),
            (
                "2 * * 3",
                "unexpected \"*\" at position 5: a number, a name or \"(\" was expected",
            ),
            (
                "2 3",
                "unexpected \"3\" at position 3: an operator or the end was expected",
            ),
            ("(1 + 2", "the \"(\" at position 1 is never closed"),
            (
                "1 + 2)",
                "unexpected \")\" at position 6: an operator or the end was expected",
            ),
            (
                "(1 2)",
                "unexpected \"2\" at position 4: an operator or \")\" was expected",
            ),
            ("1.2.3", "\"1.2.3\" at position 1 is not a number"),
            (
                "sqrt 4",
                "unexpected \"4\" at position 6: the \"(\" of sqrt was expected",
            ),
            (
                "1 + lenght_m",
                "unknown name \"lenght_m\" at position 5 (known here: length_m, width_m)",
            ),
            ("1 / (length_m - 105)", "division by zero at position 3"),
            (
                "2*sqrt(1 - 2)",
                "square root of the negative number -1 at position 3",
            ),
            (
                "system(1)",
                "unexpected \"(\" at position 7: an operator or the end was expected",
            ),
            (
                "2^3",
                "unexpected \"^\" at position 2: an operator or the end was expected",
            ),
            (&long, "the expression has 600 characters, more than 400"),
            (
                &deep,
                "more than 32 nested parentheses or signs at position 34",
            ),
            ("1/0.0", "division by zero at position 2"),
        ] {
            assert_eq!(value(text).unwrap_err(), message, "{text}");
        }
        let huge = format!("{0}*{0}", "9".repeat(190));
        assert_eq!(
            value(&huge).unwrap_err(),
            "the result is not a finite number"
        );
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC{0,80}") {
            let _ = value(&text);
        }

        #[test]
        fn arithmetic_text_never_panics(text in "[-+*/(). 0-9a-z_]{0,60}") {
            let _ = value(&text);
        }
    }
}
