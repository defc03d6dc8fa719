//! Converts cameras that were read into a document: frames with a common base share a camera.

use super::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::document::{
    Camera, CameraId, Distortion, Document, FieldSpec, Frame, FrameLens, FramePtz, FrameStatus,
    ImportedCamera, Shared, Solution, SolutionSource, VideoFrame,
};
use nalgebra::SymmetricEigen;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, Radial};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Mat3, Vec2, Vec3};
use touchline_core::score::PlaneView;
use touchline_core::solve::{PlanePoseError, UNSTATED_PX, pose_from_plane};

/// Frames whose centres of projection differ by at most this may share a camera, m.
pub(super) const SAME_PLACE_M: f64 = 1e-6;
/// The minimum spread of pans that determines the pan axis: the second smallest eigenvalue of the
/// mean of x xᵀ over the frames' x axes.
const MIN_PAN_SPREAD: f64 = 1e-6;
/// A roll of frames of one place that no common axis explains is rounding up to this angle, and
/// dropped: 0.001 px at the border of a picture of 1920 px.
pub(super) const ROUNDING_RAD: f64 = 1e-6;
/// Up to this angle, frames of one place share a camera and keep what they roll. Trackers leave as
/// much of it in each frame.
const SMALL_ROLL_RAD: f64 = 2e-4;
/// Ground farther from the middle of the field is not used to fit a camera, m.
const WIDEST_GROUND_M: f64 = 150.0;
/// A camera is fitted to a homography on a grid of this many steps in each direction.
const GRID_STEPS: u32 = 8;
/// Distortion coefficients that differ by at most this are equal.
const SAME_LENS: f64 = 1e-12;

/// The precision of a format's numbers, as tolerances.
#[derive(Clone, Copy, Debug)]
pub struct Exactness {
    /// Angles, rad.
    pub angle_rad: f64,
    /// Places, m.
    pub place_m: f64,
}

impl Default for Exactness {
    fn default() -> Self {
        Self {
            angle_rad: 1e-10,
            place_m: SAME_PLACE_M,
        }
    }
}

/// A frame that was read, the size of its picture, and its camera.
pub type View = (FrameCamera, ImageSize, Pinhole);

/// Converts frames with known picture sizes into a document. Frame numbers refer to the video's
/// path, if it is given.
pub fn document_of(field: FieldSpec, frames: &[View], exact: Exactness) -> Document {
    let mut document = Document::new(field);
    let mut ids = FreeNames::new("-");
    // Frames that may share a camera, by index. Their order within a group is that of the file, so
    // that a camera is named and based on its first frame.
    let groups = group_by_position(frames, exact.place_m);
    let mut made: Vec<Option<Solved>> = vec![None; frames.len()];
    for group in groups {
        let views: Vec<&Pinhole> = group.iter().map(|&index| &frames[index].2).collect();
        let common_lens = lens_of(&views);
        // Frames of one position without a common pan axis get a camera each. A lens that no curve
        // describes leaves its frame out; `Pinhole::validate` refuses such lenses.
        let parts = match frames[group[0]].0.common_base {
            Some(common) => vec![OnBase {
                members: group,
                base: common.base,
                keeps_own: true,
            }],
            None => parts_with_an_axis(frames, group, &views, exact),
        };
        for part in parts {
            let OnBase {
                members,
                base,
                keeps_own,
            } = part;
            let (first, size, view) = &frames[members[0]];
            // Frames without a common lens keep their own beside that of the first.
            let has_own_lens = common_lens.is_none() && members.len() > 1;
            let Some(curve) = common_lens.or_else(|| view.curve()) else {
                continue;
            };
            let base = CameraBase {
                distortion: curve,
                principal_point: view.principal_point,
                ..base
            };
            // A format without names of cameras gives `main`.
            let name = first.camera.as_deref().filter(|name| !name.is_empty());
            let id = CameraId::from(ids.take(name.unwrap_or("main")).as_str());
            let mut camera = Camera::new(id.clone(), *size);
            camera.set_base(&base);
            if curve.with_pixel_aspect(1.0) == FocalCurve::NONE {
                camera.distortion = None::<Distortion>;
            }
            document.cameras.push(camera.into());
            for index in members {
                let view = &frames[index].2;
                // Q_tilt · Q_pan of the view (`conventions`): its first row is (cos θ, 0, −sin θ),
                // its second column (0, cos φ, −sin φ). What is left of a roll is rounding, or is
                // kept as it was imported.
                let on_base = if keeps_own {
                    view.move_to(base.position_m)
                } else {
                    *view
                };
                let turned = on_base.cam_from_world * base.base_from_world.transpose();
                let pan = Angle::from_radians((-turned[(0, 2)]).atan2(turned[(0, 0)]));
                let tilt = Angle::from_radians((-turned[(2, 1)]).atan2(turned[(1, 1)]));
                let ptz = Ptz::new(pan, tilt, on_base.focal_px);
                let imported = Some(view)
                    .filter(|_| keeps_own)
                    .and_then(Pinhole::ptz_camera)
                    .and_then(|camera| ImportedCamera::new(&camera, None, None));
                // The frame records the lens as the curve gives it, within `SAME_LENS` of the one
                // that was read.
                let radial = if has_own_lens {
                    view.lens
                } else {
                    base.distortion.radial_at(view.focal_px)
                };
                let recorded = Some(radial).filter(|lens| !lens.is_none());
                made[index] = Some(Solved {
                    camera: id.clone(),
                    ptz: FramePtz {
                        imported: imported.map(Box::new),
                        ..FramePtz::new(ptz, recorded)
                    },
                    lens: has_own_lens
                        .then(|| FrameLens::new(view.focal_px, view.principal_point, view.lens)),
                });
            }
        }
    }
    // The document has its frames in the order in which they were read, not camera by camera.
    for ((frame, size, _), made) in frames.iter().zip(made) {
        if let Some(solved) = made {
            document
                .frames
                .push(document_frame(frame, *size, solved).into());
        }
    }
    // What another program does not state is not known exactly.
    for index in 0..document.frames.len() {
        let frame = &document.frames[index];
        if frame.status == FrameStatus::Suggested && frame.is_uncertainty_unstated() {
            document.state_uncertainty(index, UNSTATED_PX);
        }
    }
    document
}

