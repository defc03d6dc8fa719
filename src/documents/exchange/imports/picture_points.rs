//! Points of interest in pictures: where players stand, from the boxes of other programs.
//!
//! | file | frames | point |
//! |---|---|---|
//! | MOT: lines `frame,id,left,top,width,height,…` | counted from 1 | the middle of the box's lower side |
//! | CSV with the columns `frame`, `x`, `y`, and perhaps `w`, `h` | counted from 0, or names of pictures | `x`, `y`; with a box the middle of its lower side |
//! | CVAT's XML: boxes of images and of tracks | names of pictures; counted from 0 | the middle of the box's lower side |
//!
//! Pixels count from the picture's corner.

use crate::document::Frame;
use crate::exchange::click_formats::cvat::{
    Element, attribute, number_attribute, parse_annotations,
};
use crate::exchange::error::{ExchangeError, Problem};
use crate::exchange::files::{Files, no_files, stem, text};
use crate::exchange::syntax::table::{Table, TableRow, number};
use crate::exchange::syntax::values::frame_number;
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::geometry::ImagePoint;

/// The least numbers in a line of MOT.
const MOT_NUMBERS: usize = 6;

/// Points by the frames that show them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PicturePoints {
    /// By the number of the frame, counted from 0.
    by_number: BTreeMap<u64, Vec<ImagePoint>>,
    /// By the name of the picture without folders and ending.
    by_name: BTreeMap<String, Vec<ImagePoint>>,
}

impl PicturePoints {
    /// The points of a frame at a position of its document: those of its picture's name, else those
    /// of its number.
    pub fn for_frame(&self, frame: &Frame, position: usize) -> &[ImagePoint] {
        let name = frame.image.as_deref().map(stem);
        let by_name = name.and_then(|name| self.by_name.get(name));
        by_name
            .or_else(|| self.by_number.get(&frame.number_at(position)))
            .map_or(&[], Vec::as_slice)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        let lists = self.by_number.values().chain(self.by_name.values());
        lists.map(Vec::len).sum()
    }

    fn add(&mut self, frame: FrameName, point: ImagePoint) {
        match frame {
            FrameName::Number(number) => self.by_number.entry(number).or_default().push(point),
            FrameName::Picture(name) => self.by_name.entry(name).or_default().push(point),
        }
    }
}

/// How a file names a frame.
enum FrameName {
    /// Counted from 0.
    Number(u64),
    /// The picture's name without folders and ending.
    Picture(String),
}

/// Reads the points of a file in MOT's format, a table, or CVAT's XML.
///
/// # Errors
/// It cannot be read, is of none of these formats, has no point, or a number is none.
pub fn read_picture_points(path: &Path) -> Result<PicturePoints, ExchangeError> {
    let files = Files::read(path, &|_| false)?;
    let Some((name, bytes)) = files.sorted_entries().into_iter().next() else {
        return Err(no_files(path, "points; name the file itself"));
    };
    let points = points_of(bytes).map_err(|problem| problem.within(name))?;
    if points.count() == 0 {
        return Err(Problem::Missing("a box or point".to_owned()).within(name));
    }
    Ok(points)
}

fn points_of(bytes: &[u8]) -> Result<PicturePoints, Problem> {
    let text = text(bytes)?;
    // XML is known by its first letter, a table by a column `frame` in its header. MOT has no
    // header; whatever else a file is, its first line then fails as one of MOT.
    let first = text.lines().next().unwrap_or_default();
    if text.trim_start().starts_with('<') {
        points_of_cvat(text)
    } else if first.split(',').any(is_frame_column) {
        points_of_table(bytes)
    } else {
        points_of_mot(text)
    }
}

/// Whether a column of a header is that of the frames. Some programs quote every name.
fn is_frame_column(column: &str) -> bool {
    column.trim().trim_matches('"') == "frame"
}

fn points_of_mot(text: &str) -> Result<PicturePoints, Problem> {
    let mut points = PicturePoints::default();
    let lines = text.lines().enumerate();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let point = point_of_mot(line).map_err(|problem| problem.at_line(index + 1))?;
        points.add(FrameName::Number(point.0), point.1);
    }
    Ok(points)
}

/// The frame of a line, counted from 0, and the foot of its box.
fn point_of_mot(line: &str) -> Result<(u64, ImagePoint), Problem> {
    let fields: Vec<&str> = line.split(',').collect();
    let &[frame, _, left, top, width, height, ..] = &fields[..] else {
        return Err(Problem::wrong_count(
            "numbers (frame, id, left, top, width, height)",
            MOT_NUMBERS,
            fields.len(),
        ));
    };
    // MOT counts frames from 1, this program from 0.
    let counted = frame_number("frame", number("frame", frame)?)?;
    let frame = counted.checked_sub(1).ok_or_else(|| {
        Problem::out_of_range("frame", 0.0, "1 or more, for MOT counts frames from 1")
    })?;
    let corner = [number("left", left)?, number("top", top)?];
    let sides = [number("width", width)?, number("height", height)?];
    Ok((frame, foot_of_box(corner, sides)))
}

/// The middle of the lower side of a box, by its upper left corner and its sides.
fn foot_of_box([left, top]: [f64; 2], [width, height]: [f64; 2]) -> ImagePoint {
    ImagePoint::new(left + 0.5 * width, top + height)
}

