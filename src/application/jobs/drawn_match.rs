//! A synthetic match with exact truth, as documents and encoded pictures: for `touchline synth` and
//! the demo.

use super::JobError;
use super::opening::user_projects;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageError, ImageFormat};
use serde_json::Value;
use serde_json::json;
use std::io::Cursor;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_calibration::calibrate::{FrameLookup, calibrate};
use touchline_core::camera::{CameraBase, FocalCurve, PtzCamera};
use touchline_core::field::{FieldError, FieldModel, builtin};
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Camera, CameraId, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, Target,
};
use touchline_documents::store::{Location, PROJECT_FILE, Store, write_atomically};
use touchline_vision::media::{MediaError, sha256_of_bytes};
use touchline_vision::synthetic::{
    ClickOptions, ClickTarget, FrameOptions, Graphics, Mover, PathStep, Preset, RenderedFrame,
    Setting, ShootOptions, Side, Stadium, StadiumOptions, camera_path, generate_clicks, stadium,
};

/// Margin of a mask around the score graphic, px.
const MASK_MARGIN_PX: f64 = 4.0;

/// Number of landmarks that the simulated annotator clicks, in turn: two are enough, more are
/// redundant.
const LANDMARKS_A_REFERENCE: [usize; 6] = [4, 2, 3, 6, 2, 5];

/// Everything that determines the drawn match.
#[derive(Clone, Debug)]
pub struct MatchOrder {
    /// Number of frames.
    pub frames: usize,
    /// Seed of the stadium, the match and the camera's path.
    pub seed: u64,
    /// What is drawn, and from where.
    pub setting: Setting,
    /// Size of the frames, px.
    pub image_size: ImageSize,
    /// Lens, light and sensor.
    pub shoot: ShootOptions,
    /// Whether to draw masks of the players, too.
    pub masks: bool,
    /// The broadcaster's graphics.
    pub graphics: Graphics,
    /// Whether the camera's masks leave the graphics uncovered.
    pub unmasked: bool,
    /// Share of the frames that are clicked and solved.
    pub references: f64,
}

impl MatchOrder {
    /// The demo that comes with the program: visible lens distortion, ordinary sensor noise, frames
    /// 4.7 s apart.
    pub fn demo() -> Self {
        let shoot = ShootOptions {
            step_s: 4.7,
            focal_px_at_1280: [1200.0, 3200.0],
            distortion_at_1280: FocalCurve {
                at_focal_px: 1500.0,
                value: -0.03,
                per_1000_px: 0.08,
                ..FocalCurve::NONE
            },
            noise_levels: 0.7,
            jpeg_quality: 76,
            ..Preset::Paper.shoot()
        };
        let image_size = ImageSize::new(1280, 720);
        let graphics = Graphics::default();
        Self {
            frames: 27,
            seed: 5,
            setting: Setting::default(),
            image_size,
            shoot,
            masks: false,
            graphics,
            unmasked: false,
            references: 1.0 / 3.0,
        }
    }
}

/// One drawn frame.
#[derive(Debug)]
pub struct DrawnPicture {
    /// Path within the project, such as `images/0001.jpg`.
    pub image: String,
    /// The picture, encoded as JPEG.
    pub jpeg: Vec<u8>,
    /// Path and PNG of the mask of the players' pixels, if the order asks for masks.
    pub mask: Option<(String, Vec<u8>)>,
    /// Index of the frame.
    pub index: usize,
    /// Number of frames of the match.
    pub of: usize,
}

/// The two documents of a drawn match.
#[derive(Debug)]
pub struct DrawnMatch {
    /// The document of a user: the camera's base is known, and a share of the frames are
    /// references.
    pub project: Document,
    /// The exact pan, tilt and focal length of every frame, and the boxes of the players.
    pub truth: Document,
}

