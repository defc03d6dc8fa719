//! Keeps a frame's lines in place on the picture when its camera's base has changed.
//!
//! The frame has no clicks of its own. What a person accepted were the projected lines, so pan,
//! tilt and focal length are solved for again such that these stay where they were as well as the
//! new base allows.

use crate::calibrate::paint::{BASE_MOVED, replace_warning};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3, median_high};
use touchline_core::solve::{ClickResidual, Observation, SolveContext, solve_frame};
use touchline_documents::document::{Document, Frame};

/// Columns and rows of the grid of pixels that are to keep their ground points.
const COLUMNS: u32 = 7;
const ROWS: u32 = 5;
/// Ground points farther than this from the field's centre are not used, m.
const REACH_M: f64 = 90.0;
/// Minimum number of ground points.
const MIN_POINTS: usize = 4;
/// 1-σ of the old lines, px at 1920 px width.
const SIGMA_PX: f64 = 2.0;
/// Lines that end up farther off than this cause a warning, px at 1920 px width.
const TOLERATED_PX: f64 = 5.0;

/// Adjusts pan, tilt and zoom of a frame so that its lines project as before its base changed;
/// `before` is the document until then. A frame that was not solved, or that shows too little
/// ground, is not changed.
pub fn refit(document: &mut Document, index: usize, before: &Document) {
    let Some(known) = before
        .frames
        .get(index)
        .and_then(|frame| before.ptz_camera(frame))
    else {
        return;
    };
    let Some(frame) = document.frames.get(index) else {
        return;
    };
    // With the frame's own lens, if it states one: it is drawn with that.
    let camera = document.camera_of(frame);
    let Some(base) = camera.and_then(|camera| camera.base_for(frame)) else {
        return;
    };
    let Some(OnBase { ptz, off_px, .. }) = ptz_on_base(&known, &base, frame.image_size) else {
        return;
    };
    // `get_mut` marks the frame as changed, so it is called only once there is a change.
    let Some(frame) = document.frames.get_mut(index) else {
        return;
    };
    frame.point(ptz, base.distortion.radial_at(ptz.focal_px));
    describe(frame, off_px);
}

/// Adds a warning if the lines moved nevertheless.
fn describe(frame: &mut Frame, off_px: f64) {
    let Some(solution) = &mut frame.solution else {
        return;
    };
    let is_off = off_px > TOLERATED_PX * frame.image_size.scale_from_1920();
    let message = is_off.then(|| {
        format!(
            "The base changed after this frame was accepted: its lines moved by up to {off_px:.0} px. Check it again."
        )
    });
    replace_warning(solution, BASE_MOVED, message);
}

/// A camera turned and zoomed on another base, and how far it is from what it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OnBase {
    pub ptz: Ptz,
    /// The largest distance of the ground from where it was in the picture, px.
    pub off_px: f64,
    /// The median distance, px at 1920 px width.
    pub moved_px: f64,
}

/// Pan, tilt and focal length on another base that keep the ground in place on the picture as well
/// as possible. None if the picture shows too little ground.
pub(crate) fn ptz_on_base(
    before: &PtzCamera,
    base: &CameraBase,
    image_size: ImageSize,
) -> Option<OnBase> {
    // What the old camera sees of the ground serves as landmark clicks for the new base.
    let sigma_px = SIGMA_PX * image_size.scale_from_1920();
    let observations: Vec<Observation> = visible_ground(before, image_size)
        .enumerate()
        .map(|(click, (image, ground))| Observation::from_point(ground, image, sigma_px, click))
        .collect();
    // A picture of stands or sky has no ground to keep in place.
    if observations.len() < MIN_POINTS {
        return None;
    }
    // Start at the old camera: the new one should look nearly the same way.
    let context = SolveContext {
        start: Some(before.ptz()),
        ..SolveContext::new(image_size)
    };
    let solved = solve_frame(base, &observations, &context).ok()?;
    let off_px = solved
        .residuals
        .iter()
        .filter_map(ClickResidual::distance_px)
        .fold(0.0, f64::max);
    let now = PtzCamera::new(*base, solved.ptz);
    Some(OnBase {
        ptz: solved.ptz,
        off_px,
        moved_px: ground_moved_px(before, &now, image_size)? / image_size.scale_from_1920(),
    })
}