fn points_of_table(bytes: &[u8]) -> Result<PicturePoints, Problem> {
    let table = Table::read(bytes)?;
    table.needs(&["frame", "x", "y"])?;
    // Without a box the point itself is meant: a box without extent has its foot there.
    let has_box = table.needs(&["w", "h"]).is_ok();
    let mut points = PicturePoints::default();
    for row in table.rows() {
        let at = [row.number("x")?, row.number("y")?];
        let sides = if has_box {
            [row.number("w")?, row.number("h")?]
        } else {
            [0.0, 0.0]
        };
        points.add(frame_of_row(&row)?, foot_of_box(at, sides));
    }
    Ok(points)
}

/// The frame of a row: a number, else a picture's name.
fn frame_of_row(row: &TableRow<'_>) -> Result<FrameName, Problem> {
    let frame = row.text("frame").ok_or_else(|| row.missing("frame"))?;
    // A name of digits alone is a number: trackers count frames, and pictures have endings.
    match number("frame", frame) {
        Ok(value) => frame_number("frame", value)
            .map(FrameName::Number)
            .map_err(|problem| problem.at_line(row.line())),
        Err(_) => Ok(FrameName::Picture(stem(frame).to_owned())),
    }
}

fn points_of_cvat(text: &str) -> Result<PicturePoints, Problem> {
    let xml = parse_annotations(text)?;
    let mut points = PicturePoints::default();
    for element in xml.root_element().children() {
        match element.tag_name().name() {
            "image" => {
                let name = stem(attribute(element, "name")?).to_owned();
                for of_image in boxes(element) {
                    points.add(FrameName::Picture(name.clone()), foot_of(of_image)?);
                }
            }
            "track" => {
                for of_track in boxes(element) {
                    let frame = number_attribute(of_track, "frame")?;
                    let frame = FrameName::Number(frame_number("frame", frame)?);
                    points.add(frame, foot_of(of_track)?);
                }
            }
            _ => {}
        }
    }
    Ok(points)
}

/// The boxes within an image or track that are in the picture.
fn boxes(parent: Element<'_>) -> impl Iterator<Item = Element<'_>> {
    parent
        .children()
        .filter(|child| child.has_tag_name("box") && child.attribute("outside") != Some("1"))
}

/// The middle of the lower side of CVAT's box.
fn foot_of(element: Element<'_>) -> Result<ImagePoint, Problem> {
    let [left, right] = [
        number_attribute(element, "xtl")?,
        number_attribute(element, "xbr")?,
    ];
    Ok(ImagePoint::new(
        0.5 * (left + right),
        number_attribute(element, "ybr")?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::VideoFrame;
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn video_frame(index: u64) -> Frame {
        Frame::from_video(
            VideoFrame::new("match.mp4", index, None),
            "main".into(),
            SIZE,
        )
    }

    #[test]
    fn boxes_of_all_formats_have_their_feet() {
        let foot = [ImagePoint::new(110.0, 240.0)];
        let mot = points_of(b"1,7,100,200,20,40,1,-1,-1,-1\n2,7,0,0,2,2,1,-1,-1,-1\n").unwrap();
        assert_eq!(mot.for_frame(&video_frame(0), 5), foot);
        assert_eq!(
            (mot.count(), mot.for_frame(&video_frame(2), 0).len()),
            (2, 0)
        );
        let csv = points_of(b"frame,x,y,w,h\n17,100,200,20,40\n").unwrap();
        assert_eq!(csv.for_frame(&video_frame(17), 0), foot);
        let quoted = points_of(b"\"frame\", \"x\", \"y\"\n17,110,240\n").unwrap();
        assert_eq!(quoted.for_frame(&video_frame(17), 0), foot);
        let csv = points_of(b"frame,x,y\nimages/0017.png,110,240\n").unwrap();
        let picture = Frame::from_image("frames/0017.jpg", "main".into(), SIZE);
        assert_eq!(csv.for_frame(&picture, 0), foot);
        let cvat = points_of(
            br#"<annotations><image name="a/0017.jpg"><box xtl="100" ytl="200" xbr="120" ybr="240"/></image>
            <track><box frame="3" outside="0" xtl="100" ytl="200" xbr="120" ybr="240"/>
            <box frame="4" outside="1" xtl="0" ytl="0" xbr="1" ybr="1"/></track></annotations>"#,
        )
        .unwrap();
        assert_eq!(cvat.for_frame(&picture, 0), foot);
        assert_eq!(cvat.for_frame(&video_frame(3), 0), foot);
        assert_eq!(cvat.count(), 2);
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        for (text, wanted) in [
            (
                "1,2,3\n",
                "line 1: numbers (frame, id, left, top, width, height): 6 are expected, found 3",
            ),
            (
                "0,1,2,3,4,5\n",
                "line 1: frame is 0, which must be 1 or more, for MOT counts frames from 1",
            ),
            (
                "1,1,2,x,4,5\n",
                "line 1: top: a number is expected, found \"x\"",
            ),
            ("frame,x\n1,2\n", "the column y is missing"),
            ("<a/>", "not CVAT's XML: it begins with <a>"),
        ] {
            assert_eq!(points_of(text.as_bytes()).unwrap_err().to_string(), wanted);
        }
    }
}