/// Draws a match. `take` receives each picture in turn and can end the drawing with an error. The
/// same order gives the same bytes.
///
/// # Errors
/// The field or a picture cannot be made, or `take` failed.
pub fn draw_match<E: From<FieldError> + From<ImageError>>(
    order: &MatchOrder,
    take: &mut dyn FnMut(DrawnPicture) -> Result<(), E>,
) -> Result<DrawnMatch, E> {
    let spec = FieldSpec::new(order.setting.scene().template());
    let field = builtin(&spec.template)?.default_model()?;
    let (base, shoot) = order
        .shoot
        .in_setting(order.setting, &field, order.image_size, order.seed);
    let scene = stadium(&StadiumOptions {
        scene: order.setting.scene(),
        daylight: shoot.daylight,
        ..StadiumOptions::new(field, order.seed)
    });
    let mut project = Document::new(spec);
    let masked = if order.unmasked {
        Graphics::NONE
    } else {
        order.graphics
    };
    project
        // The main camera with its exact base, and masks over the graphics.
        .cameras
        .push(main_camera(&base, order.image_size, masked).into());
    let mut truth = project.clone();
    let path = camera_path(&scene, &base, order.image_size, &shoot, order.frames);
    let mut references = 0;
    for (index, step) in path.iter().enumerate() {
        let options = shoot.frame(index, step, order.image_size, order.seed);
        let options = FrameOptions {
            graphics: order.graphics,
            ..options
        };
        let camera = PtzCamera::new(base, step.ptz);
        let drawn = scene.render(&camera, order.image_size, &options);
        let image = format!("images/{:04}.jpg", index + 1);
        let jpeg = jpeg(&drawn, shoot.jpeg_quality)?;
        let mut frame = Frame::from_image(&image, CameraId::from("main"), order.image_size);
        frame.sha256 = Some(sha256_of_bytes(&jpeg));
        truth
            .frames
            .push(true_frame(&frame, &camera, step, &drawn).into());
        // References are spread evenly: the share so far lags behind the ordered one.
        // A frame with too little of the field in view leaves the lag to the next one.
        let due = order.references * (index + 1) as f64 > f64::from(references);
        if due && solve_as_reference(&mut frame, &project, &scene, &camera, &drawn, index) {
            references += 1;
        }
        project.frames.push(frame.into());
        let mask = order.masks.then(|| mask(&drawn)).transpose()?;
        let mask = mask.map(|png| (format!("masks/{:04}.png", index + 1), png));
        take(DrawnPicture {
            image,
            jpeg,
            mask,
            index,
            of: path.len(),
        })?;
    }
    Ok(DrawnMatch { project, truth })
}

/// The camera of the match, with its exact base and masks over the graphics.
fn main_camera(base: &CameraBase, image_size: ImageSize, masked: Graphics) -> Camera {
    let mut camera = Camera::new(CameraId::from("main"), image_size);
    camera.set_base(base);
    camera.masks = masked
        .boxes(image_size, 0.0)
        .into_iter()
        .map(box_with_margin)
        .collect();
    camera
}

/// The box of a graphic with [`MASK_MARGIN_PX`] around it, in whole px.
fn box_with_margin(graphic: PixelBox) -> PixelBox {
    PixelBox::new(
        (graphic.x - MASK_MARGIN_PX).floor().max(0.0),
        (graphic.y - MASK_MARGIN_PX).floor().max(0.0),
        (graphic.width + 2.0 * MASK_MARGIN_PX).ceil(),
        (graphic.height + 2.0 * MASK_MARGIN_PX).ceil(),
    )
}

