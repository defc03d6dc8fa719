//! `touchline render`: draws a frame with its overlay as the app shows it, off-screen.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, Loaded};
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{
    encode_png, refuse_existing_file, refuse_other_than_png, write_file,
};
use anyhow::{Context as _, bail};
use image::RgbaImage;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_application::render::{Layer, Offscreen, PictureKey, PictureLayer, View};
use touchline_application::scene::field_map::{FieldMap, SURROUND, field_map, picture_from_above};
use touchline_application::scene::overlay::{CameraStatus, OverlayScene, overlay};
use touchline_application::scene::{OverlayStyle, PictureLook};
use touchline_calibration::proposals::read_picture;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{Document, Frame};
use touchline_vision::media::{self, FrameReader};

/// Margin around the field on the field map, m.
const MAP_MARGIN_M: f64 = 5.0;
/// Scale of the field map, px per metre.
const MAP_PX_PER_M: f64 = 12.0;
/// Maximum side of the field map, px; larger fields are drawn at a smaller scale.
const MAP_LONGEST_PX: f64 = 4096.0;
/// Brightness of the frame's picture on the field map.
const MAP_BRIGHTNESS: f32 = 0.8;

/// Renders a frame with its overlay into a PNG, without a window.
#[derive(clap::Args, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// The frame: its image as the document writes it, its file name, or its place in the document,
    /// counted from 0.
    #[arg(long, value_name = "IMAGE_OR_INDEX")]
    frame: String,
    /// The PNG to write.
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
    /// Render the field from above, with the part that the frame shows.
    #[arg(long)]
    top_view: bool,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Renders the frame and writes the PNG. [`Outcome::SomeFailed`] if the frame has no camera, and so
/// no overlay.
///
/// # Errors
/// The document, the frame or its picture cannot be read, there is no graphics adapter, or the PNG
/// cannot be written.
pub fn render(args: &RenderArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_other_than_png("-o", &args.output)?;
    refuse_existing_file(&args.output, args.force)?;
    let Loaded { location, document } = args.document.load(messages)?;
    let frame = find_frame(&document, &args.frame)
        .with_context(|| format!("{}: --frame {}", location.file().display(), args.frame))?;
    let field = document.field_of(frame).model(location.folder())?;
    let picture = read_picture(&mut FrameReader::new(), frame, location.folder())?;
    // A frame without a camera is drawn all the same: its picture and clicks show what is missing.
    let camera = document.ptz_camera(frame);
    let style = OverlayStyle::default();
    let mut offscreen = Offscreen::new()?;
    let disputed = frame
        .solution
        .as_ref()
        .map_or(&[][..], |solution| &solution.disputed);
    let scene = OverlayScene {
        field: &field,
        camera: camera.as_ref(),
        standing: CameraStatus::from_frame(frame),
        image_size: frame.image_size,
        clicks: &frame.clicks,
        selected: None,
        disputed,
        style: &style,
        zoom: 1.0,
    };
    let drawn = if args.top_view {
        render_top_view(&mut offscreen, &scene, &picture)?
    } else {
        render_frame(&mut offscreen, &scene, picture)?
    };
    write_file(&args.output, &encode_png(drawn)?, args.force)?;
    messages.note(&format!(
        "{}: rendered with {}",
        args.output.display(),
        offscreen.adapter()
    ));
    if camera.is_none() {
        messages.frame_failed(
            &frame.name(),
            "it has no camera yet, so no overlay; run `touchline solve` first",
        );
        return Ok(Outcome::SomeFailed);
    }
    Ok(Outcome::Done)
}

/// Draws the picture at its own size, with the overlay over it.
fn render_frame(
    offscreen: &mut Offscreen,
    scene: &OverlayScene<'_>,
    picture: media::Picture,
) -> anyhow::Result<RgbaImage> {
    let ImageSize { width, height } = scene.image_size;
    let view = View {
        pixels_per_point: pixels_per_point(width),
        ..View::one_to_one([width, height])
    };
    let layers = [
        layer(picture, 1.0),
        Layer::Drawing(Arc::new(overlay(scene))),
    ];
    Ok(offscreen.render(&view, SURROUND, &layers)?)
}

