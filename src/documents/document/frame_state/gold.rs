//! Gold frames: labelled frames whose landmarks are clicked again, blind, to measure the
//! annotator's click noise.
//!
//! A frame is gold because the user marked it or the program chose it (`calibrate::choose_gold`).
//! Blind clicks are stored in the frame ([`Repeat`](crate::document::Repeat)) and never change its
//! label.

use crate::document::{Document, Frame, FrameStatus, Target};
use touchline_core::field::LandmarkId;
use touchline_core::geometry::{ImagePoint, Vec2};

/// The clicks on one landmark of a frame: the label's, then the blind ones.
pub struct RepeatedClicks<'a> {
    /// Which landmark.
    pub landmark: &'a LandmarkId,
    /// The index of the label among the frame's clicks; none where it no longer exists.
    pub labelled: Option<usize>,
    /// The clicked pixels, px, in the order of their rounds.
    pub clicks: Vec<ImagePoint>,
}

impl RepeatedClicks<'_> {
    /// Independent differences, each with the variance of one click in each coordinate (Helmert
    /// 1876): (m − c) √(j / (j + 1)) for a click c after j clicks with the mean m. px of the frame.
    pub fn differences(&self) -> impl Iterator<Item = Vec2> + '_ {
        let mut sum = Vec2::zeros();
        self.clicks
            .iter()
            .enumerate()
            .filter_map(move |(before, click)| {
                let at = Vec2::new(click.x, click.y);
                // The mean of the earlier clicks has the variance σ²/j, the difference σ² (j +
                // 1)/j; the factor makes it σ².
                let count = before as f64;
                let difference =
                    (before > 0).then(|| (sum / count - at) * (count / (count + 1.0)).sqrt());
                sum += at;
                difference
            })
    }
}

impl Frame {
    /// Why it cannot be gold; none if it can.
    pub fn why_not_gold(&self) -> Option<&'static str> {
        if self.status != FrameStatus::Reference {
            return Some("Only a reference can be gold: accept this frame first.");
        }
        self.landmarks_to_repeat()
            .next()
            .is_none()
            .then_some("This frame has no clicked landmark: there is nothing to click again.")
    }

    /// The landmarks that the user clicks again in a blind round, in the order of the label's
    /// clicks.
    pub fn landmarks_to_repeat(&self) -> impl Iterator<Item = &LandmarkId> {
        self.clicks.iter().filter_map(|click| match &click.target {
            Some(Target::Landmark(id)) => Some(id),
            _ => None,
        })
    }

    /// The landmarks that were clicked again, each with all its clicks.
    pub fn repeated_clicks(&self) -> Vec<RepeatedClicks<'_>> {
        let mut found: Vec<RepeatedClicks<'_>> = Vec::new();
        for repeat in self
            .repeats
            .iter()
            .filter(|repeat| repeat.image.is_finite())
        {
            if let Some(known) = found
                .iter_mut()
                .find(|known| *known.landmark == repeat.landmark)
            {
                known.clicks.push(repeat.image);
                continue;
            }
            // The first repeat of a landmark: the label's click goes before it, because the
            // annotator clicked it first.
            let labelled = self.clicks.iter().position(|click| match &click.target {
                Some(Target::Landmark(id)) => *id == repeat.landmark && click.image.is_finite(),
                _ => false,
            });
            let label = labelled.and_then(|labelled| self.clicks.get(labelled));
            // A point that the program moved onto paint is no sample of the annotator's click
            // noise.
            let label = label
                .filter(|click| click.snapped_sigma_px.is_none())
                .map(|click| click.image);
            let clicks = label.into_iter().chain([repeat.image]).collect();
            found.push(RepeatedClicks {
                landmark: &repeat.landmark,
                labelled,
                clicks,
            });
        }
        found
    }
}

impl Document {
    /// The number of the next blind round.
    pub fn next_round(&self) -> u32 {
        let rounds = self
            .frames
            .iter()
            .flat_map(|frame| &frame.repeats)
            .map(|repeat| repeat.round);
        rounds.max().unwrap_or(0).saturating_add(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Repeat;
    use crate::testing::reference;

    #[test]
    fn differences_are_independent_and_have_the_variance_of_one_click() {
        let clicks = [[1.0, 0.0], [3.0, 2.0], [5.0, -4.0]]
            .map(ImagePoint::from)
            .to_vec();
        let landmark = LandmarkId::from("centre_mark");
        let differences: Vec<Vec2> = RepeatedClicks {
            landmark: &landmark,
            labelled: None,
            clicks,
        }
        .differences()
        .collect();
        let expected = [
            Vec2::new(-2.0, -2.0) * 0.5_f64.sqrt(),
            Vec2::new(-3.0, 5.0) * (2.0_f64 / 3.0).sqrt(),
        ];
        assert_eq!(differences.len(), 2);
        assert!(
            differences
                .iter()
                .zip(expected)
                .all(|(found, expected)| (found - expected).norm() < 1e-12)
        );
        // The squares add up to those around the mean: nothing of the clicks is lost or counted
        // twice.
        let around_mean = |values: [f64; 3]| {
            let mean = values.iter().sum::<f64>() / 3.0;
            values
                .iter()
                .map(|value| (value - mean).powi(2))
                .sum::<f64>()
        };
        let squares: f64 = differences.iter().map(Vec2::norm_squared).sum();
        assert!(
            (squares - around_mean([1.0, 3.0, 5.0]) - around_mean([0.0, 2.0, -4.0])).abs() < 1e-12
        );
    }

    #[test]
    fn the_label_comes_first_and_other_landmarks_stay_apart() {
        let mut frame = reference(0.0, &["centre_mark"]);
        for (id, x, round) in [
            ("centre_mark", 10.0, 1),
            ("halfway_far", 50.0, 1),
            ("centre_mark", 11.0, 2),
        ] {
            frame
                .repeats
                .push(Repeat::new(id.into(), ImagePoint::new(x, 9.0), round));
        }
        let found = frame.repeated_clicks();
        let seen: Vec<(&str, usize)> = found
            .iter()
            .map(|repeated| (repeated.landmark.as_str(), repeated.clicks.len()))
            .collect();
        assert_eq!(seen, [("centre_mark", 3), ("halfway_far", 1)]);
        assert_eq!(found[0].clicks[0], ImagePoint::new(9.0, 9.0));
        assert_eq!(found[1].differences().count(), 0);
    }
}