/// A frame of the truth: the exact camera, the boxes of the players, and under the key `truth` the
/// time and who they are.
fn true_frame(frame: &Frame, camera: &PtzCamera, step: &PathStep, drawn: &RenderedFrame) -> Frame {
    let mut frame = frame.clone();
    frame.status = FrameStatus::Reference;
    frame.ptz = Some(FramePtz::new(camera.ptz(), Some(camera.lens())));
    frame.masks = drawn.movers.iter().map(|mover| mover.area).collect();
    let movers: Vec<Value> = drawn
        .movers
        .iter()
        .map(|mover| json!(mover_name(mover.mover)))
        .collect();
    frame.extra.insert(
        "truth".to_owned(),
        json!({ "time_s": step.time_s, "masks": movers }),
    );
    frame
}

fn mover_name(mover: Mover) -> &'static str {
    match mover {
        Mover::Person(Side::Home) => "home",
        Mover::Person(Side::Away) => "away",
        Mover::Person(Side::HomeKeeper) => "home_keeper",
        Mover::Person(Side::AwayKeeper) => "away_keeper",
        Mover::Person(Side::Official) => "official",
        Mover::Ball => "ball",
    }
}

/// Clicks a frame as an annotator would and solves it. False if too little of the field is in view.
fn solve_as_reference(
    frame: &mut Frame,
    project: &Document,
    scene: &Stadium,
    camera: &PtzCamera,
    drawn: &RenderedFrame,
    index: usize,
) -> bool {
    let field: &FieldModel = scene.field();
    let hidden: Vec<PixelBox> = drawn
        .movers
        .iter()
        .map(|mover| mover.area)
        .chain(drawn.graphics.iter().copied())
        .collect();
    // The demo clicks every third frame, hence `index / 3`: its references differ in their number
    // of landmarks.
    let options = ClickOptions {
        landmarks: LANDMARKS_A_REFERENCE[index / 3 % LANDMARKS_A_REFERENCE.len()],
        lines: usize::from(index % 4 == 3),
        sigma_px: 1.0,
        seed: index as u64,
    };
    // Solve a copy, so that the frame stays unclicked if its clicks do not suffice.
    let mut clicked = frame.clone();
    clicked.clicks = generate_clicks(field, camera, frame.image_size, &hidden, &options)
        .into_iter()
        .map(|click| match click.target {
            ClickTarget::Landmark(id) => Click::new(Target::Landmark(id), click.image),
            ClickTarget::Line(id) => Click::new(Target::Line(id), click.image),
        })
        .collect();
    let Ok(solved) = calibrate(
        project,
        &FrameLookup::default(),
        &clicked,
        field,
        project.frames.len(),
    ) else {
        return false;
    };
    clicked.record(&solved);
    clicked.status = FrameStatus::Reference;
    *frame = clicked;
    true
}

fn jpeg(drawn: &RenderedFrame, quality: u8) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(&drawn.image)?;
    Ok(bytes)
}

fn mask(drawn: &RenderedFrame) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(drawn.mover_mask.clone()).write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

/// The folder of the user's copy of the demo match. If there is none yet, it is copied from the one
/// that came with the program, or else drawn.
///
/// # Errors
/// The copy cannot be written, or `progress` cancelled it.
pub fn fresh_demo(progress: &Progress<'_, String>) -> Result<PathBuf, JobError> {
    let own = user_projects().ok_or(JobError::NoUserFolder)?.join("demo");
    if own.join(PROJECT_FILE).exists() {
        return Ok(own);
    }
    match find_demo_folder() {
        Some(folder) => copy_folder(&folder, &own).map_err(JobError::io(&own))?,
        None => draw_demo(&MatchOrder::demo(), &own, progress)?,
    }
    Ok(own)
}

/// Draws a match into a folder. The project file is written last; without it the match counts as
/// incomplete and is drawn again.
fn draw_demo(
    order: &MatchOrder,
    folder: &Path,
    progress: &Progress<'_, String>,
) -> Result<(), JobError> {
    std::fs::create_dir_all(folder.join("images")).map_err(JobError::io(folder))?;
    let drawn = draw_match(order, &mut |picture: DrawnPicture| {
        let file = folder.join(&picture.image);
        std::fs::write(&file, &picture.jpeg).map_err(JobError::io(&file))?;
        let step = format!(
            "Drawing the demo match: {} of {} frames…",
            picture.index + 1,
            picture.of
        );
        match progress.report(step) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(JobError::from(MediaError::Stopped {
                path: folder.to_path_buf(),
            })),
        }
    })?;
    Store::create(&Location::for_new_document(folder)?, &drawn.project)?;
    Ok(())
}