/// Frames (by index) on one base.
struct OnBase {
    members: Vec<usize>,
    base: CameraBase,
    /// Whether they stand or roll a little beside it, and keep how they came.
    keeps_own: bool,
}

/// The bases of frames at one place (by index): one for all if they have a common pan axis, else
/// one for each.
fn parts_with_an_axis(
    frames: &[View],
    group: Vec<usize>,
    views: &[&Pinhole],
    exact: Exactness,
) -> Vec<OnBase> {
    // The gauge of pan zero is that of the program (`rotation_about`), so that cameras of one place
    // have comparable pans, whatever the file counts from.
    let base_at = |index: usize, axis: &Vec3| {
        let view = &frames[index].2;
        let rotation = CameraBase::rotation_about(axis);
        CameraBase::new(view.position_m, rotation, view.principal_point)
    };
    let rounding_rad = exact.angle_rad.max(ROUNDING_RAD);
    let exact_axis = pan_axis(views, exact.angle_rad).or_else(|| pan_axis(views, rounding_rad));
    let keeps_own = exact_axis.is_none();
    if let Some(axis) = exact_axis.or_else(|| pan_axis(views, SMALL_ROLL_RAD)) {
        let base = base_at(group[0], &axis);
        return vec![OnBase {
            members: group,
            base,
            keeps_own,
        }];
    }
    let alone = group.into_iter().map(|index| OnBase {
        members: vec![index],
        base: base_at(index, &upright_axis(&frames[index].2)),
        keeps_own: false,
    });
    alone.collect()
}

/// What the document says of the camera of a frame.
#[derive(Clone)]
struct Solved {
    camera: CameraId,
    ptz: FramePtz,
    /// The lens of the frame, where that of the camera is not its own.
    lens: Option<FrameLens>,
}

/// The document's frame of a solved view. New and rejected frames become suggestions.
fn document_frame(frame: &FrameCamera, size: ImageSize, solved: Solved) -> Frame {
    let mut made = unsolved_frame(frame, solved.camera, size);
    made.lens = solved.lens;
    made.status = match frame.record.status {
        FrameStatus::New | FrameStatus::Rejected => FrameStatus::Suggested,
        known => known,
    };
    made.ptz = Some(solved.ptz);
    made.solution = Some(Solution {
        source: Some(SolutionSource::Import),
        rms_px: frame.record.rms_px,
        worst_corner_sigma_px: frame.record.worst_corner_sigma_px,
        confidence: frame.record.confidence,
        ..Solution::default()
    });
    made
}

