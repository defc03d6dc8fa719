//! The rectangle between the axes: where points are in it, and what of a line is inside it.

use crate::report::figure::ticks::Ruler;

/// The rectangle between the axes, px, and the axes.
pub(super) struct Plot {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x: Ruler,
    pub(super) y: Ruler,
}

impl Plot {
    /// The position of a point, px; none if an axis cannot show it, such as 0 on a logarithmic one.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let (right, up) = (self.x.share(x)?, self.y.share(y)?);
        Some([
            self.left + right * (self.right - self.left),
            self.bottom - up * (self.bottom - self.top),
        ])
    }

    /// The height of an end of an error bar, px, which may lie beyond the frame: infinitely far for
    /// an infinite end, and below it for a number that a logarithmic axis cannot show. None for
    /// NaN.
    pub(super) fn bar_end(&self, value: f64) -> Option<f64> {
        if value.is_nan() {
            return None;
        }
        let Some(share) = self.y.share(value) else {
            return Some(if value > 0.0 {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            });
        };
        Some(self.bottom - share * (self.bottom - self.top))
    }

    /// Whether a position is inside the plot, within half a px.
    pub(super) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let slack = 0.5;
        x >= self.left - slack
            && x <= self.right + slack
            && y >= self.top - slack
            && y <= self.bottom + slack
    }
}

/// The parts of a polyline inside the plot.
pub(super) fn within_frame(plot: &Plot, line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in line.windows(2) {
        let Some([from, to]) = cut(plot, pair[0], pair[1]) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    parts
}

/// Clips a segment to the plot (Liang, Barsky 1984).
fn cut(plot: &Plot, from: [f64; 2], to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    // The points are `from + share * along`. Each side of the rectangle limits the shares that lie
    // inside: where the segment enters across a side (`slope < 0`) from below, where it leaves from
    // above. A segment along a side (`slope == 0`) lies inside or outside as a whole.
    let along = [to[0] - from[0], to[1] - from[1]];
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for (axis, low, high) in [(0, plot.left, plot.right), (1, plot.top, plot.bottom)] {
        for (slope, room) in [
            (-along[axis], from[axis] - low),
            (along[axis], high - from[axis]),
        ] {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                start = start.max(room / slope);
            } else {
                end = end.min(room / slope);
            }
        }
    }
    let at = |share: f64| [from[0] + along[0] * share, from[1] + along[1] * share];
    // Ends that are not clipped stay exact, because `within_frame` joins pieces with equal ends.
    (start <= end).then(|| {
        [
            if start == 0.0 { from } else { at(start) },
            if end == 1.0 { to } else { at(end) },
        ]
    })
}
