//! The overlay over a frame's picture: the field's lines, its landmarks, the clicks and their
//! residuals.
//!
//! Pure functions from a field, a frame's camera and clicks to a [`Drawing`]. The window, the loupe
//! and `touchline render` all draw this one.

use super::OverlayStyle;
use super::drawing::{
    Area, Colour, Dash, Drawing, Label, Marker, MarkerShape, Outline, Stroke, StrokeGroup,
};
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};
use touchline_core::markings::{
    MarkingOptions, MarkingPolyline, ProjectedLandmark, project_landmarks, project_lines,
};
use touchline_documents::document::{Click, Frame, FrameStatus, Target};

/// Colour of the rim around lines and markers.
const RIM: Colour = Colour {
    r: 10,
    g: 14,
    b: 12,
    a: 190,
};
/// Colour of a click that is used in the solve.
pub const CLICK: Colour = Colour::rgb(90, 225, 255);
/// The colour of a point that a model gave, and of the circle of its 1-σ.
pub const MODEL: Colour = Colour::rgb(200, 160, 255);
/// Colour of the selected click.
pub const SELECTED: Colour = Colour::rgb(255, 255, 255);
/// Colour of a check click, which the solve does not use.
pub const CHECK: Colour = Colour::rgb(206, 160, 255);
/// Colour of a click without a name.
pub const UNNAMED: Colour = Colour::rgb(255, 170, 60);
/// Colour of a click that contradicts the others.
pub const DISPUTED: Colour = Colour::rgb(255, 96, 88);
/// Colour of the plate behind a label.
const PLATE: Colour = Colour {
    r: 10,
    g: 14,
    b: 12,
    a: 170,
};
/// Colour of masks.
const MASK: Colour = Colour::rgb(240, 120, 200);

/// Radius of the ring that marks a click aligned to the paint, points. It fits into the gap of the
/// cross.
const SNAPPED_RADIUS_PT: f32 = 4.5;

/// Where the camera comes from, as far as the overlay shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CameraStatus {
    /// From clicks, or accepted: solid lines.
    #[default]
    Solved,
    /// Proposed by the program and not yet accepted: dashed lines.
    Proposed,
}

impl CameraStatus {
    /// The standing of the camera of a frame.
    pub fn from_frame(frame: &Frame) -> Self {
        if frame.status == FrameStatus::Suggested {
            Self::Proposed
        } else {
            Self::Solved
        }
    }
}

/// What an overlay is drawn from.
#[derive(Clone, Copy, Debug)]
pub struct OverlayScene<'a> {
    pub field: &'a FieldModel,
    /// The camera of the frame. Without it no lines are drawn.
    pub camera: Option<&'a PtzCamera>,
    /// Where the camera comes from.
    pub standing: CameraStatus,
    /// Size of the frame's picture, px.
    pub image_size: ImageSize,
    /// The frame's clicks.
    pub clicks: &'a [Click],
    /// Index of the selected click.
    pub selected: Option<usize>,
    /// Indices of the clicks that contradict the others.
    pub disputed: &'a [usize],
    /// Colour, width and opacity of the lines.
    pub style: &'a OverlayStyle,
    /// Canvas px per px of the picture. Determines how finely curves are sampled.
    pub zoom: f64,
}

impl<'a> OverlayScene<'a> {
    /// A scene without camera and clicks, with one canvas px per px of the picture.
    pub const fn new(
        field: &'a FieldModel,
        image_size: ImageSize,
        style: &'a OverlayStyle,
    ) -> Self {
        Self {
            field,
            camera: None,
            standing: CameraStatus::Solved,
            image_size,
            clicks: &[],
            selected: None,
            disputed: &[],
            style,
            zoom: 1.0,
        }
    }
}

