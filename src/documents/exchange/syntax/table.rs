//! Tables as text: rows of fields between commas (RFC 4180).

use super::values::{frame_number, shorten};
use crate::exchange::error::Problem;
use crate::exchange::files::text;
use std::fmt::Write as _;
use std::ops::Range;
use touchline_core::geometry::is_formula;

/// The maximum number of columns of a table.
const MAX_COLUMNS: usize = 1000;

/// A table that was read: columns by name.
pub struct Table {
    header: Vec<String>,
    fields: Fields,
}

/// All fields concatenated in one text: separate strings would take several times the memory.
#[derive(Default)]
struct Fields {
    text: String,
    /// The end of each field in the text.
    ends: Vec<usize>,
    /// The number of fields up to the end of each row.
    row_ends: Vec<usize>,
    /// The line in which each row begins, from 1. Empty lines and line breaks within quotes make
    /// it differ from the row's number.
    row_lines: Vec<usize>,
}

impl Fields {
    /// How many rows there are.
    const fn rows(&self) -> usize {
        self.row_ends.len()
    }

    /// The range of the fields of a row, or of the row being read.
    fn row(&self, index: usize) -> Range<usize> {
        let first = index
            .checked_sub(1)
            .map_or(0, |before| self.row_ends[before]);
        first..self.row_ends.get(index).copied().unwrap_or(self.ends.len())
    }

    /// A field by its number.
    fn field(&self, number: usize) -> &str {
        let start = number.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.text[start..self.ends[number]]
    }

    fn end_field(&mut self) {
        self.ends.push(self.text.len());
    }

    /// Ends a row that began in a line; an empty line is none.
    fn end_row(&mut self, line: usize) {
        let row = self.row(self.rows());
        if row.len() == 1 && self.field(row.start).is_empty() {
            self.ends.pop();
        } else {
            self.row_ends.push(self.ends.len());
            self.row_lines.push(line);
        }
    }
}

/// A row and its line.
#[derive(Clone, Copy)]
pub struct TableRow<'a> {
    table: &'a Table,
    /// The header is row 0.
    index: usize,
}

impl Table {
    /// Reads a table with a header.
    ///
    /// # Errors
    /// It is not text, has an open quote, or a row has more or fewer fields than the header.
    pub fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let fields = split(text(bytes)?)?;
        if fields.rows() == 0 {
            return Err(Problem::Empty);
        }
        let header: Vec<String> = fields
            .row(0)
            .map(|number| fields.field(number).trim().to_owned())
            .collect();
        // A field is found by the first column of its name; a second one of the same name would be
        // ignored.
        for (index, name) in header.iter().enumerate() {
            if header[..index].contains(name) {
                return Err(Problem::twice("the column", shorten(name)));
            }
        }
        // With as many fields in each row as in the header, a field is found by its column's
        // position.
        for index in 1..fields.rows() {
            let found = fields.row(index).len();
            if found != header.len() {
                let problem = Problem::wrong_count("fields", header.len(), found);
                return Err(problem.at_line(fields.row_lines[index]));
            }
        }
        Ok(Self { header, fields })
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = TableRow<'_>> {
        (1..self.fields.rows()).map(|index| TableRow { table: self, index })
    }

    /// Rejects a table that lacks one of the given columns.
    ///
    /// # Errors
    /// One is missing; it is named.
    pub fn needs(&self, columns: &[&str]) -> Result<(), Problem> {
        for column in columns {
            if !self.header.iter().any(|name| name == column) {
                return Err(Problem::Missing(format!("the column {column}")));
            }
        }
        Ok(())
    }
}

impl TableRow<'_> {
    /// The line of the file in which the row begins, from 1.
    pub fn line(&self) -> usize {
        self.table.fields.row_lines[self.index]
    }

    /// A field; none where it is empty or the column is missing.
    pub fn text(&self, column: &str) -> Option<&str> {
        let at = self.table.header.iter().position(|name| name == column)?;
        let fields = &self.table.fields;
        let field = Some(fields.field(fields.row(self.index).nth(at)?))
            .filter(|field| !field.is_empty())?;
        // The apostrophe that `text_cell` puts before what a spreadsheet would calculate.
        Some(
            field
                .strip_prefix('\'')
                .filter(|rest| is_formula(rest))
                .unwrap_or(field),
        )
    }

    /// A finite number that may be absent.
    ///
    /// # Errors
    /// The field is not one.
    pub fn find(&self, column: &str) -> Result<Option<f64>, Problem> {
        self.text(column)
            .map(|field| number(column, field).map_err(|problem| problem.at_line(self.line())))
            .transpose()
    }

    /// The frame number in the column `frame_index`, which may be absent.
    ///
    /// # Errors
    /// The field is not one.
    pub fn frame_index(&self) -> Result<Option<u64>, Problem> {
        const COLUMN: &str = "frame_index";
        let number = self.find(COLUMN)?.map(|value| frame_number(COLUMN, value));
        number
            .transpose()
            .map_err(|problem| problem.at_line(self.line()))
    }

    /// A finite number.
    ///
    /// # Errors
    /// The field is empty or not a number.
    pub fn number(&self, column: &str) -> Result<f64, Problem> {
        self.find(column)?.ok_or_else(|| self.missing(column))
    }

    /// The error that a field is empty or its column is missing.
    pub(in crate::exchange) fn missing(&self, column: &str) -> Problem {
        Problem::Missing(format!("a value for {column}")).at_line(self.line())
    }
}

