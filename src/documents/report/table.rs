//! Tables, written as aligned text, Markdown, CSV and JSON.

use serde_json::Value;
use std::fmt::{self, Write as _};
use touchline_core::geometry::text_cell;

/// A table with named columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns, from left to right.
    pub columns: Vec<Column>,
    /// The rows. Each has one cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its key in CSV and JSON, including the unit: `rotation_deg`.
    pub key: String,
    /// Its heading in text and Markdown, including the unit. Empty for a column that only CSV and
    /// JSON have.
    pub label: String,
}

impl Column {
    /// A column by its key and its heading.
    pub fn new(key: &str, label: &str) -> Self {
        Self {
            key: key.to_owned(),
            label: label.to_owned(),
        }
    }
}

/// The content of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// No measurement.
    Empty,
    /// Text.
    Text(String),
    /// A count.
    Count(usize),
    /// A number: four significant digits in text and Markdown, all digits in files.
    Number(f64),
    /// A number: this number of decimals in text and Markdown, all digits in files.
    Fixed(f64, usize),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// As in text and Markdown: rounded.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("–"),
            Self::Text(text) => f.write_str(text),
            Self::Count(count) => count.fmt(f),
            Self::Fixed(number, decimals) if number.is_finite() => write!(f, "{number:.decimals$}"),
            Self::Number(number) | Self::Fixed(number, _) => f.write_str(&significant(*number)),
        }
    }
}

impl Cell {
    /// As in CSV: the shortest number that reads back exactly, and text that a spreadsheet does not
    /// evaluate as a formula.
    pub fn exact(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text_cell(text),
            Self::Count(count) => count.to_string(),
            Self::Number(number) | Self::Fixed(number, _) => number.to_string(),
        }
    }

    fn value(&self) -> Value {
        match self {
            Self::Empty => Value::Null,
            Self::Text(text) => Value::from(text.as_str()),
            Self::Count(count) => Value::from(*count),
            // JSON has no infinity, so a number that is not finite becomes null.
            Self::Number(number) | Self::Fixed(number, _) => Value::from(*number),
        }
    }

    /// The number in the cell; none for text and for no measurement.
    pub const fn number(&self) -> Option<f64> {
        match self {
            Self::Empty | Self::Text(_) => None,
            Self::Count(count) => Some(*count as f64),
            Self::Number(number) | Self::Fixed(number, _) => Some(*number),
        }
    }
}

/// A number with four significant digits, without an exponent between a millionth and a million.
pub fn significant(number: f64) -> String {
    if !number.is_finite() {
        let symbol = if number.is_nan() {
            "–"
        } else if number > 0.0 {
            "∞"
        } else {
            "-∞"
        };
        return symbol.to_owned();
    }
    if number == 0.0 {
        return "0".to_owned();
    }
    // The exponent of the rounded number, because rounding may add a digit before the point: 9.9996
    // is 10.00.
    let rounded = format!("{number:.3e}");
    let (_, exponent) = rounded.split_once('e').unwrap_or_default();
    let Ok(exponent @ -6..6) = exponent.parse::<i32>() else {
        return rounded;
    };
    // Three digits follow the first one, which stands at 10^exponent. From 1000 on all digits
    // before the point are shown, for a zero in their place would be wrong.
    let digits = (3 - exponent).max(0) as usize;
    format!("{number:.digits$}")
}

