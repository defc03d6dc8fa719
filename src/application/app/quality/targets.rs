//! Errors of clicks, grouped by the landmark or line that they name.

use super::errors::{ClickError, ClickErrors, middle_and_most};
use std::collections::BTreeMap;
use touchline_documents::document::Target;

/// Minimum number of clicks for a statement about a landmark.
const MIN_CLICKS: usize = 3;
/// A landmark is bad if the median of its errors exceeds the expected one by this factor.
const BAD: f64 = 2.0;

/// The errors of the clicks on one landmark or line.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetErrors {
    /// The landmark or line.
    pub target: Target,
    /// Number of clicks, including check clicks.
    pub clicks: usize,
    /// Median error, px at 1920 px width.
    pub median_px: f64,
    /// 90 % quantile of the errors, px at 1920 px width.
    pub most_px: f64,
    /// Expected median error of clicks with the right name, px at 1920 px width.
    pub expected_px: f64,
    /// The clicks, largest error first: index of the frame, index of the click, error in px at 1920
    /// px width.
    pub worst: Vec<(usize, usize, f64)>,
}

impl TargetErrors {
    /// Ratio of the median error to the expected one.
    pub fn excess(&self) -> f64 {
        self.median_px / self.expected_px
    }

    /// Whether there are enough clicks and their errors are too large.
    pub fn is_bad(&self) -> bool {
        self.is_known() && self.excess() > BAD
    }

    /// Whether there are enough clicks for a statement.
    pub const fn is_known(&self) -> bool {
        self.clicks >= MIN_CLICKS
    }
}

/// All landmarks and lines that were clicked: those with enough clicks first, then by excess,
/// largest first.
pub fn by_target(errors: &ClickErrors) -> Vec<TargetErrors> {
    let mut clicked: BTreeMap<&Target, Vec<&ClickError>> = BTreeMap::new();
    for click in &errors.clicks {
        clicked.entry(&click.target).or_default().push(click);
    }
    let mut found: Vec<TargetErrors> = clicked
        .into_iter()
        .filter_map(|(target, clicks)| target_errors(target, &clicks))
        .collect();
    // One or two clicks may be off by chance, so that they come last however large their excess.
    found.sort_by(|a, b| {
        b.is_known()
            .cmp(&a.is_known())
            .then(b.excess().total_cmp(&a.excess()))
    });
    found
}

/// Statistics of the clicks on one target. None without clicks.
fn target_errors(target: &Target, clicks: &[&ClickError]) -> Option<TargetErrors> {
    let [median_px, most_px] = middle_and_most(clicks.iter().map(|click| click.error_px))?;
    let [expected_px, _] = middle_and_most(clicks.iter().map(|click| click.expected_px))?;
    let mut worst: Vec<(usize, usize, f64)> = clicks
        .iter()
        .map(|click| (click.frame, click.click, click.error_px))
        .collect();
    worst.sort_by(|a, b| b.2.total_cmp(&a.2));
    Some(TargetErrors {
        target: target.clone(),
        clicks: clicks.len(),
        median_px,
        most_px,
        expected_px,
        worst,
    })
}

#[cfg(test)]
mod tests {
    use super::super::errors::tests::{document, errors};
    use super::*;

    #[test]
    fn the_landmark_that_is_hit_worst_comes_first_and_a_few_clicks_come_last() {
        let frame = |far_px| {
            [
                ("centre_mark", 0.2, false),
                ("halfway_far", far_px, false),
                ("centre_circle_left", 0.1, false),
            ]
            .to_vec()
        };
        let mut frames = [frame(20.0), frame(30.0), frame(25.0)];
        frames[2].push(("centre_circle_right", 90.0, true));
        let frames: Vec<&[(&str, f64, bool)]> = frames.iter().map(Vec::as_slice).collect();
        let found = by_target(&errors(&document(&frames)));
        let names: Vec<&str> = found.iter().map(|errors| errors.target.as_str()).collect();
        assert_eq!((names[0], names[3]), ("halfway_far", "centre_circle_right"));
        assert!(found[0].is_bad() && !found[1].is_bad());
        assert!(!found[3].is_bad(), "one click says little, however far off");
        assert_eq!(
            found[0]
                .worst
                .iter()
                .map(|worst| worst.0)
                .collect::<Vec<_>>(),
            [1, 2, 0]
        );
        assert!((found[0].median_px - 50.0).abs() < 1e-6 && found[0].clicks == 3);
    }
}
