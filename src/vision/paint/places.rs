//! Where a picture shows the paint of a field: what the frames of a camera are adjusted to
//! together.

use super::alignment::ridge_sigma_px;
use super::sightings::Look;
use super::{GroundPicture, Sightings};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, subsample};

/// A place where the middle of a line's paint is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintPlace {
    /// Which line: index into [`FieldModel::lines`].
    pub line: usize,
    /// Where, px.
    pub image: ImagePoint,
    /// 1-σ across the line, px, with its share of what the places of the line have in common.
    pub sigma_px: f64,
}

/// How the picture is looked at, px at 1920 px width.
const LOOK: Look = Look {
    reach_px: 8.0,
    spacing_px: 24.0,
    step_px: 0.5,
};

/// Paint farther from where it is predicted is another line's, px at 1920 px width.
const NEAR_PX: f64 = 5.0;

/// A line with fewer places is none: a sock, a sign.
const FEWEST_OF_LINE: usize = 4;

/// Places of one line, at most; more tell hardly more.
const MOST_OF_LINE: usize = 16;

/// The places of paint near the lines that a camera predicts, line by line.
#[must_use]
pub fn paint_places(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> Vec<PaintPlace> {
    let scale = ground.size().scale_from_1920();
    let look = Look {
        reach_px: LOOK.reach_px * scale,
        spacing_px: LOOK.spacing_px * scale,
        ..LOOK
    };
    let seen = Sightings::of(ground, field, camera, look);
    let mut of_line: Vec<Vec<ImagePoint>> = vec![Vec::new(); field.lines.len()];
    for (index, sample) in seen.samples.iter().enumerate() {
        let near = seen
            .nearest(index, 0.0)
            .filter(|ridge| ridge.offset_px.abs() <= NEAR_PX * scale);
        of_line[sample.line]
            .extend(near.map(|ridge| sample.image.moved(sample.normal * ridge.offset_px)));
    }
    let kept = of_line
        .into_iter()
        .enumerate()
        .filter(|(_, places)| places.len() >= FEWEST_OF_LINE);
    let spread = |(line, places): (usize, Vec<ImagePoint>)| {
        let places = subsample(places, MOST_OF_LINE);
        let sigma_px = ridge_sigma_px(places.len() as u32, scale);
        places.map(move |image| PaintPlace {
            line,
            image,
            sigma_px,
        })
    };
    kept.flat_map(spread).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, camera, soccer, truth};
    use touchline_core::geometry::median;
    use touchline_core::solve::Observation;

    #[test]
    fn places_lie_on_the_paint_whatever_the_camera_that_predicts_it() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        for predicting in [truth(), camera(4.05, -14.04, 1502.0)] {
            let places = paint_places(&ground, &field, &predicting);
            let mut off_px: Vec<f64> = places
                .iter()
                .map(|place| {
                    Observation::of_paint(&field, place.line, place.image, place.sigma_px, 0)
                        .unwrap()
                })
                .map(|seen| seen.distance_px(&truth()).unwrap())
                .collect();
            assert!(
                places.len() > 60 && places.iter().all(|place| place.sigma_px < 1.0),
                "{places:?}"
            );
            assert!(median(&mut off_px).unwrap() < 0.3, "{off_px:?}");
        }
        assert!(paint_places(&ground, &field, &camera(180.0, -14.0, 1500.0)).is_empty());
    }
}