/// The colour of a click's marker when the click is not selected.
pub fn click_colour(click: &Click, disputed: bool) -> Colour {
    if disputed {
        DISPUTED
    } else if click.target.is_none() {
        UNNAMED
    } else if click.check {
        CHECK
    } else if click.is_by_model() {
        MODEL
    } else {
        CLICK
    }
}

/// The colour of a click's marker. The selection does not hide that a click is disputed, unnamed or
/// a check.
pub(super) fn marker_colour(click: &Click, disputed: bool, selected: bool) -> Colour {
    match click_colour(click, disputed) {
        CLICK | MODEL if selected => SELECTED,
        colour => colour,
    }
}

/// The whole overlay: lines, landmarks, and the clicks on top.
pub fn overlay(scene: &OverlayScene<'_>) -> Drawing {
    let mut drawing = Drawing::default();
    append_field(scene, &mut drawing);
    append_clicks(scene, &mut drawing);
    drawing
}

/// The field alone: its lines, and unclicked landmarks as small rings.
pub fn field_overlay(scene: &OverlayScene<'_>) -> Drawing {
    let mut drawing = Drawing::default();
    append_field(scene, &mut drawing);
    drawing
}

/// The clicks alone: for each a marker with its code, and a thin line to where the camera predicts
/// it.
pub fn click_overlay(scene: &OverlayScene<'_>) -> Drawing {
    let mut drawing = Drawing::default();
    append_clicks(scene, &mut drawing);
    drawing
}

/// Masks: boxes from which no features are taken.
pub fn mask_overlay(boxes: &[PixelBox]) -> Drawing {
    Drawing {
        areas: boxes
            .iter()
            .map(|one| Area {
                corners: corners(one).to_vec(),
                colour: MASK.with_alpha(48),
            })
            .collect(),
        strokes: vec![StrokeGroup {
            strokes: boxes.iter().map(mask_border).collect(),
            opacity: 0.9,
            clip_px: None,
        }],
        ..Drawing::default()
    }
}

/// The corners of a box, clockwise from the upper left one.
fn corners(pixel_box: &PixelBox) -> [[f32; 2]; 4] {
    let (left, top) = (pixel_box.x, pixel_box.y);
    let (right, bottom) = (left + pixel_box.width, top + pixel_box.height);
    [(left, top), (right, top), (right, bottom), (left, bottom)].map(|(x, y)| [x as f32, y as f32])
}

/// The border of a mask, as a closed line.
fn mask_border(pixel_box: &PixelBox) -> Stroke {
    let [upper_left, upper_right, lower_right, lower_left] = corners(pixel_box);
    Stroke {
        points: vec![upper_left, upper_right, lower_right, lower_left, upper_left],
        colour: MASK,
        width_pt: 1.0,
        outline: Some(rim(0.5)),
        dash: None,
    }
}

/// Appends the lines and unclicked landmarks as the camera predicts them.
fn append_field(scene: &OverlayScene<'_>, drawing: &mut Drawing) {
    if scene.camera.is_none() {
        return;
    }
    let style = scene.style;
    let [r, g, b] = style.colour;
    let colour = Colour::rgb(r, g, b);
    // Dashes grow with the line. The gap also has room for the round caps of both its dashes, which
    // extend by half the width and the rim.
    let dash = (scene.standing == CameraStatus::Proposed).then_some(Dash {
        on_pt: 5.0 * style.width,
        off_pt: 4.0 * style.width + 2.0 * style.outline,
    });
    let strokes = lines_in_picture(scene)
        .into_iter()
        .map(|line| Stroke {
            points: line.points.into_iter().map(drawing_point).collect(),
            colour,
            width_pt: style.width,
            outline: (style.outline > 0.0).then_some(rim(style.outline)),
            dash,
        })
        .collect();
    let ImageSize { width, height } = scene.image_size;
    let clip_px = Some([0.0, 0.0, width as f32, height as f32]);
    drawing.strokes.push(StrokeGroup {
        strokes,
        opacity: style.opacity,
        clip_px,
    });
    // Clicked landmarks have the marker of their click. Markers belong to no group with an opacity,
    // so that they get it as their alpha.
    if style.landmarks {
        let alpha = (255.0 * style.opacity.clamp(0.0, 1.0)) as u8;
        let unclicked = landmarks_without_click(scene).into_iter();
        drawing.markers.extend(unclicked.map(|projected| Marker {
            at: drawing_point(projected.image),
            shape: MarkerShape::Ring,
            colour: colour.with_alpha(alpha),
            radius_pt: 3.5,
            line_pt: 1.25,
            outline: Some(Outline {
                colour: RIM.with_alpha(alpha / 4 * 3),
                width_pt: 0.75,
            }),
        }));
    }
}

