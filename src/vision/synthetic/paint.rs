//! The painted lines: how much of a pixel's patch of ground is white.

use super::coverage::strip;
use super::ray::PlaneHit;
use touchline_core::field::{Curve, FieldLine, FieldModel, Landmark, PaintEdge};
use touchline_core::geometry::Vec3;

/// Side of the cells in which the lines near a place are looked up, m.
const CELL_M: f64 = 2.0;
/// How far beyond the lines the lookup reaches, m.
const MARGIN_M: f64 = 3.0;

/// The painted lines of a field, ready to be looked up at any place.
#[derive(Clone, Debug)]
pub(super) struct Paint {
    markings: Vec<PaintedShape>,
    columns: usize,
    rows: usize,
    corner: [f64; 2],
    /// Per cell the markings that come near it.
    cells: Vec<Vec<u16>>,
}

/// A painted marking, seen from above: a line, a dash of one, or a spot.
#[derive(Clone, Copy, Debug)]
enum PaintedShape {
    Straight {
        from: Vec3,
        along: Vec3,
        length_m: f64,
        half_width_m: f64,
        over_m: f64,
    },
    Round {
        centre: Vec3,
        radius_m: f64,
        middle: f64,
        half_sweep: f64,
        half_width_m: f64,
    },
    Spot {
        centre: Vec3,
        radius_m: f64,
    },
}

impl Paint {
    /// The lines and spots whose name is wanted.
    pub fn new(field: &FieldModel, is_wanted: impl Fn(&str) -> bool) -> Self {
        // Spots of paint, such as penalty marks, are landmarks with a diameter.
        let spots = field
            .landmarks
            .iter()
            .filter(|landmark| is_wanted(landmark.id.as_str()))
            .filter_map(PaintedShape::of_spot);
        // Rows of hash marks are dashes, which no search looks for as a line: they are painted,
        // too.
        let markings: Vec<PaintedShape> = field
            .lines
            .iter()
            .filter(|line| is_wanted(line.id.as_str()))
            .filter(|line| line.painted || line.dash_m.is_some())
            .flat_map(PaintedShape::of_line)
            .chain(spots)
            .collect();
        // A grid of cells with the markings near each, since most pixels of grass have none and the
        // others one or two of all.
        let corner = [
            -0.5 * field.length_m - MARGIN_M,
            -0.5 * field.width_m - MARGIN_M,
        ];
        let columns = ((field.length_m + 2.0 * MARGIN_M) / CELL_M).ceil() as usize;
        let rows = ((field.width_m + 2.0 * MARGIN_M) / CELL_M).ceil() as usize;
        let near = |cell: usize| {
            let centre = Vec3::new(
                corner[0] + ((cell % columns) as f64 + 0.5) * CELL_M,
                corner[1] + ((cell / columns) as f64 + 0.5) * CELL_M,
                0.0,
            );
            // A pixel at the cell's rim may reach half a metre out of it.
            let reach = CELL_M * std::f64::consts::FRAC_1_SQRT_2 + 0.5;
            let is_near = |marking: &PaintedShape| marking.distance_m(centre) < reach;
            (0..markings.len())
                .filter(|index| is_near(&markings[*index]))
                .map(|index| index as u16)
                .collect()
        };
        let cells = (0..columns * rows).map(near).collect();
        Self {
            markings,
            columns,
            rows,
            corner,
            cells,
        }
    }

    /// The share of a pixel that is painted, 0 to 1: exact for a box filter across the line, to
    /// first order.
    pub fn share(&self, hit: &PlaneHit) -> f64 {
        let column = (hit.point.x - self.corner[0]) / CELL_M;
        let row = (hit.point.y - self.corner[1]) / CELL_M;
        if !(column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64)
        {
            return 0.0;
        }
        // Where markings cross, the greatest share counts: paint over paint is no whiter.
        let cell = row as usize * self.columns + column as usize;
        self.cells[cell]
            .iter()
            .map(|index| self.markings[*index as usize].share(hit))
            .fold(0.0, f64::max)
    }
}

impl PaintedShape {
    fn of_spot(landmark: &Landmark) -> Option<Self> {
        Some(Self::Spot {
            centre: landmark.nominal_m,
            radius_m: 0.5 * landmark.spot_diameter_m?,
        })
    }