/// The document's frame of a view without its camera.
pub(in crate::exchange) fn unsolved_frame(
    frame: &FrameCamera,
    camera: CameraId,
    size: ImageSize,
) -> Frame {
    // A frame of a video only has a number and no image; a track that names no video is named by
    // its own frames (`places::names_video`); an import names it by its file.
    let image = frame.image.clone().unwrap_or_else(|| frame.name.clone());
    match (&frame.image, frame.frame_index) {
        (None, Some(index)) => {
            let video = frame.video.as_deref().unwrap_or(&frame.name);
            Frame::from_video(VideoFrame::new(video, index, frame.pts_s), camera, size)
        }
        _ => Frame::from_image(&image, camera, size),
    }
}

/// Groups of frames (by index) that may share a camera: a common base, or equal position, camera
/// name and size.
pub(super) fn group_by_position(frames: &[View], place_m: f64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    // A hash grid of the groups' first frames, with cells of the tolerance's size, because a data
    // set may have a different position for every frame. Frames within the tolerance lie in
    // touching cells.
    let mut by_cell: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    let mut by_base: BTreeMap<usize, usize> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        if let Some(common) = frame.0.common_base {
            let group = *by_base.entry(common.number).or_insert(groups.len());
            if group == groups.len() {
                groups.push(Vec::new());
            }
            groups[group].push(index);
            continue;
        }
        let cell = [0, 1, 2].map(|axis: usize| (frame.2.position_m[axis] / place_m).floor() as i64);
        // The earliest group within reach: as if all groups were compared in their order.
        let near = cells_around(cell)
            .filter_map(|cell| {
                by_cell
                    .get(&cell)?
                    .iter()
                    .copied()
                    .find(|group| may_share_camera(&frames[groups[*group][0]], frame, place_m))
            })
            .min();
        if let Some(group) = near {
            groups[group].push(index);
        } else {
            by_cell.entry(cell).or_default().push(groups.len());
            groups.push(vec![index]);
        }
    }
    groups
}

/// Whether two frames may share a camera.
fn may_share_camera(first: &View, other: &View, place_m: f64) -> bool {
    // The size belongs to a camera of the document, not to its frames.
    first.1 == other.1
        && first.0.camera == other.0.camera
        && (first.2.position_m - other.2.position_m).amax() <= place_m
}

/// A cell and its 26 neighbours.
fn cells_around(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let offsets =
        (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| [x, y, z])));
    offsets.map(move |offset: [i64; 3]| {
        [0, 1, 2].map(|axis: usize| cell[axis].saturating_add(offset[axis]))
    })
}

/// Free names: the first of `main`, `main-2`, … that is not taken.
pub(in crate::exchange) struct FreeNames {
    /// What stands between a name and its number.
    separator: &'static str,
    taken: BTreeSet<String>,
    /// The number with which the search for a free name goes on. Thousands of cameras of one name
    /// would otherwise each be compared with all others.
    next: BTreeMap<String, usize>,
}

impl FreeNames {
    pub(in crate::exchange) const fn new(separator: &'static str) -> Self {
        Self {
            separator,
            taken: BTreeSet::new(),
            next: BTreeMap::new(),
        }
    }

    /// Takes the first free one of a name.
    pub(in crate::exchange) fn take(&mut self, name: &str) -> String {
        let next = self.next.entry(name.to_owned()).or_insert(1);
        loop {
            let free = if *next == 1 {
                name.to_owned()
            } else {
                format!("{name}{}{next}", self.separator)
            };
            *next += 1;
            if self.taken.insert(free.clone()) {
                return free;
            }
        }
    }
}

/// The common pan axis of all views, upwards (`world`): the vertical if it fits, else the direction
/// perpendicular to all of their x axes. None if no axis fits within `tolerance_rad`.
pub(super) fn pan_axis(views: &[&Pinhole], tolerance_rad: f64) -> Option<Vec3> {
    let upright = Vec3::z();
    if is_pan_axis(&upright, views, tolerance_rad) {
        return Some(upright);
    }
    // A camera without roll keeps its x axis perpendicular to the pan axis. So the pan axis is the
    // eigenvector of the mean of x xᵀ with the smallest eigenvalue, if the views differ in pan.
    // Without a spread of pans two eigenvalues vanish, and any axis in their plane fits: then the
    // one nearest to the vertical is taken.
    let mut moments = Mat3::zeros();
    for view in views {
        moments += right_axis(view) * right_axis(view).transpose();
    }
    let eigen = SymmetricEigen::new(moments / views.len() as f64);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let axis = if eigen.eigenvalues[order[1]] > MIN_PAN_SPREAD {
        let axis: Vec3 = eigen.eigenvectors.column(order[0]).into_owned();
        // The sign of an eigenvector is arbitrary.
        axis * axis.z.signum()
    } else {
        upright_axis(views.first()?)
    };
    is_pan_axis(&axis, views, tolerance_rad).then_some(axis)
}

