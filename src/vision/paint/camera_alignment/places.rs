//! Where a picture shows the paint of a field: the observations to which the frames of a camera are
//! adjusted jointly.

use super::alignment::ridge_sigma_px;
use super::ground_on_field::ground_on_field;
use super::sightings::{LineObservations, SamplingDistances};
use crate::paint::GroundPicture;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, subsample};
use touchline_core::solve::Observation;

/// A point at which the centre of a line's paint is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintPlace {
    /// The line, as an index into [`FieldModel::lines`].
    pub line: usize,
    /// Position, px.
    pub image: ImagePoint,
    /// 1-σ across the line, px, including this point's share of the error that all points of the
    /// line have in common.
    pub sigma_px: f64,
}

/// Places of paint as observations of the field's lines, numbered from 0.
pub fn observations_of_paint(
    places: &[PaintPlace],
    field: &FieldModel,
) -> impl Iterator<Item = Observation> {
    places.iter().enumerate().filter_map(|(number, place)| {
        Observation::from_paint(field, place.line, place.image, place.sigma_px, number)
    })
}

/// Sampling of the picture, px at 1920 px width.
const LOOK: SamplingDistances = SamplingDistances {
    reach_px: 8.0,
    spacing_px: 24.0,
    step_px: 0.5,
};

/// Maximum distance of paint from where it is predicted, px at 1920 px width. Paint farther away
/// belongs to another line.
const NEAR_PX: f64 = 5.0;

/// Minimum number of points of a line. Fewer may be a sock or a sign.
const FEWEST_OF_LINE: usize = 4;

/// Maximum number of points of a line. More add little, because their common error remains.
const MOST_OF_LINE: usize = 16;

/// The points of paint near the lines that a camera predicts, line by line.
pub fn paint_places(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> Vec<PaintPlace> {
    let ground = &*ground_on_field(ground, field, camera);
    let scale = ground.size().scale_from_1920();
    let look = SamplingDistances {
        reach_px: LOOK.reach_px * scale,
        spacing_px: LOOK.spacing_px * scale,
        ..LOOK
    };
    let seen = LineObservations::search(ground, field, camera, look);
    // The nearest ridge of each sample, if it is near enough.
    let mut of_line: Vec<Vec<ImagePoint>> = vec![Vec::new(); field.lines.len()];
    for (index, sample) in seen.samples.iter().enumerate() {
        let near = seen
            .nearest(index, 0.0)
            .filter(|ridge| ridge.offset_px.abs() <= NEAR_PX * scale);
        of_line[sample.line]
            .extend(near.map(|ridge| sample.image.translate(sample.normal * ridge.offset_px)));
    }
    // Points are spread over the line's whole length. Their common error counts once for the line
    // (see `ridge_sigma_px`), so that the 1-σ of each depends on how many of them there are.
    of_line
        .into_iter()
        .enumerate()
        .filter(|(_, places)| places.len() >= FEWEST_OF_LINE)
        .flat_map(|(line, places)| {
            let places = subsample(places, MOST_OF_LINE);
            let sigma_px = ridge_sigma_px(places.len() as u32, scale);
            places.map(move |image| PaintPlace {
                line,
                image,
                sigma_px,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, camera, soccer, truth};
    use touchline_core::geometry::median;

    #[test]
    fn places_lie_on_the_paint_whatever_the_camera_that_predicts_it() {
        let (ground, field) = (GroundPicture::new(&PICTURE, &[]), soccer());
        for predicting in [truth(), camera(4.05, -14.04, 1502.0)] {
            let places = paint_places(&ground, &field, &predicting);
            let mut off_px: Vec<f64> = places
                .iter()
                .map(|place| {
                    Observation::from_paint(&field, place.line, place.image, place.sigma_px, 0)
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