/// A finite number of a text.
///
/// # Errors
/// It is none.
pub fn number(what: &str, field: &str) -> Result<f64, Problem> {
    let Ok(value) = field.trim().parse::<f64>() else {
        return Err(Problem::Kind {
            what: what.to_owned(),
            wanted: "a number",
            found: format!("{:?}", shorten(field)),
        });
    };
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Problem::NotFinite(what.to_owned()))
    }
}

/// The numbers of a line, separated by blanks.
///
/// # Errors
/// One of them is not a number.
pub fn numbers(what: &str, line: &str) -> Result<Vec<f64>, Problem> {
    line.split_whitespace()
        .map(|field| number(what, field))
        .collect()
}

/// The fields of a text, without empty lines.
fn split(text: &str) -> Result<Fields, Problem> {
    let mut fields = Fields::default();
    let mut quoted = false;
    let (mut line, mut row_line) = (1, 1);
    // Letter by letter, because RFC 4180 allows commas, line breaks and doubled quotes within
    // quotes, so that neither lines nor commas can be split first.
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                fields.text.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => {
                fields.end_field();
                if fields.row(fields.rows()).len() >= MAX_COLUMNS {
                    let found = format!("line {row_line} has more than {MAX_COLUMNS} columns");
                    return Err(Problem::not_format("a table", found));
                }
            }
            // Lines may end as on Windows.
            '\r' if !quoted && letters.peek() == Some(&'\n') => {}
            '\n' if !quoted => {
                fields.end_field();
                fields.end_row(row_line);
                line += 1;
                row_line = line;
            }
            other => {
                line += usize::from(other == '\n');
                fields.text.push(other);
            }
        }
    }
    if quoted {
        return Err(Problem::not_format("a table", "a quote is never closed"));
    }
    // The last line may lack its line break.
    fields.end_field();
    fields.end_row(row_line);
    Ok(fields)
}

/// The text of a field; empty where there is no value.
pub fn field_text(value: Option<impl ToString>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

/// Writes a row; fields with commas, quotes or line breaks are quoted.
pub fn push_row(fields: &[String], into: &mut String) {
    for (index, field) in fields.iter().enumerate() {
        let comma = if index > 0 { "," } else { "" };
        // Writing to a string cannot fail.
        let _ = if field.contains([',', '"', '\n', '\r']) {
            write!(into, "{comma}\"{}\"", field.replace('"', "\"\""))
        } else {
            write!(into, "{comma}{field}")
        };
    }
    into.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::text_cell;

    #[test]
    fn fields_with_commas_and_quotes_come_back() {
        let fields = ["a,b", "say \"so\"", "", "1.5"].map(ToOwned::to_owned);
        let mut text = "w,x,y,z\n".to_owned();
        push_row(&fields, &mut text);
        let table = Table::read(text.as_bytes()).unwrap();
        let row = table.rows().next().unwrap();
        assert_eq!(row.text("w"), Some("a,b"));
        assert_eq!(row.text("x"), Some("say \"so\""));
        assert_eq!(row.text("y"), None);
        assert_eq!(row.number("z"), Ok(1.5));
        assert_eq!(
            row.number("y").unwrap_err().to_string(),
            "line 2: a value for y is missing"
        );
    }

    #[test]
    fn words_are_no_formulas_and_come_back() {
        assert_eq!(text_cell("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        for words in [
            "=1+1", "+1", "-a.jpg", "@a", "'=1", "''=1", "'a", "a=1", "\t=1",
        ] {
            let mut table = "w,x\n".to_owned();
            push_row(&[text_cell(words), "1".to_owned()], &mut table);
            let table = Table::read(table.as_bytes()).unwrap();
            assert_eq!(table.rows().next().unwrap().text("w"), Some(words));
        }
    }

    #[test]
    fn a_row_is_named_by_the_line_in_which_it_begins() {
        let table = Table::read(b"a,b\r\n\n\"1\n2\",3\n4,x\n").unwrap();
        let lines: Vec<usize> = table.rows().map(|row| row.line()).collect();
        assert_eq!(lines, [3, 5]);
        let said = table.rows().nth(1).unwrap().number("b").unwrap_err();
        assert_eq!(
            said.to_string(),
            "line 5: b: a number is expected, found \"x\""
        );
    }

    #[test]
    fn damaged_tables_are_named() {
        let said = |text: &str| {
            Table::read(text.as_bytes())
                .map(drop)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(said("a,b\n1\n"), "line 2: fields: 2 are expected, found 1");
        assert_eq!(said("a,a\n1,2\n"), "the column \"a\" occurs twice");
        assert_eq!(said("a,b\n\"1,2\n"), "not a table: a quote is never closed");
        assert_eq!(said(" \n"), "the file is empty");
    }
}
