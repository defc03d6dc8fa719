//! The likelihood of what pictures show, with lines where cameras have them and without.

use super::picture::{GroundCell, REACH_PX, SeenPicture, SeenSample};
use rayon::prelude::*;
use std::collections::BTreeMap;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_vision::paint::MarkingPixels;

/// The share of wide paint on open ground that is detected in pictures of right cameras.
const DETECTED: f64 = 0.9;

/// 1-σ of detected paint from its line across it, px at 1920 px width, where the camera is right.
const SIGMA_PX: f64 = 1.2;

/// The share of detected markings in reach of a painted line that are not its paint.
const FOREIGN: f64 = 0.05;

/// The least share of places without a line at which a marking is in reach: a picture without any
/// has not shown that there are none.
const MIN_BACKGROUND: f64 = 0.02;

/// The mean rate of all pictures counts as much as this number of places in each.
const PRIOR_PLACES: f64 = 20.0;

/// A place of the ground with at least this many marking pixels in all pictures together counts
/// whole; a person's limb on one picture does not.
const WHOLE_CELL: f64 = 8.0;

/// How likely cameras are by the paint of their pictures, in nats: the logarithm of a ratio of
/// likelihoods, against no line being where they have one.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// Of each line, by its index in the field; 0 for a line that no picture shows.
    pub of_lines: Vec<f64>,
    /// Of the paint on the field that lies on no line, at most 0.
    pub unexplained: f64,
}

impl Evidence {
    /// Weighs the marking pixels of pictures against the lines that their cameras predict.
    pub fn weigh(field: &FieldModel, pictures: &[(PtzCamera, &MarkingPixels)]) -> Self {
        let seen: Vec<SeenPicture> = pictures
            .par_iter()
            .map(|(camera, marking_pixels)| SeenPicture::look(field, camera, marking_pixels))
            .collect();
        Self {
            of_lines: weigh_lines(field.lines.len(), &seen),
            unexplained: weigh_unexplained(&seen),
        }
    }

    /// How much speaks against the cameras where they have lines, as a share of what speaks for
    /// them; infinite where nothing does. A camera that is right has no line on bare ground,
    /// whatever else it explains.
    pub fn contradicted_share(&self) -> f64 {
        let (mut supporting, mut contradicting) = (0.0, 0.0);
        for nats in &self.of_lines {
            supporting += nats.max(0.0);
            contradicting -= nats.min(0.0);
        }
        if supporting > 0.0 {
            contradicting / supporting
        } else {
            f64::INFINITY
        }
    }

    /// All of it.
    pub fn nats(&self) -> f64 {
        self.of_lines.iter().sum::<f64>() + self.unexplained
    }
}

fn weigh_lines(num_lines: usize, seen: &[SeenPicture]) -> Vec<f64> {
    let sum = |of: fn(&SeenPicture) -> usize| seen.iter().map(of).sum::<usize>() as f64;
    // What few places show of one picture is completed by the mean of all.
    let background_of_all = (sum(|picture| picture.num_beside_painted) + 2.0)
        / (sum(|picture| picture.num_beside) + PRIOR_PLACES);
    let mut of_stretches: BTreeMap<(usize, GroundCell), Mean> = BTreeMap::new();
    for picture in seen {
        let background = (picture.num_beside_painted as f64 + PRIOR_PLACES * background_of_all)
            / (picture.num_beside as f64 + PRIOR_PLACES);
        let background = background.clamp(MIN_BACKGROUND, 0.9);
        for sample in &picture.samples {
            of_stretches
                .entry((sample.line, sample.cell))
                .or_default()
                .add(log_ratio(sample, background));
        }
    }
    let mut of_lines = vec![0.0; num_lines];
    for ((line, _), stretch) in of_stretches {
        of_lines[line] += stretch.mean();
    }
    of_lines
}

/// The logarithm of how much more likely a sample looks as it does with paint than without.
fn log_ratio(sample: &SeenSample, background: f64) -> f64 {
    let detected = DETECTED * sample.detectability;
    let Some(offset_px) = sample.offset_px else {
        // Neither its paint nor a foreign marking.
        return (1.0 - detected).ln();
    };
    let foreign = background / (2.0 * REACH_PX);
    let z = offset_px / SIGMA_PX;
    let gauss = (-0.5 * z * z).exp() / (SIGMA_PX * std::f64::consts::TAU.sqrt());
    let painted = (1.0 - FOREIGN) * gauss + FOREIGN / (2.0 * REACH_PX);
    ((detected * painted + (1.0 - detected) * foreign) / foreign).ln()
}

/// The paint that no line explains, as a Poisson process over the ground: without a line anywhere
/// all paint is clutter, with the cameras' lines only this is, and its density falls by the same
/// share. What remains of the likelihood ratio at each of its places is the logarithm of that share.
fn weigh_unexplained(seen: &[SeenPicture]) -> f64 {
    let mut of_cells: BTreeMap<GroundCell, Mean> = BTreeMap::new();
    for (cell, is_explained) in seen.iter().flat_map(|picture| &picture.paint) {
        let unexplained = if *is_explained { 0.0 } else { 1.0 };
        of_cells.entry(*cell).or_default().add(unexplained);
    }
    let weight = |cell: &Mean| (cell.count / WHOLE_CELL).min(1.0);
    let painted: f64 = of_cells.values().map(weight).sum();
    let unexplained: f64 = of_cells
        .values()
        .map(|cell| weight(cell) * cell.mean())
        .sum();
    if unexplained > 0.0 {
        unexplained * (unexplained / painted).ln()
    } else {
        0.0
    }
}