/// The field's lines as the camera sees them; none without a camera.
pub(super) fn lines_in_picture(scene: &OverlayScene<'_>) -> Vec<MarkingPolyline> {
    let Some(camera) = scene.camera else {
        return Vec::new();
    };
    // Curves deviate by at most 0.1 px of the canvas, and of the picture if that is shown reduced.
    let options = MarkingOptions {
        tolerance_px: 0.1 / scene.zoom.max(1.0),
        dashes: true,
        ..MarkingOptions::default()
    };
    project_lines(scene.field, camera, scene.image_size, &options)
}

/// The landmarks that the camera sees and no click names; none without a camera.
pub(super) fn landmarks_without_click(scene: &OverlayScene<'_>) -> Vec<ProjectedLandmark> {
    let Some(camera) = scene.camera else {
        return Vec::new();
    };
    let mut seen = project_landmarks(scene.field, camera, scene.image_size, 0.0);
    seen.retain(|projected| {
        let id = &scene.field.landmarks[projected.landmark].id;
        !is_clicked(scene.clicks, id)
    });
    seen
}

/// Whether a click names a landmark.
pub(super) fn is_clicked(clicks: &[Click], landmark: &LandmarkId) -> bool {
    let mut targets = clicks.iter().filter_map(|click| click.target.as_ref());
    targets.any(|target| matches!(target, Target::Landmark(id) if id == landmark))
}

/// The circle of 1 σ about a model's point.
fn sigma_circle(middle: ImagePoint, sigma_px: f64) -> Stroke {
    /// Corners of the polygon that is drawn for it.
    const CORNERS: u32 = 24;
    let corner = |index: u32| {
        let (sin, cos) = (f64::from(index) / f64::from(CORNERS) * std::f64::consts::TAU).sin_cos();
        drawing_point(ImagePoint::new(
            middle.x + sigma_px * cos,
            middle.y + sigma_px * sin,
        ))
    };
    Stroke {
        points: (0..=CORNERS).map(corner).collect(),
        colour: MODEL,
        width_pt: 1.0,
        outline: None,
        dash: None,
    }
}

