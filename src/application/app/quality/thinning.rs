//! Reduces a course with more points than pixels to what can be drawn.

use super::{CoursePoint, PointKind, Quantity};

/// The points of a span, as they are drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum SpanMarks<'a> {
    /// Every point is drawn.
    Points(&'a [CoursePoint]),
    /// Points are combined to vertical bars, ordered by kind and column.
    Columns(Vec<Column>),
}

/// The points of one kind that fall into one column of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// The index of the column.
    pub column: usize,
    pub kind: PointKind,
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
}

/// Reduces the points of `span` to `columns` columns. If they are few, each is drawn; otherwise the
/// range from the smallest to the largest value of each kind in each column, so that no outlier
/// disappears.
pub fn thin_points(
    points: &[CoursePoint],
    quantity: Quantity,
    span: [f64; 2],
    columns: usize,
) -> SpanMarks<'_> {
    // The negation also covers a span with NaN.
    if points.len() <= columns || !(span[1] > span[0]) {
        return SpanMarks::Points(points);
    }
    let per_unit = columns as f64 / (span[1] - span[0]);
    let mut found: Vec<Column> = Vec::new();
    // The bar that is being extended, for each kind. Points ascend in time, so a bar is complete
    // when the column changes.
    let mut open: [Option<Column>; PointKind::ALL.len()] = [None; PointKind::ALL.len()];
    for point in points {
        // The end of the span belongs to the last column.
        let column = (((point.at - span[0]) * per_unit) as usize).min(columns - 1);
        let value = point.value(quantity);
        let open = &mut open[point.kind as usize];
        match open {
            Some(known) if known.column == column => {
                known.low = known.low.min(value);
                known.high = known.high.max(value);
            }
            _ => found.extend(open.replace(Column {
                column,
                kind: point.kind,
                low: value,
                high: value,
            })),
        }
    }
    found.extend(open.into_iter().flatten());
    found.sort_by_key(|column| (column.kind, column.column));
    SpanMarks::Columns(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: usize) -> Vec<CoursePoint> {
        let point = |frame: usize| CoursePoint {
            frame,
            at: frame as f64,
            values: [(frame % 7) as f64, 0.0, 1000.0],
            sigma: None,
            imported: None,
            kind: if frame.is_multiple_of(10) {
                PointKind::Reference
            } else {
                PointKind::Suggested
            },
            shot: 0,
            apart_px: None,
            stands_out: false,
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn few_points_are_drawn_as_they_are() {
        let points = points(50);
        assert_eq!(
            thin_points(&points, Quantity::Pan, [0.0, 49.0], 50),
            SpanMarks::Points(&points)
        );
        assert_eq!(
            thin_points(&points, Quantity::Pan, [3.0, 3.0], 5),
            SpanMarks::Points(&points),
            "no time at all"
        );
    }

    #[test]
    fn many_points_become_columns_and_a_single_spike_stays() {
        let mut points = points(10_000);
        points[4321].values[0] = 170.0;
        let SpanMarks::Columns(columns) = thin_points(&points, Quantity::Pan, [0.0, 9_999.0], 500)
        else {
            panic!("10,000 points on 500 columns")
        };
        assert!(columns.len() <= 1000, "{}", columns.len());
        let spike: Vec<&Column> = columns
            .iter()
            .filter(|column| column.high == 170.0)
            .collect();
        assert_eq!(
            (spike.len(), spike[0].kind, spike[0].column),
            (1, PointKind::Suggested, 216)
        );
        let references = columns
            .iter()
            .filter(|column| column.kind == PointKind::Reference)
            .count();
        assert_eq!(references, 500, "each column has two");
        assert!(
            columns.is_sorted_by_key(|column| (column.kind, column.column)),
            "references are drawn last"
        );
        assert!(
            columns
                .iter()
                .all(|column| column.low >= 0.0 && column.high >= column.low)
        );
    }
}