/// Whether an axis is perpendicular to the x axes of all views, within a tolerance.
fn is_pan_axis(axis: &Vec3, views: &[&Pinhole], tolerance_rad: f64) -> bool {
    views
        .iter()
        .all(|view| right_axis(view).dot(axis).abs() <= tolerance_rad)
}

/// The x axis of a view in `world`.
fn right_axis(view: &Pinhole) -> Vec3 {
    view.cam_from_world.row(0).transpose()
}

/// The pan axis of a single view: the direction perpendicular to its x axis that is nearest to the
/// vertical.
fn upright_axis(view: &Pinhole) -> Vec3 {
    let right = right_axis(view);
    let upright = Vec3::z() - right * right.z;
    // For a camera on its side this vanishes: use its own up axis.
    let upright = if upright.norm() > 1e-6 {
        upright
    } else {
        -view.cam_from_world.row(1).transpose()
    };
    upright.normalize()
}

/// The common lens of all views: one principal point, one aspect of the pixels, k₁ linear in the
/// focal length, and k₂ a constant multiple of k₁². None if no such lens fits all of them.
fn lens_of(views: &[&Pinhole]) -> Option<FocalCurve> {
    // The principal point is compared to rounding, 1e-9 px.
    let first = views.first()?;
    if views.iter().any(|view| {
        view.principal_point.distance_px(first.principal_point) >= 1e-9
            || (view.lens.pixel_aspect - first.lens.pixel_aspect).abs() > SAME_LENS
    }) {
        return None;
    }
    let low = views
        .iter()
        .min_by(|a, b| a.focal_px.total_cmp(&b.focal_px))?;
    let high = views
        .iter()
        .max_by(|a, b| a.focal_px.total_cmp(&b.focal_px))?;
    // The line through the shortest and the longest focal length, where rounding of k₁ changes the
    // slope least; all views are checked against it. A fit would hide a lens that is not linear.
    let mut curve = low.curve()?;
    if views
        .iter()
        .any(|view| (view.lens.k1 - low.lens.k1).abs() > SAME_LENS)
    {
        // Views of one focal length and different k₁ divide by zero here; the check below then
        // fails for all of them.
        let slope = (high.lens.k1 - low.lens.k1) / (high.focal_px - low.focal_px);
        curve.at_focal_px = low.focal_px;
        curve.per_1000_px = 1000.0 * slope;
        // One multiple for all: the model of the document has k₂ = share · k₁² (`FocalCurve`).
        if let Some(with_k2) = views.iter().find(|view| view.lens.k2 != 0.0) {
            curve.k2_per_k1_squared = with_k2.lens.k2 / with_k2.lens.k1.powi(2);
        }
    }
    let fits_all = views.iter().all(|view| {
        let Radial { k1, k2, .. } = curve.radial_at(view.focal_px);
        (k1 - view.lens.k1).abs() <= SAME_LENS && (k2 - view.lens.k2).abs() <= SAME_LENS
    });
    (fits_all && curve.is_finite()).then_some(curve)
}

/// The camera of a frame. For a homography, the camera with the principal point in the middle that
/// fits it best in px; for a frame of which only the lens is known, a camera with that lens and no
/// meaningful pose.
///
/// # Errors
/// No camera with square pixels fits the homography, or the frame shows nothing.
pub fn camera_of(frame: &FrameCamera, size: ImageSize) -> Result<Pinhole, PlanePoseError> {
    let points = match &frame.shown {
        FrameProjection::Camera(pinhole) => return Ok(*pinhole),
        FrameProjection::Lens(lens) => return Ok(lens.camera_at_origin()),
        FrameProjection::Ground(image_from_ground) => grid_on_ground(image_from_ground, size),
        FrameProjection::Nothing => Vec::new(),
    };
    // The homography of a plane gives two equations on the calibration (after K⁻¹ its first two
    // columns are orthogonal and equally long), too few for f and a principal point of two numbers.
    // The middle of the picture is the likeliest one. The closed form starts the refinement in px.
    let principal_point = size.centre();
    let pose = pose_from_plane(&points, principal_point)?.refine(&points, principal_point);
    Ok(Pinhole {
        cam_from_world: pose.cam_from_world,
        position_m: pose.position_m,
        focal_px: pose.focal_px,
        principal_point,
        lens: Radial::default(),
    })
}