fn append_clicks(scene: &OverlayScene<'_>, drawing: &mut Drawing) {
    let mut whiskers = Vec::new();
    for (index, click) in scene
        .clicks
        .iter()
        .enumerate()
        .filter(|(_, click)| click.image.is_finite())
    {
        let selected = scene.selected == Some(index);
        let colour = marker_colour(click, scene.disputed.contains(&index), selected);
        // The residual: from the click to where the camera predicts its landmark. A click on a line
        // has none, because no point of the line is distinguished.
        if let Some(predicted) = predict_landmark(scene, click) {
            let times = if scene.style.residuals_times_ten {
                10.0
            } else {
                1.0
            };
            let end = click
                .image
                .translate(predicted.offset_from(click.image) * times);
            let points = vec![drawing_point(click.image), drawing_point(end)];
            whiskers.push(Stroke {
                points,
                colour,
                width_pt: 1.0,
                outline: Some(rim(0.75)),
                dash: None,
            });
        }
        if let Some(sigma_px) = click.model_origin().and_then(|origin| origin.sigma_px) {
            whiskers.push(sigma_circle(click.image, sigma_px));
        }
        let marker = Marker {
            at: drawing_point(click.image),
            shape: match click.target.as_ref().and_then(Target::line) {
                _ if click.check => MarkerShape::Diamond,
                Some(_) => MarkerShape::Ring,
                None => MarkerShape::Cross,
            },
            colour,
            radius_pt: if selected { 11.0 } else { 9.0 },
            line_pt: match (selected, click.is_by_model()) {
                (true, _) => 2.0,
                (false, true) => 1.0,
                (false, false) => 1.5,
            },
            outline: Some(rim(1.0)),
        };
        drawing.markers.push(marker);
        if click.snapped_sigma_px.is_some() {
            let in_the_gap = Marker {
                shape: MarkerShape::Ring,
                radius_pt: SNAPPED_RADIUS_PT,
                line_pt: 1.25,
                ..marker
            };
            drawing.markers.push(in_the_gap);
        }
        if selected {
            let ring = Marker {
                shape: MarkerShape::Ring,
                radius_pt: 15.0,
                line_pt: 1.5,
                ..marker
            };
            drawing.markers.push(ring);
        }
        // Its code, or a question mark for a click without a name.
        let text = code_of(scene.field, click).unwrap_or("?").to_owned();
        let offset_pt = if selected {
            [18.0, -14.0]
        } else {
            [10.0, -10.0]
        };
        drawing.labels.push(Label {
            at: drawing_point(click.image),
            offset_pt,
            text,
            size_pt: 12.0,
            colour,
            plate: PLATE,
        });
    }
    if !whiskers.is_empty() {
        drawing.strokes.push(StrokeGroup {
            strokes: whiskers,
            opacity: 1.0,
            clip_px: None,
        });
    }
}

/// Where the camera predicts the landmark of a click. `None` for clicks on lines.
fn predict_landmark(scene: &OverlayScene<'_>, click: &Click) -> Option<ImagePoint> {
    let Some(Target::Landmark(id)) = &click.target else {
        return None;
    };
    let landmark = scene.field.landmark(id.as_str())?;
    scene
        .camera?
        .image_from_world(scene.field.landmark_in_world(landmark))
        .ok()
}

/// The short code of a click's landmark or line.
fn code_of<'a>(field: &'a FieldModel, click: &Click) -> Option<&'a str> {
    click.target.as_ref()?.element(field)?.code(field)
}

const fn rim(width_pt: f32) -> Outline {
    Outline {
        colour: RIM,
        width_pt,
    }
}

