//! A plain table with a point a row: `frame,label,x,y`; or a JSON object with the points of one
//! picture, `{"LABEL": [x, y]}`. Import only.
//!
//! What scripts, spreadsheets and digitizing programs write. Pixels count from the picture's corner
//! unless `--pixels` says otherwise; `width` and `height` may state the picture's size.

use super::clicked_frame::{
    ClickFormat, LabelReader, LabelledFrame, Mark, picture_path, size_or_option,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, ending_of, stem};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::table::{Table, TableRow};
use crate::exchange::syntax::values::side_px;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The format.
pub struct PointsTable;

/// The columns that a table of points has.
pub const COLUMNS: [&str; 4] = ["frame", "label", "x", "y"];

/// The size that a row states.
fn size_of(row: &TableRow<'_>) -> Result<Option<ImageSize>, Problem> {
    let Some((width, height)) = row.find("width")?.zip(row.find("height")?) else {
        return Ok(None);
    };
    let size = side_px("width", width).and_then(|width| Ok((width, side_px("height", height)?)));
    let (width, height) = size.map_err(|problem| problem.at_line(row.line()))?;
    Ok(Some(ImageSize::new(width, height)))
}

/// The σ that a row states.
fn sigma_of(sigma_px: f64) -> Result<f64, Problem> {
    if sigma_px > 0.0 {
        return Ok(sigma_px);
    }
    Err(Problem::out_of_range("sigma_px", sigma_px, "positive"))
}

/// The point of a row.
fn mark_of(row: &TableRow<'_>, options: &ImportOptions) -> Result<Mark, Problem> {
    let shift_px = options.shift_to_corner_px();
    let label = row.text("label").ok_or_else(|| row.missing("label"))?;
    let at = ImagePoint::new(row.number("x")? + shift_px, row.number("y")? + shift_px);
    let mut mark = Mark::new(label.to_owned(), at);
    // Only points of models have these; a column of labels may be called so, too.
    if options.model.is_some() {
        if let Some(probability) = row.find("p")? {
            mark = mark.with_probability(probability)?;
        }
        if let Some(sigma_px) = row.find("sigma_px")? {
            mark.sigma_px = Some(sigma_of(sigma_px)?);
        }
    }
    Ok(mark)
}

fn read_table(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<Vec<LabelledFrame>, Problem> {
    let table = Table::read(bytes)?;
    table.needs(&COLUMNS)?;
    let mut frames: Vec<LabelledFrame> = Vec::new();
    let mut at: BTreeMap<String, usize> = BTreeMap::new();
    for row in table.rows() {
        let name = row.text("frame").ok_or_else(|| row.missing("frame"))?;
        let name = picture_path(name, reading.options)?;
        let index = if let Some(index) = at.get(&name) {
            *index
        } else {
            let own = size_of(&row)?.or_else(|| (reading.sizes)(&name));
            at.insert(name.clone(), frames.len());
            frames.push(LabelledFrame::new(
                &name,
                Some(name.clone()),
                size_or_option(&name, own, reading.options)?,
                Vec::new(),
            ));
            frames.len() - 1
        };
        let read = mark_of(&row, reading.options);
        let frame = &mut frames[index];
        let mark = reading.keep(file, Some(&frame.name), read);
        frame.marks.extend(mark);
    }
    Ok(frames)
}

/// The points of one picture, which has the name of the file.
fn read_object(
    (file, bytes): (&str, &[u8]),
    reading: &LabelReader<'_>,
) -> Result<LabelledFrame, Problem> {
    let value = parse(bytes)?;
    let shift_px = reading.options.shift_to_corner_px();
    let (mut marks, name) = (Vec::new(), stem(file).to_owned());
    for (label, point) in Node::root(&value).entries()? {
        let read = point.numbers::<2>().map(|[x, y]| {
            let at = ImagePoint::new(x + shift_px, y + shift_px);
            Mark::new(label.to_owned(), at)
        });
        marks.extend(reading.keep(file, Some(&name), read));
    }
    Ok(LabelledFrame::new(
        &name,
        None,
        size_or_option(&name, (reading.sizes)(&name), reading.options)?,
        marks,
    ))
}

impl ClickFormat for PointsTable {
    fn about(&self) -> About {
        About {
            name: "points",
            title: "a table of points: frame, label, x, y",
            conventions: "pixels from the corner",
            users: "scripts, spreadsheets, digitizing programs, sportslabkit's key points",
            loses: None,
            file: Some("points.csv"),
            files: "points (.csv, .json)",
            endings: &["csv", "json"],
            export_options: &[],
            import_options: format_options::LABELS_IN,
        }
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        files.read_all(|file, bytes| {
            if ending_of(file) == "json" {
                return Ok(vec![read_object((file, bytes), reading)?]);
            }
            read_table((file, bytes), reading)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::{LabelReading, read_alone, read_labels};
    use super::*;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn files(text: &str) -> Files {
        Files::one("a.csv", text.as_bytes().to_vec())
    }

    #[test]
    fn rows_of_a_frame_are_its_points() {
        let text = "frame,label,x,y\na.jpg,centre_mark,640.5,360\nb.jpg,halfway_line,1,2\na.jpg,halfway_line,3,4\n";
        let options = ImportOptions {
            pixels: Some(crate::exchange::options::Pixels::Centre),
            ..ImportOptions::default()
        };
        let frames = read_alone(&PointsTable, &files(text), &options, Some(SIZE)).unwrap();
        assert_eq!(frames.len(), 2);
        assert_eq!((frames[0].name.as_str(), frames[0].size), ("a.jpg", SIZE));
        assert_eq!(frames[0].marks[0].image, ImagePoint::new(641.0, 360.5));
        assert_eq!(frames[0].marks[1].label, "halfway_line");
    }

    #[test]
    fn a_table_may_state_sizes_and_says_what_it_lacks() {
        let text = "frame,label,x,y,width,height\n7,centre_mark,1,2,1280,720\n7,centre_mark,many,2,1280,720\n";
        let reading = LabelReading {
            options: &ImportOptions::default(),
            sizes: &|_| None,
        };
        let (frames, unread) = read_labels(&PointsTable, &files(text), &reading).unwrap();
        assert_eq!((frames[0].size, frames[0].marks.len()), (SIZE, 1));
        let said = unread.describe(1).unwrap();
        assert!(
            said.ends_with("7 (line 3: x: a number is expected, found \"many\")"),
            "{said}"
        );
        for (text, wanted) in [
            (
                "frame,label,x,y\na,b,1,2\n",
                "a.csv: the size of \"a\" is not known; give --size WIDTHxHEIGHT or --images \
                 FOLDER",
            ),
            (
                "frame,name,x,y\na,b,1,2\n",
                "a.csv: the column label is missing",
            ),
        ] {
            let error = read_alone(&PointsTable, &files(text), &ImportOptions::default(), None);
            assert_eq!(error.unwrap_err().to_string(), wanted);
        }
    }
}
