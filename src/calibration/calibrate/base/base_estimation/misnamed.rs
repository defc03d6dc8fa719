//! Points that are named for the wrong sides in all frames of a camera.
//!
//! Clicks that are named as they look from behind an end, or left for right, fit no camera, or
//! badly, and under the template's names they fit well. These are tried before clicks are said to
//! give no base.

use super::{BaseEstimationError, BaseProblem, EstimatedBase};
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use touchline_core::field::{FieldModel, Misnaming};
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseError, BaseOptions, FrameClicks};
use touchline_documents::document::{CameraId, Document, Frame, Target};

/// Names are wrong if they leave the clicks this far off, median, px at 1920 px width, and the
/// names that are meant leave less than this share of it.
const MIN_MEDIAN_PX: f64 = 8.0;
const MAX_SHARE: f64 = 0.25;

/// Maximum number of renames that a message lists.
const MAX_LISTED: usize = 4;

/// The names of points that were given for the wrong sides, each with the template's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misnamed {
    misnaming: Misnaming,
    renames: BTreeSet<(String, String)>,
}

impl Display for Misnamed {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let listed = self.renames.iter().take(MAX_LISTED);
        let listed: Vec<String> = listed
            .map(|(named, is)| format!("{named} is {is}"))
            .collect();
        let more = if self.renames.len() > MAX_LISTED {
            ", …"
        } else {
            ""
        };
        let why = match self.misnaming {
            Misnaming::BehindAnEnd => {
                "its points are named as they look from behind an end, and names are those of a \
                 camera in the main stand"
            }
            Misnaming::LeftForRight => {
                "its points are named left for right: no camera shows the field so"
            }
            Misnaming::NearForFar => {
                "its points are named near for far: no camera shows the field so"
            }
        };
        write!(f, "{why}: {}{more}", listed.join(", "))
    }
}

impl BaseProblem {
    /// The names to change if the clicks, which gave this base or none as they are named, were
    /// named for the wrong sides.
    pub(super) fn find_misnaming(
        &self,
        document: &Document,
        as_named: Result<&EstimatedBase, &BaseEstimationError>,
        options: &BaseOptions,
    ) -> Option<Misnamed> {
        let limit_px = match as_named {
            Ok(found) => {
                let least_px = MIN_MEDIAN_PX * self.image_size.scale_from_1920();
                let median_px = found.estimate.median_px;
                (median_px > least_px).then_some(MAX_SHARE * median_px)?
            }
            // Whoever cancelled the estimation does not wait for two others.
            Err(BaseEstimationError::Base(BaseError::Stopped)) => return None,
            Err(BaseEstimationError::Base(_)) => MIN_MEDIAN_PX * self.image_size.scale_from_1920(),
            Err(_) => return None,
        };
        let misnaming = Misnaming::ALL
            .into_iter()
            .find(|misnaming| self.fits_renamed(*misnaming, document, options, limit_px))?;
        let clicks = self
            .frames
            .iter()
            .flat_map(|&index| &document.frames[index].clicks);
        let renames = clicks
            .filter_map(|click| {
                let named = click.target.as_ref()?;
                let is = meant(misnaming, named, &self.field)?;
                Some((named.as_str().to_owned(), is.as_str().to_owned()))
            })
            .collect();
        Some(Misnamed { misnaming, renames })
    }

    /// Whether the clicks give a base within a median error once their names are changed.
    fn fits_renamed(
        &self,
        misnaming: Misnaming,
        document: &Document,
        options: &BaseOptions,
        limit_px: f64,
    ) -> bool {
        let renamed = Self {
            clicks: self
                .clicks
                .iter()
                .map(|frame| rename(misnaming, frame, &self.field))
                .collect(),
            previous: None,
            ..self.clone()
        };
        let fits = renamed.estimate_as_named(document, options, &Progress::default());
        fits.is_ok_and(|fits| {
            // A mirror image is put right by exchanging left and right, and by exchanging near and
            // far, which is half a turn away: near is what is nearer to the camera.
            let is_on_near_side = fits.estimate.base.position_m.y < 0.0;
            fits.estimate.median_px < limit_px
                && (misnaming == Misnaming::BehindAnEnd || is_on_near_side)
        })
    }
}

/// The clicks of a frame under the names that are meant.
fn rename(misnaming: Misnaming, frame: &FrameClicks, field: &FieldModel) -> FrameClicks {
    let observations = frame.observations.iter().map(|seen| {
        let meant = seen
            .element
            .map(|element| misnaming.meant_element(element, field));
        meant
            .and_then(|element| seen.with_element(field, element))
            .unwrap_or(*seen)
    });
    FrameClicks {
        observations: observations.collect(),
        start: None,
    }
}

fn meant(misnaming: Misnaming, named: &Target, field: &FieldModel) -> Option<Target> {
    match named {
        Target::Landmark(id) => misnaming.meant_landmark(id, field).map(Target::Landmark),
        Target::Line(id) => misnaming.meant_line(id, field).map(Target::Line),
    }
}

