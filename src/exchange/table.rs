//! Tables as text: rows of fields between commas (RFC 4180).

use super::error::Problem;
use super::files::text;
use super::values::{clipped, frame_number};
use std::fmt::Write as _;

/// The most columns of a table.
const MAX_COLUMNS: usize = 1000;

/// A table that was read: columns by name.
pub struct Table {
    header: Vec<String>,
    rows: Vec<Box<[String]>>,
}

/// A row and its line.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    table: &'a Table,
    index: usize,
}

impl Table {
    /// Reads a table with a header.
    ///
    /// # Errors
    /// It is no text, has an open quote, or a row has more or fewer fields than the header.
    pub fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let mut rows = split(text(bytes)?)?.into_iter();
        let header = rows.next().ok_or(Problem::Empty)?.into_vec();
        for (index, name) in header.iter().enumerate() {
            if header[..index].contains(name) {
                return Err(Problem::Twice { what: "the column", name: clipped(name) });
            }
        }
        let rows: Vec<Box<[String]>> = rows.collect();
        for (index, row) in rows.iter().enumerate() {
            if row.len() != header.len() {
                let problem = Problem::Count { what: "fields".to_owned(), wanted: header.len(), found: row.len() };
                return Err(problem.at_line(index + 2));
            }
        }
        Ok(Self { header, rows })
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.rows.len()).map(|index| Row { table: self, index })
    }

    /// Refuses a table without one of some columns.
    ///
    /// # Errors
    /// One is missing; it is named.
    pub fn needs(&self, columns: &[&str]) -> Result<(), Problem> {
        let is_there = |column: &&&str| self.header.iter().any(|name| name == **column);
        let missing = columns.iter().find(|column| !is_there(column));
        missing.map_or(Ok(()), |column| Err(Problem::Missing(format!("the column {column}"))))
    }
}

impl Row<'_> {
    /// The line of the row in the file, where no field holds a line break.
    #[must_use]
    pub const fn line(&self) -> usize {
        self.index + 2
    }

    /// A field; none where it is empty or the column is missing.
    #[must_use]
    pub fn text(&self, column: &str) -> Option<&str> {
        let at = self.table.header.iter().position(|name| name == column)?;
        let field = self.table.rows[self.index].get(at).map(String::as_str).filter(|field| !field.is_empty())?;
        Some(field.strip_prefix('\'').filter(|rest| is_formula(rest)).unwrap_or(field))
    }

    /// A finite number that may be absent.
    ///
    /// # Errors
    /// The field is none.
    pub fn find(&self, column: &str) -> Result<Option<f64>, Problem> {
        self.text(column).map(|field| number(column, field).map_err(|problem| problem.at_line(self.line()))).transpose()
    }

    /// The number of the frame, in the column `frame_index`, that may be absent.
    ///
    /// # Errors
    /// The field is none.
    pub fn frame_index(&self) -> Result<Option<u64>, Problem> {
        const COLUMN: &str = "frame_index";
        let number = self.find(COLUMN)?.map(|value| frame_number(COLUMN, value));
        number.transpose().map_err(|problem| problem.at_line(self.line()))
    }

    /// A finite number.
    ///
    /// # Errors
    /// The field is empty or none.
    pub fn number(&self, column: &str) -> Result<f64, Problem> {
        let missing = || Problem::Missing(format!("a value for {column}")).at_line(self.line());
        self.find(column)?.ok_or_else(missing)
    }
}

/// A finite number of a text.
///
/// # Errors
/// It is none.
pub fn number(what: &str, field: &str) -> Result<f64, Problem> {
    let parsed: Result<f64, _> = field.trim().parse();
    let wrong = |_| Problem::Kind { what: what.to_owned(), wanted: "a number", found: format!("{:?}", clipped(field)) };
    let value = parsed.map_err(wrong)?;
    if value.is_finite() { Ok(value) } else { Err(Problem::NotFinite(what.to_owned())) }
}

/// The numbers of a line between blanks.
///
/// # Errors
/// One of them is none.
pub fn numbers(what: &str, line: &str) -> Result<Vec<f64>, Problem> {
    line.split_whitespace().map(|field| number(what, field)).collect()
}

/// Rows of fields; they are boxed, as a table may have many short ones.
fn split(text: &str) -> Result<Vec<Box<[String]>>, Problem> {
    let mut rows: Vec<Box<[String]>> = Vec::new();
    let (mut row, mut field) = (Vec::new(), String::new());
    let mut quoted = false;
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                field.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => {
                row.push(std::mem::take(&mut field));
                if row.len() >= MAX_COLUMNS {
                    let found = format!("line {} has more than {MAX_COLUMNS} columns", rows.len() + 1);
                    return Err(Problem::NotFormat { wanted: "a table", found });
                }
            }
            '\r' if !quoted && letters.peek() == Some(&'\n') => {}
            '\n' if !quoted => {
                row.push(std::mem::take(&mut field));
                rows.push(row.drain(..).collect());
            }
            other => field.push(other),
        }
    }
    if quoted {
        return Err(Problem::NotFormat { wanted: "a table", found: "a quote is never closed".to_owned() });
    }
    if !field.is_empty() || !row.is_empty() {
        row.push(field);
        rows.push(row.into());
    }
    // Empty lines at the end and between.
    rows.retain(|row| row.len() > 1 || row.iter().any(|field| !field.is_empty()));
    Ok(rows)
}

/// Whether a spreadsheet would calculate a cell, or would if apostrophes were taken from its front.
fn is_formula(cell: &str) -> bool {
    cell.trim_start_matches('\'').starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// A cell of somebody's words. One that a spreadsheet would take for a formula and calculate gets an apostrophe in front, which
/// [`Row::text`] takes away again.
#[must_use]
pub fn text_cell(text: &str) -> String {
    if is_formula(text) { format!("'{text}") } else { text.to_owned() }
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
        assert_eq!(row.number("y").unwrap_err().to_string(), "line 2: a value for y is missing");
    }

    #[test]
    fn words_are_no_formulas_and_come_back() {
        assert_eq!(text_cell("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        for words in ["=1+1", "+1", "-a.jpg", "@a", "'=1", "''=1", "'a", "a=1", "\t=1"] {
            let mut table = "w,x\n".to_owned();
            push_row(&[text_cell(words), "1".to_owned()], &mut table);
            let table = Table::read(table.as_bytes()).unwrap();
            assert_eq!(table.rows().next().unwrap().text("w"), Some(words));
        }
    }

    #[test]
    fn damaged_tables_are_named() {
        let said = |text: &str| Table::read(text.as_bytes()).map(drop).unwrap_err().to_string();
        assert_eq!(said("a,b\n1\n"), "line 2: fields: 2 are expected, found 1");
        assert_eq!(said("a,a\n1,2\n"), "the column \"a\" occurs twice");
        assert_eq!(said("a,b\n\"1,2\n"), "not a table: a quote is never closed");
        assert_eq!(said(" \n"), "the file is empty");
    }
}
