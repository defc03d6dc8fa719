//! `calibrate --report`: a page with one row a shot, and a strip of its frames with the field's
//! lines as their cameras project them.

use crate::cli::terminal::output::write_file;
use anyhow::Context as _;
use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage, imageops};
use std::fmt::Write as _;
use std::path::Path;
use touchline_application::scene::shot_list::{ShotRow, shot_rows};
use touchline_calibration::proposals::read_picture;
use touchline_core::field::FieldModel;
use touchline_core::geometry::subsample;
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_documents::document::{Document, Fields, Frame};
use touchline_vision::media::ReadFrames;

/// Number of frames of a shot in its strip.
const FRAMES: usize = 6;
/// Size of a frame in a strip, px.
const SIZE: [u32; 2] = [240, 135];
/// Quality of a strip, per cent.
const QUALITY: u8 = 85;
/// The colour of the lines.
const LINES: Rgb<u8> = Rgb([255, 40, 200]);
/// The name of the page.
const PAGE: &str = "shots.html";

/// Writes the page and the strips into a folder, which is made if it is missing. A document without
/// shots gets an empty table.
///
/// # Errors
/// A field of the document is not valid, or a file exists or cannot be written.
pub fn write_sheets(
    document: &Document,
    documents_folder: &Path,
    reader: &mut dyn ReadFrames,
    folder: &Path,
    force: bool,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let at = document.at(documents_folder);
    let fields = Fields::from_document(at)?;
    let mut rows = String::new();
    for row in shot_rows(document) {
        let name = format!("shot-{:04}.jpg", row.shot + 1);
        let shown = subsample((row.first..=row.last).collect::<Vec<_>>(), FRAMES);
        let mut strip = RgbImage::new(SIZE[0] * FRAMES as u32, SIZE[1]);
        for (place, index) in shown.enumerate() {
            let frame = &document.frames[index];
            let field = fields.for_frame(document, frame);
            // A frame that cannot be read stays black.
            if let Some(picture) = draw_frame(document, documents_folder, reader, frame, field) {
                let left = i64::from(SIZE[0]) * place as i64;
                imageops::replace(&mut strip, &picture, left, 0);
            }
        }
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode_image(&strip)?;
        write_file(&folder.join(&name), &bytes, force)?;
        write_row(&mut rows, document, &row, &name)?;
    }
    let page = format!(
        "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<title>Shots</title>\n<style>body {{ font: \
         14px sans-serif }} td {{ padding: 4px 10px }} th {{ text-align: left; padding: 4px 10px \
         }}</style>\n<table>\n<tr><th>shot<th>frames<th>camera<th>shows<th>right<th>uncertain<th>\
         none<th>to do<th></tr>\n{rows}</table>\n"
    );
    write_file(&folder.join(PAGE), page.as_bytes(), force)
}

/// The row of a shot in the table.
fn write_row(
    page: &mut String,
    document: &Document,
    row: &ShotRow,
    strip: &str,
) -> std::fmt::Result {
    let [first, last] = [row.first, row.last].map(|index| document.frames[index].name());
    let number = |name: String| name.rsplit('#').next().unwrap_or_default().to_owned();
    let cells = [
        (row.shot + 1).to_string(),
        format!("{}–{}", number(first), number(last)),
        row.camera.as_str().to_owned(),
        row.shows.label().to_owned(),
        row.certain.to_string(),
        row.uncertain.to_string(),
        row.none.to_string(),
        row.reason().to_owned(),
    ];
    write!(page, "<tr>")?;
    for cell in cells {
        write!(page, "<td>{}", escape(&cell))?;
    }
    writeln!(page, "<td><img src=\"{strip}\" alt=\"\"></tr>")
}

/// A text within a page.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// A frame in the size of the strip, with the field's lines where it has a camera; none if its
/// picture cannot be read.
fn draw_frame(
    document: &Document,
    folder: &Path,
    reader: &mut dyn ReadFrames,
    frame: &Frame,
    field: &FieldModel,
) -> Option<RgbImage> {
    let picture = read_picture(reader, frame, folder).ok()?;
    let size = picture.size();
    let scale = (f64::from(SIZE[0]) / f64::from(size.width))
        .min(f64::from(SIZE[1]) / f64::from(size.height));
    let mut image = RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let source = |at: u32| ((f64::from(at) + 0.5) / scale) as u32;
        let pixel = picture.pixel(source(x), source(y));
        pixel.map_or(Rgb([0; 3]), |[red, green, blue, _]| Rgb([red, green, blue]))
    });
    let options = MarkingOptions {
        tolerance_px: 1.0 / scale,
        margin_px: 0.0,
        dashes: true,
    };
    let Some(camera) = document.ptz_camera(frame) else {
        return Some(image);
    };
    for line in project_lines(field, &camera, frame.image_size, &options) {
        for ends in line.points.windows(2) {
            let steps = (ends[0].distance_px(ends[1]) * scale).ceil().max(1.0) as u32;
            for step in 0..=steps {
                let share = f64::from(step) / f64::from(steps);
                let [x, y] = [
                    ends[0].x + share * (ends[1].x - ends[0].x),
                    ends[0].y + share * (ends[1].y - ends[0].y),
                ]
                .map(|px| (px * scale).floor());
                if x >= 0.0 && y >= 0.0 && x < f64::from(SIZE[0]) && y < f64::from(SIZE[1]) {
                    image.put_pixel(x as u32, y as u32, LINES);
                }
            }
        }
    }
    Some(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{VideoFrame, VideoShots};
    use touchline_documents::testing::soccer_document;
    use touchline_vision::media::FrameReader;

    #[test]
    fn each_shot_has_a_row_and_a_strip_also_without_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let mut document = soccer_document();
        for index in 0..20 {
            let video = VideoFrame::new("<a>.mp4", index, None);
            let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
            document.frames.push(frame.into());
        }
        let cuts = [(12, touchline_documents::document::ShotKind::Cut)];
        VideoShots::from_cuts(&document, "<a>.mp4", 19, &cuts).write(&mut document);
        let sheets = folder.path().join("sheets");
        let mut reader = FrameReader::new();
        let mut write = |force| write_sheets(&document, folder.path(), &mut reader, &sheets, force);
        write(false).unwrap();
        let page = std::fs::read_to_string(sheets.join(PAGE)).unwrap();
        assert_eq!(page.matches("<tr><td>").count(), 2);
        assert!(page.contains("<td>0–11<td>") && page.contains("shot-0002.jpg"));
        let strip = image::open(sheets.join("shot-0001.jpg")).unwrap();
        assert_eq!((strip.width(), strip.height()), (1440, 135));
        assert!(write(false).is_err() && write(true).is_ok());
        assert_eq!(escape("a <b> & c"), "a &lt;b&gt; &amp; c");
    }
}
