//! labelme's JSON, a file for each image: shapes with points in px from the picture's corner.
//!
//! A `point` is a landmark (or a point on a line, as its label says), `line` and `linestrip` are
//! points on a line; other shapes are ignored. `imageData`, if present, is a copy of the picture
//! and is not read.

use super::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReader, LabelledFrame, Mark, Sizes, picture_path,
    size_or_option,
};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, folder_prefix, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::{Node, parse};
use serde_json::{Value, json};
use touchline_core::geometry::ImagePoint;

/// The format.
pub struct Labelme;

/// The version of labelme whose files are written.
const VERSION: &str = "6.3.1";

fn to_json(frame: &ClickedFrame) -> Value {
    let shapes = frame.clicks.iter().filter_map(|click| {
        Some(json!({
            "label": click.target.as_ref()?.as_str(),
            "points": [[click.image.x, click.image.y]],
            "group_id": null,
            "shape_type": "point",
            "flags": {},
            "description": "",
            "mask": null,
        }))
    });
    json!({
        "version": VERSION,
        "flags": {},
        "shapes": shapes.collect::<Vec<_>>(),
        "imagePath": frame.image,
        "imageData": null,
        "imageHeight": frame.size.height,
        "imageWidth": frame.size.width,
    })
}

/// The frame of a file. `folder` is the folder from which its image's path starts.
fn read_file(
    bytes: &[u8],
    folder: &str,
    options: &ImportOptions,
    sizes: &Sizes<'_>,
) -> Result<LabelledFrame, Problem> {
    let shift = options.shift_to_corner_px();
    let value = parse(bytes)?;
    let root = Node::root(&value);
    let image = format!(
        "{folder}{}",
        picture_path(root.key("imagePath")?.text()?, options)?
    );
    let stated = root.find_size("imageWidth", "imageHeight")?;
    // labelme counts pixels in the picture as its EXIF orientation shows it. A stated size that
    // differs from the picture's own means that the points are of another orientation or picture.
    // The size of the options is no picture's own.
    let there = sizes(&image);
    if let (Some(stated), Some(there)) = (stated, there)
        && stated != there
    {
        let what = format!(
            "a file of {} × {} px for a picture of {} × {}",
            stated.width, stated.height, there.width, there.height
        );
        return Err(Problem::not_supported(
            what,
            "labelme rotates pictures by their EXIF orientation; save it rotated",
        ));
    }
    let size = size_or_option(&image, stated.or(there), options)?;
    let mut marks = Vec::new();
    for shape in root.key("shapes")?.items()? {
        // Each point of a line is a mark of its label. Boxes, circles and polygons say nothing of a
        // landmark or line.
        let kind = shape.key("shape_type")?.text()?;
        if !matches!(kind, "point" | "points" | "line" | "linestrip") {
            continue;
        }
        let label = shape.key("label")?.text()?.to_owned();
        for point in shape.key("points")?.items()? {
            let [x, y]: [f64; 2] = point.numbers()?;
            marks.push(Mark::new(
                label.clone(),
                ImagePoint::new(x + shift, y + shift),
            ));
        }
    }
    Ok(LabelledFrame::new(
        without_ending(&image),
        Some(image.clone()),
        size,
        marks,
    ))
}

impl ClickFormat for Labelme {
    fn about(&self) -> About {
        About {
            name: "labelme",
            title: "labelme, one file per image",
            conventions: "pixels from the corner",
            users: "labelme, AnyLabeling",
            loses: Some("check points, cameras"),
            file: None,
            files: "labelme files (.json)",
            endings: &["json"],
            export_options: format_options::POINTS_OUT,
            import_options: format_options::LABELS_IN,
        }
    }

    fn name_of(&self, frame: &ClickedFrame) -> String {
        without_ending(&frame.image).to_owned()
    }

    fn write(&self, frames: &[ClickedFrame], _context: &ClickContext<'_>) -> ExchangeResult<Files> {
        let mut files = Files::default();
        for frame in frames {
            let name = format!("{}.json", frame.name);
            files.add(name, format!("{:#}\n", to_json(frame)));
        }
        Ok(files)
    }