impl Table {
    /// An empty table with these columns.
    pub fn new(columns: &[(&str, &str)]) -> Self {
        Self {
            columns: columns
                .iter()
                .map(|(key, label)| Column::new(key, label))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<Cell>) {
        debug_assert_eq!(row.len(), self.columns.len(), "a cell for each column");
        self.rows.push(row);
    }

    /// Adds the rows of another table with the same columns; an empty table takes these over.
    pub fn append(&mut self, other: Self) {
        self.columns = other.columns;
        self.rows.extend(other.rows);
    }

    /// Adds a column on the right. Rows without a cell in `cells` get an empty one.
    #[must_use]
    pub fn with_column(
        mut self,
        key: &str,
        label: &str,
        cells: impl IntoIterator<Item = Cell>,
    ) -> Self {
        self.columns.push(Column::new(key, label));
        let mut cells = cells.into_iter();
        for row in &mut self.rows {
            row.push(cells.next().unwrap_or(Cell::Empty));
        }
        self
    }

    /// Aligned columns for a terminal.
    pub fn to_text(&self) -> String {
        let shown = self.with_shown_columns();
        let cells: Vec<Vec<String>> = shown
            .rows
            .iter()
            .map(|row| row.iter().map(ToString::to_string).collect())
            .collect();
        let labels: Vec<String> = shown
            .columns
            .iter()
            .map(|column| column.label.clone())
            .collect();
        // Widths are in characters, not bytes: labels have signs such as ° and σ.
        let widths: Vec<usize> = labels
            .iter()
            .enumerate()
            .map(|(column, label)| {
                let texts = cells.iter().map(|row| &row[column]).chain([label]);
                texts.map(|text| text.chars().count()).max().unwrap_or(0)
            })
            .collect();
        let rows = cells.iter().map(|row| shown.align_line(row, &widths));
        shown.align_line(&labels, &widths) + &rows.collect::<String>()
    }

    /// The table without the columns that only files have.
    fn with_shown_columns(&self) -> Self {
        let shown: Vec<usize> = (0..self.columns.len())
            .filter(|&column| !self.columns[column].label.is_empty())
            .collect();
        Self {
            columns: shown
                .iter()
                .map(|&column| self.columns[column].clone())
                .collect(),
            rows: self
                .rows
                .iter()
                .map(|row| shown.iter().map(|&column| row[column].clone()).collect())
                .collect(),
        }
    }

    /// The texts of a row, each as wide as its column.
    fn align_line(&self, texts: &[String], widths: &[usize]) -> String {
        let padded = texts.iter().enumerate().map(|(column, text)| {
            let fill = " ".repeat(widths[column].saturating_sub(text.chars().count()));
            if self.is_right(column) {
                format!("{fill}{text}")
            } else {
                format!("{text}{fill}")
            }
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    }

    /// A Markdown table.
    pub fn to_markdown(&self) -> String {
        let shown = self.with_shown_columns();
        let mut out = markdown_line(shown.columns.iter().map(|column| column.label.clone()));
        let rules = (0..shown.columns.len())
            .map(|column| if shown.is_right(column) { "--:" } else { "---" });
        // Writing to a string cannot fail.
        let _ = writeln!(out, "|{}|", rules.collect::<Vec<_>>().join("|"));
        for row in &shown.rows {
            out.push_str(&markdown_line(row.iter().map(ToString::to_string)));
        }
        out
    }

    /// Comma-separated values (RFC 4180) with the keys in the first line. Cells without a
    /// measurement are empty; infinity is `inf`.
    pub fn to_csv(&self) -> String {
        let mut out = csv_line(self.columns.iter().map(|column| column.key.clone()));
        for row in &self.rows {
            out.push_str(&csv_line(row.iter().map(Cell::exact)));
        }
        out
    }

    /// A JSON array with one object for each row. Empty cells are left out.
    pub fn to_json(&self) -> Value {
        Value::Array(self.rows.iter().map(|row| self.object(row)).collect())
    }

    /// A row as a JSON object.
    fn object(&self, row: &[Cell]) -> Value {
        let filled = self
            .columns
            .iter()
            .zip(row)
            .filter(|(_, cell)| **cell != Cell::Empty);
        Value::Object(
            filled
                .map(|(column, cell)| (column.key.clone(), cell.value()))
                .collect(),
        )
    }

    /// The index of a column by its key.
    pub fn column(&self, key: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.key == key)
    }

    /// Whether a column contains numbers, and is therefore aligned to the right.
    fn is_right(&self, column: usize) -> bool {
        self.rows.iter().any(|row| row[column].number().is_some())
    }
}

/// A row of a Markdown table.
fn markdown_line(texts: impl Iterator<Item = String>) -> String {
    let escaped: Vec<String> = texts.map(|text| text.replace('|', "\\|")).collect();
    format!("| {} |\n", escaped.join(" | "))
}

/// A row of comma-separated values. Texts with commas, quotes or line breaks are quoted.
fn csv_line(texts: impl Iterator<Item = String>) -> String {
    let quoted: Vec<String> = texts
        .map(|text| {
            if text.contains(['"', ',', '\n', '\r']) {
                format!("\"{}\"", text.replace('"', "\"\""))
            } else {
                text
            }
        })
        .collect();
    quoted.join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&[
            ("name", "Name"),
            ("error_px", "Error (px)"),
            ("count", "Frames"),
        ]);
        table.push(vec!["a, \"b\"".into(), 0.012_345_678.into(), 3.into()]);
        table.push(vec!["c|d".into(), Cell::Empty, 12.into()]);
        table
    }

    #[test]
    fn a_column_without_a_heading_is_in_files_only() {
        let table = table().with_column("sd", "", [Cell::Number(0.5)]);
        assert!(table.to_csv().starts_with("name,error_px,count,sd\n"));
        assert!(table.to_csv().lines().nth(1).unwrap().ends_with(",3,0.5"));
        assert!(!table.to_markdown().contains("0.5") && !table.to_text().contains("0.5"));
        assert_eq!((table.column("sd"), table.column("none")), (Some(3), None));
    }

    #[test]
    fn text_is_aligned_and_markdown_escaped() {
        assert_eq!(
            table().to_text(),
            "Name    Error (px)  Frames\n\
             a, \"b\"     0.01235       3\n\
             c|d              –      12\n"
        );
        assert_eq!(
            table().to_markdown(),
            "| Name | Error (px) | Frames |\n|---|--:|--:|\n| a, \"b\" | 0.01235 | 3 |\n| c\\|d | – | 12 |\n"
        );
    }

    #[test]
    fn files_keep_every_digit() {
        assert_eq!(
            table().to_csv(),
            "name,error_px,count\n\"a, \"\"b\"\"\",0.012345678,3\nc|d,,12\n"
        );
        assert_eq!(
            table().to_json(),
            serde_json::json!([{ "name": "a, \"b\"", "error_px": 0.012345678, "count": 3 }, { "name": "c|d", "count": 12 }])
        );
    }

    #[test]
    fn decimals_are_for_people_and_a_column_is_added_to_every_row() {
        let cells = [Cell::Fixed(0.123_456, 2), Cell::Fixed(f64::NAN, 2)];
        let table = table().with_column("share", "Share", cells);
        assert!(
            table.to_markdown().contains("| 3 | 0.12 |")
                && table.to_markdown().contains("| 12 | – |")
        );
        assert!(
            table.to_csv().contains(",3,0.123456\n")
                && table.to_csv().starts_with("name,error_px,count,share\n")
        );
    }

    #[test]
    fn four_digits_for_people() {
        let shown = [
            0.0,
            1.0,
            12.3456,
            1234.5,
            99_999.4,
            0.001_234_56,
            9.9996,
            -0.5,
            1e-9,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ]
        .map(significant);
        assert_eq!(
            shown,
            [
                "0", "1.000", "12.35", "1234", "99999", "0.001235", "10.00", "-0.5000", "1.000e-9",
                "∞", "-∞", "–"
            ]
        );
    }
}