/// A mean of what is added one by one.
#[derive(Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1.0;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::field::builtin;
    use touchline_core::geometry::{Angle, ImageSize};
    use touchline_core::markings::{SampleOptions, sample_lines};
    use touchline_core::testing::turned_base;
    use touchline_vision::media::Picture;
    use touchline_vision::paint::GroundPicture;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    fn soccer() -> FieldModel {
        builtin("soccer").unwrap().default_model().unwrap()
    }

    /// A camera of the main stand that sees one end.
    fn camera(pan_deg: f64) -> PtzCamera {
        let base = turned_base([-6.0, -62.0, 14.0], [0.0, 0.0, 0.0], SIZE);
        PtzCamera::new(base, Ptz::from_degrees(pan_deg, -11.0, 1000.0))
    }

    /// The marking pixels of turf on which a camera sees the lines of a field, 3 px wide.
    fn markings_of(field: &FieldModel, camera: &PtzCamera) -> MarkingPixels {
        let mut picture = vec![[60_u8, 120, 60, 255]; (SIZE.width * SIZE.height) as usize];
        let options = SampleOptions {
            spacing_px: 0.4,
            border_px: 2.0,
        };
        for sample in sample_lines(field, camera, SIZE, &options) {
            for across in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                let at = sample.image.translate(sample.normal * across);
                picture[at.y as usize * SIZE.width as usize + at.x as usize] = [230, 230, 230, 255];
            }
        }
        let picture = Picture::new(SIZE, picture.concat()).unwrap();
        MarkingPixels::detect(&GroundPicture::new(&picture, &[]))
    }

    #[test]
    fn evidence_is_large_for_the_right_camera_and_falls_with_each_px_beside_it() {
        let field = soccer();
        let right = camera(-20.0);
        let markings = markings_of(&field, &right);
        let nats = |px: f64| {
            let mut ptz = right.ptz();
            ptz.tilt = ptz.tilt + Angle::from_radians(px / ptz.focal_px);
            Evidence::weigh(&field, &[(PtzCamera::new(*right.base(), ptz), &markings)]).nats()
        };
        let of_offsets = [0.0, 1.0, 2.0, 4.0].map(nats);
        assert!(of_offsets[0] > 200.0, "{of_offsets:?}");
        assert!(of_offsets.is_sorted_by(|a, b| a > b), "{of_offsets:?}");
        assert!(nats(20.0) < 0.0, "{}", nats(20.0));
    }

    /// The same picture twice shows no more than once.
    #[test]
    fn a_picture_that_is_repeated_adds_nothing() {
        let field = soccer();
        let camera = camera(-20.0);
        let markings = markings_of(&field, &camera);
        let once = Evidence::weigh(&field, &[(camera, &markings)]);
        let twice = Evidence::weigh(&field, &[(camera, &markings), (camera, &markings)]);
        assert!((once.nats() - twice.nats()).abs() < 0.05 * once.nats());
        let other = super::tests::camera(15.0);
        let more = [(camera, &markings), (other, &markings_of(&field, &other))];
        assert!(Evidence::weigh(&field, &more).nats() > 1.3 * once.nats());
    }

    #[test]
    fn lines_on_bare_ground_contradict_a_camera() {
        let share = |of_lines: &[f64]| {
            let evidence = Evidence {
                of_lines: of_lines.to_vec(),
                unexplained: -50.0,
            };
            evidence.contradicted_share()
        };
        assert_eq!(share(&[30.0, -3.0, 10.0, -1.0]), 0.1);
        assert_eq!(share(&[30.0, 0.0]), 0.0);
        assert_eq!([share(&[-3.0]), share(&[])], [f64::INFINITY; 2]);
    }

    #[test]
    fn a_camera_that_sees_no_ground_has_no_evidence() {
        let field = soccer();
        let markings = markings_of(&field, &camera(-20.0));
        let none = Evidence::weigh(&field, &[]);
        assert_eq!((none.nats(), none.of_lines.len()), (0.0, field.lines.len()));
        let away = Evidence::weigh(&field, &[(camera(170.0), &markings)]);
        assert_eq!(away.of_lines, vec![0.0; field.lines.len()]);
    }

    #[test]
    fn paint_that_no_line_explains_speaks_against_a_camera() {
        let field = soccer();
        let camera = camera(-20.0);
        let markings = markings_of(&field, &camera);
        let mut without_area = field.clone();
        without_area
            .lines
            .retain(|line| !line.id.as_str().starts_with("penalty_area"));
        let [all, fewer] =
            [&field, &without_area].map(|field| Evidence::weigh(field, &[(camera, &markings)]));
        assert!(fewer.unexplained < all.unexplained - 20.0, "{fewer:?}");
    }
}