/// The folder of the demo: beside an installed program, or in the source tree where it was built.
fn find_demo_folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    // `bin` and `share` of an installation are siblings; `target/release` lies two folders below
    // the source tree.
    let beside = program.ancestors().skip(1).take(4);
    beside
        .flat_map(|folder| {
            [
                folder.join("share/touchline/demo"),
                folder.join("projects/demo"),
            ]
        })
        .find(|folder| folder.join(PROJECT_FILE).exists())
}

/// Copies a match. The project file is copied last, and is there whole or not at all; without it
/// the copy counts as incomplete and is repeated.
fn copy_folder(from: &Path, to: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(to)?;
    let mut entries = std::fs::read_dir(from)?.collect::<std::io::Result<Vec<_>>>()?;
    // `false` sorts before `true`: the project file comes after everything else.
    entries.sort_by_key(|entry| (entry.file_name() == PROJECT_FILE, entry.file_name()));
    for entry in entries {
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            write_atomically(&target, &std::fs::read(entry.path())?)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_copy_that_is_interrupted_is_no_project() {
        let place = tempfile::tempdir().unwrap();
        let (from, to) = (place.path().join("from"), place.path().join("to"));
        std::fs::create_dir_all(from.join("zz")).unwrap();
        std::fs::write(from.join(PROJECT_FILE), "{}").unwrap();
        std::fs::write(from.join("zz/1.jpg"), "picture").unwrap();
        std::fs::write(from.join("a.txt"), "first").unwrap();
        // A file with the name of the picture folder makes the copy fail there.
        std::fs::create_dir(&to).unwrap();
        std::fs::write(to.join("zz"), "in the way").unwrap();
        assert!(copy_folder(&from, &to).is_err());
        assert!(to.join("a.txt").exists() && !to.join(PROJECT_FILE).exists());
        std::fs::remove_file(to.join("zz")).unwrap();
        copy_folder(&from, &to).unwrap();
        assert!(to.join(PROJECT_FILE).exists() && to.join("zz/1.jpg").exists());
    }

    #[test]
    fn without_a_demo_beside_the_program_one_is_drawn_that_opens_and_can_be_stopped() {
        let place = tempfile::tempdir().unwrap();
        let order = MatchOrder {
            frames: 3,
            image_size: ImageSize::new(320, 180),
            ..MatchOrder::demo()
        };
        let stopped = draw_demo(
            &order,
            place.path(),
            &Progress::new(|_| ControlFlow::Break(())),
        );
        assert!(
            matches!(stopped, Err(JobError::Media(MediaError::Stopped { .. }))),
            "{stopped:?}"
        );
        assert!(!place.path().join(PROJECT_FILE).exists());
        let messages = std::sync::Mutex::new(Vec::new());
        let progress = Progress::new(|text| {
            messages.lock().unwrap().push(text);
            ControlFlow::Continue(())
        });
        draw_demo(&order, place.path(), &progress).unwrap();
        drop(progress);
        assert_eq!(
            messages.into_inner().unwrap().last().unwrap(),
            "Drawing the demo match: 3 of 3 frames…"
        );
        let (_, document, _) = touchline_documents::store::read(place.path()).unwrap();
        assert_eq!(document.frames.len(), 3);
        for frame in &document.frames {
            let file = frame.image_path(place.path()).unwrap();
            assert_eq!(
                touchline_vision::media::sha256_of_file(&file).ok(),
                frame.sha256
            );
        }
    }
}