    /// The shapes of a line: the whole, or its dashes.
    fn of_line(line: &FieldLine) -> impl Iterator<Item = Self> {
        let pieces = line.pieces(&line.paint_centre);
        pieces.map(|piece| Self::from_piece(line, piece))
    }

    fn from_piece(line: &FieldLine, piece: Curve) -> Self {
        let half_width_m = 0.5 * line.width_m;
        match piece {
            Curve::Segment { from, to } => {
                let length_m = (to - from).norm();
                // Paint centred on its line is drawn half a width over the end, so that corners are
                // full, and paint around an area a whole width; where the nominal line is the
                // paint's outer edge, the end is the corner already.
                let over_m = match line.edge {
                    _ if line.dash_m.is_some() => 0.0,
                    PaintEdge::Centre => half_width_m,
                    PaintEdge::Inner => line.width_m,
                    PaintEdge::Outer => 0.0,
                };
                Self::Straight {
                    from,
                    along: (to - from) / length_m,
                    length_m,
                    half_width_m,
                    over_m,
                }
            }
            Curve::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => Self::Round {
                centre,
                radius_m,
                middle: (start + sweep * 0.5).radians(),
                half_sweep: 0.5 * sweep.radians().abs(),
                half_width_m,
            },
        }
    }

    /// From a place to the marking's rim, m; negative on the paint.
    fn distance_m(&self, place: Vec3) -> f64 {
        match *self {
            Self::Straight {
                from,
                along,
                length_m,
                half_width_m,
                ..
            } => {
                let offset = place - from;
                let nearest = along * offset.dot(&along).clamp(0.0, length_m);
                (offset - nearest).xy().norm() - half_width_m
            }
            // For an arc the whole circle is searched: a cell may hold a marking too many,
            // never one too few.
            Self::Round {
                centre,
                radius_m,
                half_width_m,
                ..
            } => ((place - centre).xy().norm() - radius_m).abs() - half_width_m,
            Self::Spot { centre, radius_m } => (place - centre).xy().norm() - radius_m,
        }
    }

    fn share(&self, hit: &PlaneHit) -> f64 {
        match *self {
            Self::Straight {
                from,
                along,
                length_m,
                half_width_m,
                over_m,
            } => {
                let offset = hit.point - from;
                let across = Vec3::new(-along.y, along.x, 0.0);
                let share = strip(offset.dot(&across), half_width_m, hit.reach(across));
                if share == 0.0 {
                    return 0.0;
                }
                let half_length = 0.5 * length_m;
                share
                    * strip(
                        offset.dot(&along) - half_length,
                        half_length + over_m,
                        hit.reach(along),
                    )
            }
            Self::Round {
                centre,
                radius_m,
                middle,
                half_sweep,
                half_width_m,
            } => {
                let offset = Vec3::new(hit.point.x - centre.x, hit.point.y - centre.y, 0.0);
                let radius = offset.norm();
                if radius < 1e-9 {
                    return 0.0;
                }
                let out = offset / radius;
                let share = strip(radius - radius_m, half_width_m, hit.reach(out));
                if share == 0.0 || half_sweep >= std::f64::consts::PI - 1e-9 {
                    return share;
                }
                // The angle from the arc's middle, wrapped to ±180°, so that the seam is opposite
                // to the arc. The ends are cut along the circle.
                let turn = std::f64::consts::TAU;
                let from_middle =
                    (offset.y.atan2(offset.x) - middle + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
                let along = Vec3::new(-out.y, out.x, 0.0);
                share * strip(from_middle * radius, half_sweep * radius, hit.reach(along))
            }
            // A disc smaller than a pixel is long seen from the side: both extents count.
            Self::Spot { centre, radius_m } => {
                let offset = hit.point - centre;
                let (x, y) = (hit.reach(Vec3::x()), hit.reach(Vec3::y()));
                if offset.x.abs() > radius_m + x || offset.y.abs() > radius_m + y {
                    return 0.0;
                }
                let half_chord =
                    (radius_m.powi(2) - offset.y.clamp(-radius_m, radius_m).powi(2)).sqrt();
                strip(offset.y, radius_m, y) * strip(offset.x, half_chord.max(0.3 * radius_m), x)
            }
        }
    }
}