/// Gives the clicks of a camera, which were named for the wrong sides, the names that are meant.
/// Returns the number of frames with such clicks.
pub(crate) fn rename_clicks(
    document: &mut Document,
    camera: &CameraId,
    misnamed: &Misnamed,
    field: &FieldModel,
) -> usize {
    let misnaming = misnamed.misnaming;
    let mut count = 0;
    for frame in document
        .frames
        .iter_mut()
        .filter(|frame| frame.camera == *camera)
    {
        let has_other = |frame: &Frame| {
            let mut targets = frame
                .clicks
                .iter()
                .filter_map(|click| click.target.as_ref());
            targets.any(|target| meant(misnaming, target, field).is_some())
        };
        if !has_other(frame) {
            continue;
        }
        let frame: &mut Frame = frame;
        for click in &mut frame.clicks {
            let named = click.target.as_ref();
            let other = named.and_then(|named| meant(misnaming, named, field));
            click.target = other.or_else(|| click.target.take());
        }
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
    use touchline_core::field::{FieldElement, builtin, builtin_names};
    use touchline_core::geometry::{Angle, ImageSize, Vec3};
    use touchline_core::markings::project_landmarks;
    use touchline_documents::document::{Click, FieldSpec, FrameStatus};
    use touchline_documents::testing::match_from;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// A camera in the stand behind the left end, or in the main stand.
    fn camera_at(field: &FieldModel, behind_the_end: bool) -> PtzCamera {
        let (heading_deg, x_m, y_m) = if behind_the_end {
            (90.0, -1.4 * field.length_m, 0.1)
        } else {
            (0.0, 0.05 * field.length_m, -1.4 * field.length_m)
        };
        let angles = BaseAngles {
            heading: Angle::from_degrees(heading_deg),
            ..BaseAngles::default()
        };
        let position_m = Vec3::new(x_m, y_m, 0.35 * field.length_m);
        let base = CameraBase::new(position_m, angles.base_from_world(), SIZE.centre());
        PtzCamera::new(base, Ptz::from_degrees(0.0, -15.0, 1500.0))
    }

    /// A document with exact clicks of the ground that the camera shows, named for the wrong sides.
    fn misnamed(template: &str, misnaming: Misnaming) -> (Document, PtzCamera, FieldModel) {
        let field = builtin(template).unwrap().default_model().unwrap();
        let camera = camera_at(&field, misnaming == Misnaming::BehindAnEnd);
        let mut document = match_from(camera.base(), SIZE);
        document.field = FieldSpec::new(template);
        document.cameras[0].position_m = None;
        document.cameras[0].base_from_world = None;
        let mut frame = Frame::from_image("1.png", "main".into(), SIZE);
        frame.status = FrameStatus::New;
        for shown in project_landmarks(&field, &camera, SIZE, 0.0) {
            let landmark = &field.landmarks[shown.landmark];
            let element = FieldElement::Landmark(shown.landmark);
            if landmark.is_on_ground() && misnaming.meant_element(element, &field) != element {
                // Three more quarters are one back, and so are three exchanges.
                let looks = (0..3).fold(element, |at, _| misnaming.meant_element(at, &field));
                let FieldElement::Landmark(looks) = looks else {
                    unreachable!("a landmark stays one");
                };
                let looks = field.landmarks[looks].id.clone();
                frame.clicks.push(Click::landmark(looks, shown.image));
            }
        }
        document.frames.push(frame.into());
        (document, camera, field)
    }

    fn estimate(document: &Document) -> Result<EstimatedBase, BaseEstimationError> {
        let problem = BaseProblem::from_document(document.at(Path::new("")), &"main".into());
        problem?.estimate(document, &BaseOptions::default(), &Progress::default())
    }

    #[test]
    fn names_for_the_wrong_sides_give_the_base_once_they_are_changed() {
        let mut tried = 0;
        for (template, misnaming) in builtin_names()
            .into_iter()
            .flat_map(|template| Misnaming::ALL.map(|misnaming| (template, misnaming)))
        {
            let what = format!("{template} {misnaming:?}");
            let (mut document, camera, field) = misnamed(template, misnaming);
            let num_named = document.frames[0].clicks.len();
            // A squash court has a front and a back in place of left and right.
            if num_named < 4 {
                continue;
            }
            tried += 1;
            let error = estimate(&document).unwrap_err();
            let BaseEstimationError::Misnamed(names) = &error else {
                panic!("{what}: {error}");
            };
            assert_eq!(names.misnaming, misnaming, "{template}");
            assert!((4..=num_named).contains(&names.renames.len()), "{what}");
            let names = names.clone();
            assert_eq!(
                rename_clicks(&mut document, &"main".into(), &names, &field),
                1
            );
            let found = estimate(&document).unwrap();
            let off_m = (found.estimate.base.position_m - camera.base().position_m).norm();
            assert!(off_m < 0.02 * field.length_m, "{what}: {off_m} m");
        }
        assert!(tried > 50, "{tried}");
    }
}
