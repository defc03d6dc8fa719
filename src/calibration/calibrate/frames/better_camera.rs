//! Detects that another camera of the document fits a frame better than its own.

use crate::calibrate::observations;
use std::sync::Arc;
use touchline_core::field::FieldModel;
use touchline_core::solve::{
    CHECK_MISFIT, FrameSolution, SolveContext, Warning, WarningCode, solve_frame,
};
use touchline_documents::document::{Camera, CameraId, Document, Frame};

/// Another camera must reduce χ² by at least this factor.
const BETTER: f64 = 4.0;
/// It must also reduce χ² by at least this difference, which does not happen by chance.
const BETTER_BY: f64 = 16.0;
/// Minimum number of surplus equations: with fewer, another camera may fit by chance.
const MIN_REDUNDANCY: usize = 2;
/// A document of more cameras than this has a camera for each picture, of as many matches: no frame
/// is mistaken for another camera's there, and to compare all with all would take hours.
const MOST_CAMERAS: usize = 40;

/// A camera of the document that fits a frame's clicks, while the frame's own does not.
#[derive(Clone, Debug, PartialEq)]
pub struct BetterCamera {
    /// The camera.
    pub camera: CameraId,
    /// Root mean square residual of the clicks with it, px.
    pub rms_px: f64,
    /// The same with the frame's own camera, px.
    pub own_rms_px: f64,
}

impl BetterCamera {
    /// The warning for the user.
    pub fn warning(&self) -> Warning {
        let Self {
            camera,
            rms_px,
            own_rms_px,
        } = self;
        let message = format!(
            "camera “{camera}” fits to {rms_px:.1} px, this frame's own to {own_rms_px:.1} px"
        );
        Warning {
            code: WarningCode::OtherCamera,
            message,
            clicks: Vec::new(),
        }
    }
}

/// The camera that fits a frame's clicks best, if it fits and the frame's own does not. `fields`
/// contains the field of each camera of the document, in their order (`Fields::per_camera`).
pub fn better_camera(
    document: &Document,
    frame: &Frame,
    solved: &FrameSolution,
    fields: &[Arc<FieldModel>],
) -> Option<BetterCamera> {
    // The cheap conditions come first: every frame of a document passes here, and few fit badly.
    if solved.redundancy < MIN_REDUNDANCY
        || !solved.residuals_are_evidence()
        || document.cameras.len() > MOST_CAMERAS
    {
        return None;
    }
    // The own camera must fit badly: a misfit is the root of χ² over its expectation, and with few
    // surplus equations it scatters more.
    let usual = CHECK_MISFIT + 1.0 / solved.redundancy as f64;
    solved.misfit().filter(|misfit| *misfit > usual)?;
    document
        .cameras
        .iter()
        .zip(fields)
        .filter(|(camera, _)| camera.id != frame.camera && camera.image_size == frame.image_size)
        .filter_map(|(camera, field)| {
            let fit = better_fit(frame, solved, camera, field, usual)?;
            Some((camera, fit))
        })
        .min_by(|a, b| a.1.chi_squared.total_cmp(&b.1.chi_squared))
        .map(|(camera, fit)| BetterCamera {
            camera: camera.id.clone(),
            rms_px: fit.rms_px,
            own_rms_px: solved.rms_px,
        })
}

/// The solution of a frame with another camera, if it fits with a misfit below the usual one and
/// clearly better than the frame's own.
///
/// χ² of two cameras is comparable only with equal numbers of equations. A focal length outside the
/// usual range is no fit.
fn better_fit(
    frame: &Frame,
    own: &FrameSolution,
    camera: &Camera,
    field: &FieldModel,
    usual_misfit: f64,
) -> Option<FrameSolution> {
    let context = SolveContext::new(frame.image_size);
    let fit = solve_frame(&camera.base()?, &observations(frame, field).ok()?, &context).ok()?;
    let fits = fit.redundancy == own.redundancy
        && fit.misfit().is_some_and(|misfit| misfit < usual_misfit);
    // By the factor alone a χ² of 1 would beat one of 5, which happens by chance; by the difference
    // alone a small improvement of many clicks would do.
    let better =
        BETTER * fit.chi_squared < own.chi_squared && fit.chi_squared + BETTER_BY < own.chi_squared;
    (fits && better && context.ranges.contains(&fit.ptz)).then_some(fit)
}

/// Inserts the warning that another camera fits before a solution's other warnings, if one does.
/// `fields` as in [`better_camera`].
pub fn warn_of_better_camera(
    document: &Document,
    frame: &Frame,
    solved: &mut FrameSolution,
    fields: &[Arc<FieldModel>],
) {
    if let Some(better) = better_camera(document, frame, solved, fields) {
        solved.warnings.insert(0, better.warning());
    }
}
