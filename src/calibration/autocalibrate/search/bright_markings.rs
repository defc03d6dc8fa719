//! Which markings in pictures are too bright to be a line of the width that a camera predicts.
//!
//! # Problem
//!
//! At the far end of a field lines are a tenth to a third of a pixel wide and often not seen at
//! all, while the foot of the advertising boards a few metres behind them is seen clearly. The fits
//! of panorama and base, which pair paint with the nearest line, took it for the line: the field
//! grew to its largest size, and camera and lens followed. Frame by frame everything then lies on
//! paint, so that such a camera is certain and wrong.
//!
//! # Idea
//!
//! A picture blurs a line until it is as wide as any other far edge, but it does not change the
//! light: the contrast, summed across the line, stays the contrast of the paint times the width of
//! the line, however soft the picture is ([`MarkingPixel::contrast_px`]). The contrast of the paint
//! is known from the lines that are wide enough to be resolved. So each marking has an *implied
//! width*, and one whose implied width is several times the predicted one is something else.
//!
//! Drawn clip 27 of the bowl (behind a goal, filmed off a screen), summed contrast over predicted
//! width in grey levels: 80 to 130 on the lines of the penalty area, 180 on the far touchline, 970
//! on the boards behind that, and 3000 on those behind the far goal line.
//!
//! The test is one-sided. Worn or shaded paint has less contrast than the rest and passes.
//!
//! Single markings are no reason. Beside a line that is where it is predicted up to 7 % are too
//! bright; where boards are taken for a line it is 35 to 95 % (drawn clips 19 and 25). With bright
//! markings left out one by one, the width of clip 19, seen from a low mast, was 0.5 m off.
//!
//! [`MarkingPixel::contrast_px`]: touchline_vision::paint::MarkingPixel::contrast_px

/// A marking is too bright for a line if its implied width is more than this many times the
/// predicted one, and [`MAX_BEYOND_PX`] more. Where lines lie close together, the sum across one
/// contains part of its neighbour.
const MAX_TIMES: f64 = 2.5;

/// Noise and the texture of the turf give a line that is not seen an implied width up to this, px.
const MAX_BEYOND_PX: f64 = 0.5;

/// Lines of this width are resolved, and their summed contrast is not cut off at their sides, px.
const RESOLVED_PX: std::ops::Range<f64> = 0.8..4.0;

/// Markings on resolved lines that measure the contrast of the paint.
const MIN_MEASURED: usize = 50;

/// Bright markings are left out where they are more than this share of those beside their line.
const MIN_BRIGHT_SHARE: f64 = 0.25;

/// A marking beside a predicted line.
#[derive(Clone, Copy, Debug)]
pub struct MarkingAtLine {
    /// Index of the line in the field.
    pub line: usize,
    /// The contrast of the marking, summed across it, grey levels × px; none on floors.
    pub contrast_px: Option<f64>,
    /// The predicted width of the line, px.
    pub width_px: f64,
}

/// The markings beside the lines of a field that are too bright to be these lines.
#[derive(Clone, Debug)]
pub struct BrightMarkings {
    contrast: PaintContrast,
    /// For each line, whether it has many of them.
    is_outshone: Vec<bool>,
}

impl BrightMarkings {
    /// Finds out beside which of a field's lines they are, from the markings of all frames.
    pub fn measure<M>(num_lines: usize, markings: M) -> Self
    where
        M: Iterator<Item = MarkingAtLine> + Clone,
    {
        let contrast = PaintContrast::measure(markings.clone());
        let mut num_bright = vec![0_usize; num_lines];
        let mut num_markings = vec![0_usize; num_lines];
        for marking in markings {
            num_markings[marking.line] += 1;
            num_bright[marking.line] += usize::from(contrast.is_too_bright(marking));
        }
        let counts = num_bright.into_iter().zip(num_markings);
        let is_outshone = |(bright, all)| bright as f64 > MIN_BRIGHT_SHARE * all as f64;
        Self {
            contrast,
            is_outshone: counts.map(is_outshone).collect(),
        }
    }

    /// Whether a marking is one of them.
    pub fn contain(&self, marking: MarkingAtLine) -> bool {
        self.is_outshone[marking.line] && self.contrast.is_too_bright(marking)
    }
}

