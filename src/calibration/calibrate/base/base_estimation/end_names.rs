//! Landmarks that are named as they look from behind an end of the field.
//!
//! Such clicks fit no camera, or badly, and under the template's names they fit well. Both are
//! tried before clicks are said to give no base.

use super::{BaseEstimationError, BaseProblem, EstimatedBase};
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use touchline_core::field::FieldModel;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseError, BaseOptions, FrameClicks};
use touchline_documents::document::{CameraId, Document, Frame, Target};

/// Names as they look are wrong if they leave the clicks this far off, median, px at 1920 px width,
/// and the template's names leave less than this share of it.
const MIN_MEDIAN_PX: f64 = 8.0;
const MAX_SHARE: f64 = 0.25;

/// Maximum number of renames that a message lists.
const MAX_LISTED: usize = 4;

/// The names that were given as they look from behind an end, each with the template's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EndNames {
    renames: BTreeSet<(String, String)>,
}

impl Display for EndNames {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let listed = self.renames.iter().take(MAX_LISTED);
        let listed: Vec<String> = listed
            .map(|(looks, is)| format!("{looks} is {is}"))
            .collect();
        let more = if self.renames.len() > MAX_LISTED {
            ", …"
        } else {
            ""
        };
        write!(
            f,
            "its points are named as they look from behind an end, and names are those of a camera in the main \
             stand: {}{more}",
            listed.join(", ")
        )
    }
}

impl BaseProblem {
    /// The names to change if the clicks, which gave this base or none as they are named, were
    /// named as they look from behind an end.
    pub(super) fn names_behind_an_end(
        &self,
        document: &Document,
        as_named: Result<&EstimatedBase, &BaseEstimationError>,
        options: &BaseOptions,
    ) -> Option<EndNames> {
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
        let renamed = Self {
            clicks: self
                .clicks
                .iter()
                .map(|frame| turn(frame, &self.field))
                .collect(),
            previous: None,
            ..self.clone()
        };
        let fits = renamed.estimate_as_named(document, options, &Progress::default());
        if !fits.is_ok_and(|fits| fits.estimate.median_px < limit_px) {
            return None;
        }
        let clicks = self
            .frames
            .iter()
            .flat_map(|&index| &document.frames[index].clicks);
        let renames = clicks
            .filter_map(|click| {
                let looks = click.target.as_ref()?;
                let is = meant(looks, &self.field)?;
                Some((looks.as_str().to_owned(), is.as_str().to_owned()))
            })
            .collect();
        Some(EndNames { renames })
    }
}

/// The clicks of a frame under the names that are meant.
fn turn(frame: &FrameClicks, field: &FieldModel) -> FrameClicks {
    let observations = frame.observations.iter().map(|seen| {
        let meant = seen
            .element
            .map(|element| element.named_behind_an_end(field));
        meant
            .and_then(|element| seen.with_element(field, element))
            .unwrap_or(*seen)
    });
    FrameClicks {
        observations: observations.collect(),
        start: None,
    }
}

fn meant(looks: &Target, field: &FieldModel) -> Option<Target> {
    match looks {
        Target::Landmark(id) => id.named_behind_an_end(field).map(Target::Landmark),
        Target::Line(id) => id.named_behind_an_end(field).map(Target::Line),
    }
}

/// Gives the clicks of a camera, which were named as they look from behind an end, the template's
/// names. Returns the number of frames with such clicks.
pub(crate) fn rename_behind_an_end(
    document: &mut Document,
    camera: &CameraId,
    field: &FieldModel,
) -> usize {
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
            targets.any(|target| meant(target, field).is_some())
        };
        if !has_other(frame) {
            continue;
        }
        let frame: &mut Frame = frame;
        for click in &mut frame.clicks {
            let other = click.target.as_ref().and_then(|looks| meant(looks, field));
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

    /// A camera in the stand behind the left end.
    fn behind_the_end(field: &FieldModel) -> PtzCamera {
        let towards_x = BaseAngles {
            heading: Angle::from_degrees(90.0),
            ..BaseAngles::default()
        };
        let (x_m, z_m) = (-1.4 * field.length_m, 0.35 * field.length_m);
        let position_m = Vec3::new(x_m, 0.1, z_m);
        let base = CameraBase::new(position_m, towards_x.base_from_world(), SIZE.centre());
        PtzCamera::new(base, Ptz::from_degrees(0.0, -15.0, 1500.0))
    }

    /// A document with exact clicks of the ground that the camera shows, under the names that they
    /// have as they look.
    fn named_as_they_look(template: &str) -> (Document, PtzCamera, FieldModel) {
        let field = builtin(template).unwrap().default_model().unwrap();
        let camera = behind_the_end(&field);
        let mut document = match_from(camera.base(), SIZE);
        document.field = FieldSpec::new(template);
        document.cameras[0].position_m = None;
        document.cameras[0].base_from_world = None;
        let mut frame = Frame::from_image("1.png", "main".into(), SIZE);
        frame.status = FrameStatus::New;
        for shown in project_landmarks(&field, &camera, SIZE, 0.0) {
            let landmark = &field.landmarks[shown.landmark];
            let element = FieldElement::Landmark(shown.landmark);
            if landmark.is_on_ground() && element.named_behind_an_end(&field) != element {
                // Three more quarters are one back.
                let looks = (0..3).fold(element, |at, _| at.named_behind_an_end(&field));
                let FieldElement::Landmark(looks) = looks else {
                    unreachable!("a landmark stays one");
                };
                let looks = field.landmarks[looks].id.clone();
                frame.clicks.push(Click::landmark(looks, shown.image));
            }
        }
        assert!(frame.clicks.len() >= 4, "{template}");
        document.frames.push(frame.into());
        (document, camera, field)
    }

    #[test]
    fn names_as_they_look_behind_an_end_give_the_base_once_they_are_changed() {
        for template in builtin_names() {
            let (mut document, camera, field) = named_as_they_look(template);
            let estimate = |document: &Document| {
                let at = document.at(Path::new(""));
                let problem = BaseProblem::from_document(at, &"main".into()).unwrap();
                problem.estimate(document, &BaseOptions::default(), &Progress::default())
            };
            let error = estimate(&document).unwrap_err();
            let BaseEstimationError::NamedBehindAnEnd(names) = &error else {
                panic!("{template}: {error}");
            };
            let num_named = document.frames[0].clicks.len();
            assert!((4..=num_named).contains(&names.renames.len()), "{template}");
            assert_eq!(
                rename_behind_an_end(&mut document, &"main".into(), &field),
                1
            );
            let found = estimate(&document).unwrap();
            let off_m = (found.estimate.base.position_m - camera.base().position_m).norm();
            assert!(off_m < 0.02 * field.length_m, "{template}: {off_m} m");
        }
    }
}