/// How far the ground that one camera sees lies away in the picture of another one, px: the median
/// over the picture. Infinite where the second does not see it; none if the first sees none.
pub(crate) fn ground_moved_px(
    before: &PtzCamera,
    after: &PtzCamera,
    image_size: ImageSize,
) -> Option<f64> {
    let mut moved: Vec<f64> = visible_ground(before, image_size)
        .map(|(image, ground)| {
            let now = after.image_from_world(ground);
            now.map_or(f64::INFINITY, |now| now.distance_px(image))
        })
        .collect();
    median_high(&mut moved)
}

/// The pixels of a grid over the picture that show ground near the field, and that ground (z = 0).
fn visible_ground(
    camera: &PtzCamera,
    image_size: ImageSize,
) -> impl Iterator<Item = (ImagePoint, Vec3)> {
    image_size
        .cell_centres(COLUMNS, ROWS)
        .filter_map(|image| Some((image, camera.plane_from_image(image, 0.0)?)))
        .filter(|(_, ground)| ground.norm() <= REACH_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Radial;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::{FramePtz, Solution};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    fn base(height_m: f64) -> CameraBase {
        base_at([0.0, -62.0, height_m], SIZE)
    }

    fn accepted() -> Document {
        let mut document = match_from(&base(17.0), SIZE);
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(5.0, -14.0, 2300.0);
        frame.solution = Some(Solution::default());
        document.frames.push(frame.into());
        document
    }

    #[test]
    fn lines_stay_on_the_picture_when_the_base_moves_a_little() {
        let before = accepted();
        let mut after = before.clone();
        after.cameras[0].set_base(&base(17.2));
        let ground = Vec3::new(5.0, 3.0, 0.0);
        let at = |document: &Document| {
            document
                .ptz_camera(&document.frames[0])
                .unwrap()
                .image_from_world(ground)
                .unwrap()
        };
        assert!(
            at(&before).distance_px(at(&after)) > 5.0,
            "without a word the lines would have moved"
        );
        refit(&mut after, 0, &before);
        assert!(
            at(&before).distance_px(at(&after)) < 1.5,
            "{:?} {:?}",
            at(&before),
            at(&after)
        );
        assert!(
            after.frames[0]
                .solution
                .as_ref()
                .unwrap()
                .warnings
                .is_empty()
        );
    }

    #[test]
    fn a_frame_keeps_its_own_lens_where_its_camera_has_none() {
        let mut before = accepted();
        let ptz = Ptz::from_degrees(5.0, -14.0, 2300.0);
        before.frames[0].ptz = Some(FramePtz::new(ptz, Some(Radial::k1(-0.1))));
        let mut after = before.clone();
        after.cameras[0].set_base(&base(17.2));
        refit(&mut after, 0, &before);
        let now = after.frames[0].ptz.as_ref().unwrap();
        assert_eq!(now.k1, Some(-0.1));
        assert_ne!(now.tilt_deg, -14.0);
    }

    #[test]
    fn a_base_that_cannot_keep_the_lines_is_reported() {
        let before = accepted();
        let mut after = before.clone();
        after.cameras[0].set_base(&base(25.0));
        refit(&mut after, 0, &before);
        let warnings = &after.frames[0].solution.as_ref().unwrap().warnings;
        assert_eq!(warnings[0].code, "base_moved");
        assert!(
            warnings[0]
                .message
                .starts_with("The base changed after this frame was accepted"),
            "{warnings:?}"
        );
    }

    #[test]
    fn a_picture_of_the_sky_stays_as_it_is() {
        let mut before = accepted();
        before.frames[0].ptz = ptz_at(5.0, 30.0, 2300.0);
        let mut after = before.clone();
        after.cameras[0].set_base(&base(18.0));
        refit(&mut after, 0, &before);
        assert_eq!(after.frames, before.frames);
    }
}