/// The contrast of a field's paint against the turf, grey levels; not known where too few resolved
/// lines are seen, and on floors, whose lines have colours of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PaintContrast(Option<f64>);

impl PaintContrast {
    /// Measures it where lines are resolved: the upper quartile, because shade and wear lower it
    /// and nothing on a line raises it.
    fn measure(markings: impl Iterator<Item = MarkingAtLine>) -> Self {
        let mut levels: Vec<f64> = markings
            .filter(|marking| RESOLVED_PX.contains(&marking.width_px))
            .filter_map(|marking| Some(marking.contrast_px? / marking.width_px))
            .collect();
        if levels.len() < MIN_MEASURED {
            return Self(None);
        }
        let quartile = levels.len() * 3 / 4;
        let (_, level, _) = levels.select_nth_unstable_by(quartile, f64::total_cmp);
        Self(Some(*level).filter(|level| *level > 0.0))
    }

    /// Whether a marking is too bright to be the line beside it. False where nothing is known.
    fn is_too_bright(self, marking: MarkingAtLine) -> bool {
        let implied_px = self
            .0
            .zip(marking.contrast_px)
            .map(|(level, sum)| sum / level);
        implied_px
            .is_some_and(|implied_px| implied_px > MAX_TIMES * marking.width_px + MAX_BEYOND_PX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marking(contrast_px: f64, width_px: f64) -> MarkingAtLine {
        MarkingAtLine {
            line: 0,
            contrast_px: Some(contrast_px),
            width_px,
        }
    }

    /// Paint of 100 grey levels in the sun and of 40 in the shade.
    fn half_in_shade() -> impl Iterator<Item = MarkingAtLine> + Clone {
        (0..100).map(|index| {
            let level = if index % 2 == 0 { 100.0 } else { 40.0 };
            marking(1.5 * level, 1.5)
        })
    }

    #[test]
    fn boards_are_too_bright_for_a_far_line_and_its_own_paint_is_not() {
        let contrast = PaintContrast::measure(half_in_shade());
        assert!(contrast.is_too_bright(marking(280.0, 0.3)));
        assert!(!contrast.is_too_bright(marking(30.0, 0.3)));
        assert!(!contrast.is_too_bright(marking(12.0, 0.3)), "in the shade");
        assert!(
            !contrast.is_too_bright(marking(60.0, 0.3)),
            "two lines beside each other"
        );
        assert!(
            !contrast.is_too_bright(marking(280.0, 2.0)),
            "no farther than a near line"
        );
    }

    #[test]
    fn few_bright_markings_beside_a_line_are_its_own() {
        let contain = |num_bright: usize| {
            let far = |contrast_px: f64| MarkingAtLine {
                line: 1,
                ..marking(contrast_px, 0.3)
            };
            let of_far = (0..100).map(|index| far(if index < num_bright { 280.0 } else { 30.0 }));
            let bright = BrightMarkings::measure(3, half_in_shade().chain(of_far));
            assert!(!bright.contain(far(30.0)), "as bright as the line");
            let beside_another = MarkingAtLine {
                line: 2,
                ..far(280.0)
            };
            assert!(!bright.contain(beside_another));
            bright.contain(far(280.0))
        };
        assert!(!contain(7));
        assert!(contain(35));
    }

    #[test]
    fn where_too_little_is_seen_nothing_is_too_bright() {
        let few = PaintContrast::measure((0..MIN_MEASURED - 1).map(|_| marking(100.0, 1.0)));
        let thin = PaintContrast::measure((0..100).map(|_| marking(10.0, 0.3)));
        let unmeasured = MarkingAtLine {
            contrast_px: None,
            ..marking(0.0, 0.3)
        };
        for unknown in [
            few,
            thin,
            PaintContrast::measure((0..100).map(|_| unmeasured)),
        ] {
            assert_eq!(unknown, PaintContrast(None));
            assert!(!unknown.is_too_bright(marking(1e6, 0.1)));
        }
        assert!(!PaintContrast::measure(half_in_shade()).is_too_bright(unmeasured));
    }
}
