//! A synthetic match with exact truth, as documents and encoded pictures: for `touchline synth` and
//! the demo.

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageError, ImageFormat};
use serde_json::{Value, json};
use std::io::Cursor;
use touchline_calibration::calibrate::{FrameLookup, calibrate};
use touchline_core::camera::{CameraBase, FocalCurve, PtzCamera};
use touchline_core::field::{FieldError, FieldModel, builtin};
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_documents::document::{
    Camera, CameraId, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, Target,
};
use touchline_vision::media::sha256_of_bytes;
use touchline_vision::synthetic::{
    ClickOptions, ClickTarget, FrameOptions, Graphics, Mover, PathStep, Preset, RenderedFrame,
    ShootOptions, Side, Stadium, StadiumOptions, camera_path, generate_clicks, stadium,
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
    let spec = FieldSpec::new("soccer");
    let field = builtin(&spec.template)?.default_model()?;
    let scene = stadium(&StadiumOptions {
        daylight: order.shoot.daylight,
        ..StadiumOptions::new(field, order.seed)
    });
    let base = order.shoot.main_camera(order.image_size);
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
    let path = camera_path(&scene, &base, order.image_size, &order.shoot, order.frames);
    let mut references = 0;
    for (index, step) in path.iter().enumerate() {
        let options = order.shoot.frame(index, step, order.image_size, order.seed);
        let options = FrameOptions {
            graphics: order.graphics,
            ..options
        };
        let camera = PtzCamera::new(base, step.ptz);
        let drawn = scene.render(&camera, order.image_size, &options);
        let image = format!("images/{:04}.jpg", index + 1);
        let jpeg = jpeg(&drawn, order.shoot.jpeg_quality)?;
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
    PixelBox {
        x: (graphic.x - MASK_MARGIN_PX).floor().max(0.0),
        y: (graphic.y - MASK_MARGIN_PX).floor().max(0.0),
        width: (graphic.width + 2.0 * MASK_MARGIN_PX).ceil(),
        height: (graphic.height + 2.0 * MASK_MARGIN_PX).ceil(),
    }
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