/// Ground points (m) of a regular grid of pixels, with the pixels.
fn grid_on_ground(image_from_ground: &Mat3, size: ImageSize) -> Vec<(Vec2, ImagePoint)> {
    let Some(view) = PlaneView::new(image_from_ground, size) else {
        return Vec::new();
    };
    // A grid of pixels weights the whole picture equally. Pixels above the horizon show no ground,
    // and near it they show ground kilometres away, which would dominate the closed form.
    (0..=GRID_STEPS)
        .flat_map(|column| (0..=GRID_STEPS).map(move |row| grid_pixel(column, row, size)))
        .filter_map(|pixel| Some((view.ground_from_image(pixel)?, pixel)))
        .filter(|(ground, _)| ground.amax() < WIDEST_GROUND_M)
        .collect()
}

/// A pixel of the regular grid over the picture, edges included.
fn grid_pixel(column: u32, row: u32, size: ImageSize) -> ImagePoint {
    ImagePoint::new(
        f64::from(column) / f64::from(GRID_STEPS) * f64::from(size.width),
        f64::from(row) / f64::from(GRID_STEPS) * f64::from(size.height),
    )
}

/// The cameras of a new document: one for each picture size.
pub struct Cameras<'a>(pub &'a mut Vec<Shared<Camera>>);

impl Cameras<'_> {
    /// The camera of a size; a new one where there is none.
    pub fn find_or_add(&mut self, size: ImageSize) -> CameraId {
        if let Some(camera) = self.0.iter().find(|camera| camera.image_size == size) {
            return camera.id.clone();
        }
        let name = if self.0.is_empty() {
            "main".to_owned()
        } else {
            format!("main_{}x{}", size.width, size.height)
        };
        let camera = Camera::new(name.as_str().into(), size);
        let id = camera.id.clone();
        self.0.push(camera.into());
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, PtzCamera};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn frame(
        name: &str,
        roll_deg: f64,
        ptz: (f64, f64, f64),
        k1: f64,
    ) -> (FrameCamera, ImageSize, Pinhole) {
        let angles = BaseAngles {
            roll: Angle::from_degrees(roll_deg),
            pitch: Angle::from_degrees(0.4),
            heading: Angle::ZERO,
        };
        let base = CameraBase {
            distortion: FocalCurve {
                k2_per_k1_squared: 2.0,
                ..FocalCurve::constant(k1)
            },
            ..CameraBase::new(
                Vec3::new(1.0, -60.0, 18.0),
                angles.base_from_world(),
                SIZE.centre(),
            )
        };
        let view = Pinhole::from_ptz_camera(&PtzCamera::new(
            base,
            Ptz::from_degrees(ptz.0, ptz.1, ptz.2),
        ));
        (
            FrameCamera::new(name, Some(SIZE), FrameProjection::Camera(view)),
            SIZE,
            view,
        )
    }

    #[test]
    fn frames_of_a_leaning_base_share_a_camera_and_show_what_they_showed() {
        let frames = [
            frame("a.jpg", 0.8, (-20.0, -9.0, 2000.0), -0.1),
            frame("b.jpg", 0.8, (12.0, -11.0, 2000.0), -0.1),
            frame("c.jpg", 0.8, (40.0, -14.0, 3000.0), -0.1),
        ];
        let document = document_of(FieldSpec::new("soccer"), &frames, Exactness::default());
        assert_eq!(document.cameras.len(), 1);
        for (frame, (_, _, view)) in document.frames.iter().zip(&frames) {
            let camera = document.ptz_camera(frame).unwrap();
            for point in [
                Vec3::zeros(),
                Vec3::new(20.0, 10.0, 2.44),
                Vec3::new(-30.0, 20.0, 0.0),
            ] {
                let (a, b) = (
                    camera.image_from_world(point),
                    view.ptz_camera().unwrap().image_from_world(point),
                );
                let Ok(b) = b else { continue };
                assert!(a.unwrap().distance_px(b) < 1e-9, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn frames_that_no_base_explains_have_a_camera_each() {
        let frames = [
            frame("a.jpg", 0.0, (-20.0, -9.0, 2000.0), 0.1),
            frame("b.jpg", 3.0, (12.0, -11.0, 2000.0), 0.1),
            frame("c.jpg", -2.0, (30.0, -11.0, 2000.0), 0.1),
        ];
        let document = document_of(FieldSpec::new("soccer"), &frames, Exactness::default());
        let names: Vec<_> = document
            .cameras
            .iter()
            .map(|camera| camera.id.to_string())
            .collect();
        assert_eq!(names, ["main", "main-2", "main-3"]);
    }
}