    fn read(&self, files: &Files, reading: &LabelReader<'_>) -> ExchangeResult<Vec<LabelledFrame>> {
        let (options, sizes) = (reading.options, reading.sizes);
        files.read_all(|name, bytes| {
            // labelme means a path from the JSON's own folder. A user who says where the images are
            // need not have sorted them as the files.
            let folder = if options.images.is_none() {
                folder_prefix(name)
            } else {
                ""
            };
            Ok(reading.keep(name, None, read_file(bytes, folder, options, sizes)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicked_frame::read_alone;
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{SIZE, export_as, text_of, with_clicks};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn landmarks_and_lines_come_back_in_corner_pixels() {
        let exported = export_as(&with_clicks(), Format::Labelme);
        let file: Value = serde_json::from_str(&text_of(&exported.files, "0001.json")).unwrap();
        assert_eq!(file["shapes"][0]["points"], json!([[444.681, 789.175]]));
        assert_eq!(exported.worst_px, 0.0);
    }

    #[test]
    fn an_image_lies_beside_its_file_unless_the_user_says_where() {
        let text = text_of(
            &export_as(&with_clicks(), Format::Labelme).files,
            "0001.json",
        );
        let mut files = Files::default();
        for name in ["left/0001.json", "right/far/0001.json"] {
            files.add(name, text.clone());
        }
        let mut options = ImportOptions::default();
        for (images, wanted) in [
            (None, ["left/0001.jpg", "right/far/0001.jpg"]),
            (Some("pictures".into()), ["0001.jpg", "0001.jpg"]),
        ] {
            options.images = images;
            let read = read_alone(&Labelme, &files, &options, None).unwrap();
            let named: Vec<Option<&str>> =
                read.iter().map(|frame| frame.image.as_deref()).collect();
            assert_eq!(named, wanted.map(Some));
        }
    }

    #[test]
    fn pictures_whose_files_would_have_one_name_are_refused() {
        let mut document = with_clicks();
        let mut other = (*document.frames[0]).clone();
        other.id = "other".into();
        other.image = Some("images/0001.png".to_owned());
        document.frames.push(other.into());
        let error = export(
            document.at(Path::new("/")),
            Format::Labelme,
            &ExportOptions::default(),
        );
        let said = error.unwrap_err().to_string();
        assert!(
            said.starts_with("0001.jpg and 0001.png would both be written as 0001;"),
            "{said}"
        );
    }

    #[test]
    fn the_size_of_the_options_contradicts_no_file() {
        let files = export_as(&with_clicks(), Format::Labelme).files;
        let options = ImportOptions {
            size: Some(ImageSize::new(1280, 720)),
            ..ImportOptions::default()
        };
        let read = read_alone(&Labelme, &files, &options, None).unwrap();
        assert_eq!(read[0].size, SIZE);
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good: Value = serde_json::from_str(&text_of(
            &export_as(&with_clicks(), Format::Labelme).files,
            "0001.json",
        ))
        .unwrap();
        let with = |pointer: &str, value: Value| {
            let mut all = good.clone();
            *all.pointer_mut(pointer).unwrap() = value;
            all.to_string()
        };
        for (text, size, wanted) in [
            ("{}".to_owned(), None, "imagePath is missing"),
            (
                with("/imagePath", json!("..\\a.jpg")),
                None,
                "the picture \"../a.jpg\" lies outside the folder; give --images FOLDER, where \
                 it is looked for by its name",
            ),
            (
                with("/imagePath", json!(7)),
                None,
                "imagePath: a text is expected, found 7",
            ),
            (
                with("/imageWidth", Value::Null),
                None,
                "the size of \"0001.jpg\" is not known; give --size WIDTHxHEIGHT or --images FOLDER",
            ),
            (
                with("/imageWidth", json!(1e9)),
                None,
                "imageWidth is 1000000000, which must be a whole number from 1 to 65535",
            ),
            (
                with("/imageWidth", json!(1080)),
                Some(SIZE),
                "a file of 1080 × 1080 px for a picture of 1920 × 1080 cannot be read: labelme rotates pictures by their EXIF orientation; save it rotated",
            ),
            (
                with("/shapes", json!(1)),
                None,
                "shapes: a list is expected, found 1",
            ),
            (
                with("/shapes/0/label", Value::Null),
                None,
                "shapes[0].label: a text is expected, found null",
            ),
            (
                with("/shapes/0/points", json!([[1.0]])),
                None,
                "shapes[0].points[0] (numbers): 2 are expected, found 1",
            ),
            (
                with("/shapes/0/points/0/0", json!("x")),
                None,
                "shapes[0].points[0][0]: a number is expected, found the text \"x\"",
            ),
        ] {
            let files = Files::one("a.json", text.into_bytes());
            let error = read_alone(&Labelme, &files, &ImportOptions::default(), size)
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.json: {wanted}"));
        }
    }
}