/// Draws the field map, with the frame's picture projected onto it.
fn render_top_view(
    offscreen: &mut Offscreen,
    scene: &OverlayScene<'_>,
    picture: &media::Picture,
) -> anyhow::Result<RgbaImage> {
    let map = map_of(scene.field, scene.camera);
    let mut drawing = field_map(scene, &map);
    let mut layers = vec![Layer::Drawing(Arc::new(drawing.ground))];
    if let Some(camera) = scene.camera {
        // The picture shows what is visible; the tint of the visible area would change its colours.
        drawing.over.areas.clear();
        layers.push(layer(
            picture_from_above(picture, scene.field, camera, &map),
            MAP_BRIGHTNESS,
        ));
    }
    layers.push(Layer::Drawing(Arc::new(drawing.over)));
    let ImageSize { width, height } = map.size_px();
    let view = View {
        pixels_per_point: pixels_per_point(width),
        ..View::one_to_one([width, height])
    };
    Ok(offscreen.render(&view, SURROUND, &layers)?)
}

/// The field map at the standard scale, or a smaller one for large fields, rotated towards the
/// camera.
fn map_of(field: &FieldModel, camera: Option<&PtzCamera>) -> FieldMap {
    let longest_m = field.length_m.max(field.width_m) + 2.0 * MAP_MARGIN_M;
    let map = FieldMap::new(
        field,
        MAP_MARGIN_M,
        MAP_PX_PER_M.min(MAP_LONGEST_PX / longest_m),
    );
    camera.map_or(map, |camera| map.with_camera_below(camera))
}

/// Scale of lines and labels: on frames wider than 1920 px they keep their share of the picture.
fn pixels_per_point(width: u32) -> f32 {
    (width as f32 / 1920.0).max(1.0)
}

fn layer(pixels: media::Picture, brightness: f32) -> Layer {
    Layer::Picture(PictureLayer {
        // The key tells pictures of one renderer apart. Here each picture is drawn once.
        key: PictureKey(0),
        pixels,
        look: PictureLook::from_brightness(brightness),
    })
}

/// Finds a frame by its name in the document, else by its file name if only one frame has it, else
/// by its index.
fn find_frame<'a>(document: &'a Document, wanted: &str) -> anyhow::Result<&'a Frame> {
    let frames = || document.frames.iter().map(|frame| &**frame);
    // A whole path is unique, a file name need not be, and a number may be the name of an image. So
    // they are tried in this order.
    if let Some(frame) =
        frames().find(|frame| frame.image.as_deref() == Some(wanted) || frame.name() == wanted)
    {
        return Ok(frame);
    }
    let of_this_name = frames().filter(|frame| {
        frame
            .image
            .as_deref()
            .is_some_and(|image| Path::new(image).file_name() == Some(wanted.as_ref()))
    });
    match of_this_name.collect::<Vec<_>>()[..] {
        [frame] => return Ok(frame),
        [first, second, ..] => {
            bail!(
                "two frames have this file name, {} and {}; give the whole path",
                first.name(),
                second.name()
            )
        }
        [] => {}
    }
    let count = document.frames.len();
    let Ok(index) = wanted.parse::<usize>() else {
        bail!(
            "no frame has this image; the document has {count} frames, by index 0 to {}",
            count.saturating_sub(1)
        );
    };
    let frame = document.frames.get(index);
    frame
        .map(|frame| &**frame)
        .with_context(|| format!("there are {count} frames, counted from 0"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::{WithFrames, soccer_document};

    fn document(images: &[&str]) -> Document {
        soccer_document().with_pictures(images, ImageSize::new(64, 36))
    }

    #[test]
    fn a_frame_is_found_by_path_by_name_and_by_place() {
        let document = document(&["a/1.png", "b/1.png", "b/7.png", "0"]);
        let found = |wanted: &str| {
            find_frame(&document, wanted)
                .map(Frame::name)
                .map_err(|error| error.to_string())
        };
        assert_eq!(found("b/1.png"), Ok("b/1.png".into()));
        assert_eq!(found("7.png"), Ok("b/7.png".into()));
        assert_eq!(found("2"), Ok("b/7.png".into()));
        assert_eq!(
            found("0"),
            Ok("0".into()),
            "a name takes precedence over an index"
        );
        let two = "two frames have this file name, a/1.png and b/1.png; give the whole path";
        assert_eq!(found("1.png"), Err(two.into()));
        assert_eq!(found("4"), Err("there are 4 frames, counted from 0".into()));
        let none = "no frame has this image; the document has 4 frames, by index 0 to 3";
        assert_eq!(found("c.png"), Err(none.into()));
    }
}