const fn drawing_point(point: ImagePoint) -> [f32; 2] {
    [point.x as f32, point.y as f32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use touchline_core::field::{LandmarkId, LineId, builtin};
    use touchline_core::testing::{TestBase, base_at, pixel_box};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn field() -> FieldModel {
        builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap()
    }

    fn camera() -> PtzCamera {
        base_at([0.0, -60.0, 18.0], SIZE).aim(0.0, -14.0, 1800.0)
    }

    fn scene<'a>(
        field: &'a FieldModel,
        camera: Option<&'a PtzCamera>,
        clicks: &'a [Click],
        style: &'a OverlayStyle,
    ) -> OverlayScene<'a> {
        OverlayScene {
            field,
            camera,
            standing: CameraStatus::Solved,
            image_size: SIZE,
            clicks,
            selected: None,
            disputed: &[],
            style,
            zoom: 1.0,
        }
    }

    #[test]
    fn a_proposal_is_dashed_and_the_lines_end_at_the_picture() {
        let (field, camera, style) = (field(), camera(), OverlayStyle::default());
        let solved = scene(&field, Some(&camera), &[], &style);
        let lines = &field_overlay(&solved).strokes[0];
        assert_eq!(lines.clip_px, Some([0.0, 0.0, 1280.0, 720.0]));
        assert_eq!(lines.opacity, style.opacity);
        assert!(
            !lines.strokes.is_empty() && lines.strokes.iter().all(|stroke| stroke.dash.is_none())
        );
        let proposed = field_overlay(&OverlayScene {
            standing: CameraStatus::Proposed,
            ..solved
        });
        assert!(
            proposed.strokes[0]
                .strokes
                .iter()
                .all(|stroke| stroke.dash.is_some())
        );
    }

    #[test]
    fn without_a_camera_only_the_clicks_show() {
        let (field, style) = (field(), OverlayStyle::default());
        let clicks = [
            Click::landmark(
                LandmarkId::from("centre_mark"),
                ImagePoint::new(640.0, 360.0),
            ),
            Click::without_name(ImagePoint::new(10.0, 20.0)),
        ];
        let drawing = overlay(&scene(&field, None, &clicks, &style));
        assert!(drawing.strokes.is_empty());
        assert_eq!(
            drawing
                .markers
                .iter()
                .map(|marker| marker.colour)
                .collect::<Vec<_>>(),
            [CLICK, UNNAMED]
        );
        let texts: Vec<_> = drawing
            .labels
            .iter()
            .map(|label| label.text.as_str())
            .collect();
        assert_eq!(
            texts,
            [field.landmark("centre_mark").unwrap().code.as_str(), "?"]
        );
    }

    #[test]
    fn a_click_is_tied_to_where_the_solution_has_it() {
        let (field, camera, style) = (field(), camera(), OverlayStyle::default());
        let exact = camera
            .image_from_world(field.landmark("centre_mark").unwrap().nominal_m)
            .unwrap();
        let off = ImagePoint::new(exact.x + 12.0, exact.y - 5.0);
        let mut check = Click::landmark(LandmarkId::from("centre_mark"), off);
        check.check = true;
        let clicks = [check, Click::line(LineId::from("halfway_line"), off)];
        let scene = OverlayScene {
            selected: Some(1),
            disputed: &[1],
            ..scene(&field, Some(&camera), &clicks, &style)
        };
        let drawing = click_overlay(&scene);
        assert_eq!(
            drawing.strokes[0].strokes.len(),
            1,
            "a click on a line has no one place to be"
        );
        assert_eq!(
            drawing.strokes[0].strokes[0].points,
            [drawing_point(off), drawing_point(exact)]
        );
        let seen: Vec<_> = drawing
            .markers
            .iter()
            .map(|marker| (marker.shape, marker.colour))
            .collect();
        assert_eq!(
            seen,
            [
                (MarkerShape::Diamond, CHECK),
                (MarkerShape::Ring, DISPUTED),
                (MarkerShape::Ring, DISPUTED)
            ],
            "a ring for the click on a line, and one for its selection"
        );
    }

    #[test]
    fn a_clicked_landmark_has_no_ring_besides() {
        let (field, camera, style) = (field(), camera(), OverlayStyle::default());
        let rings = |clicks: &[Click]| {
            field_overlay(&scene(&field, Some(&camera), clicks, &style))
                .markers
                .len()
        };
        let click = Click::landmark(LandmarkId::from("centre_mark"), ImagePoint::new(1.0, 1.0));
        assert_eq!(rings(&[click]) + 1, rings(&[]));
        let plain = OverlayStyle {
            landmarks: false,
            ..style
        };
        assert!(
            field_overlay(&scene(&field, Some(&camera), &[], &plain))
                .markers
                .is_empty()
        );
    }

    #[test]
    fn a_mask_is_a_box_with_a_border() {
        let drawing = mask_overlay(&[pixel_box(10.0, 20.0, 30.0, 40.0)]);
        assert_eq!(
            drawing.areas[0].corners,
            [[10.0, 20.0], [40.0, 20.0], [40.0, 60.0], [10.0, 60.0]]
        );
        assert_eq!(drawing.strokes[0].strokes[0].points.len(), 5);
    }
}
