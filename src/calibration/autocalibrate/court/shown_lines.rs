//! The lines of a field that a camera would see, compared with the straight lines of its picture.

use super::grid::{Grid, GridLine};
use touchline_core::camera::StatedLens;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_core::solve::{Observation, PlanePose};
use touchline_vision::paint::{EvenAreas, StraightLine, Tone};

/// Both ends of a line of the field lie within this of the line of the picture that shows it, px at
/// 1920 px width: a camera from one rectangle is some px off elsewhere, and a lens bends lines.
const NEAR_PX: f64 = 14.0;

/// Shorter lines say nothing, px at 1920 px width.
const MIN_LENGTH_PX: f64 = 30.0;

/// A line is shown where at least this share of it is covered: players and nets hide the rest.
const MIN_COVERED: f64 = 0.3;

/// Minimum number of lines that are shown, and share of the length of all.
const MIN_LINES: usize = 5;
const MIN_SHOWN: f64 = 0.4;

/// Length that is bare counts this much against length that is shown: what hides a line is common.
/// Foreign length, of lines of the picture where the field has none, counts whole.
const BARE_WEIGHT: f64 = 0.5;

/// Places along a piece of a line of the picture that tell whether it lies on the field.
const PLACES_ON_FIELD: [f64; 3] = [0.1, 0.5, 0.9];

/// Observations of each shown piece, and their 1-σ, px at 1920 px width.
const PLACES_OF_PIECE: u32 = 6;
const SIGMA_PX: f64 = 1.5;

/// Points nearer than this share of the depth of a line's farther end are behind the camera.
const NEAR_DEPTH: f64 = 0.05;

/// The straight lines of a picture, and those of the field.
pub struct ShownLines<'a> {
    pub field: &'a FieldModel,
    pub grid: &'a Grid,
    pub lines: &'a [StraightLine],
    pub even: &'a EvenAreas,
    pub size: ImageSize,
    pub lens: StatedLens,
}

/// Which lines of the field a camera has where the picture shows lines.
pub struct Agreement {
    matches: Vec<Match>,
    shown_px: f64,
    bare_px: f64,
    foreign_px: f64,
}

/// A line of the field, by its index, and the part of a line of the picture that shows it.
struct Match {
    of_field: usize,
    of_picture: usize,
    /// Along the line of the picture, px.
    range_px: [f64; 2],
}

impl Agreement {
    /// How much speaks for the camera, px of lines.
    pub fn score(&self) -> f64 {
        self.shown_px - BARE_WEIGHT * self.bare_px - self.foreign_px
    }

    /// The number of lines of the field that the picture shows.
    pub fn num_lines(&self) -> usize {
        self.matches.len()
    }

    /// The share of the length of the camera's lines that the picture shows.
    pub fn shown_share(&self) -> f64 {
        self.shown_px / (self.shown_px + self.bare_px)
    }

    /// The length of lines of the picture where the field has none, as a share of what is shown.
    pub fn foreign_share(&self) -> f64 {
        self.foreign_px / self.shown_px
    }
}

impl ShownLines<'_> {
    pub fn principal_point(&self) -> ImagePoint {
        self.lens.principal_point_in(self.size)
    }

    /// Compares a camera's lines with those of the picture. None where too few agree.
    pub fn compare(&self, camera: &PlanePose) -> Option<Agreement> {
        let scale = self.size.scale_from_1920();
        let mut found = Agreement {
            matches: Vec::new(),
            shown_px: 0.0,
            bare_px: 0.0,
            foreign_px: 0.0,
        };
        for line in self.grid.lines() {
            let Some([from, to]) = self.visible_part(camera, line) else {
                continue;
            };
            let length_px = from.distance_px(to);
            // What is shorter says nothing: any spot is a line of that length.
            if length_px < MIN_LENGTH_PX * scale {
                continue;
            }
            let shown = self.nearest_along([from, to], scale);
            let Some((of_picture, range_px, covered_px)) = shown else {
                // A line that is not there speaks against the camera where the ground along it is
                // even, so that
                // paint would be seen: players, graphics and stands hide it.
                found.bare_px += length_px * self.even.share_between(from, to);
                continue;
            };
            found.shown_px += covered_px;
            found.bare_px += (length_px - covered_px).max(0.0) * self.even.share_between(from, to);
            found.matches.push(Match {
                of_field: line.line,
                of_picture,
                range_px,
            });
        }
        // Fewer lines fit nearly anywhere.
        let is_enough = found.matches.len() >= MIN_LINES
            && found.shown_px >= MIN_SHOWN * (found.shown_px + found.bare_px);
        is_enough.then(|| Agreement {
            foreign_px: self.foreign_px(camera, &found.matches),
            ..found
        })
    }

    /// The length of the lines of the picture that lie on the field where it has no line. What
    /// stands on it, such as a net, is no line of the ground.
    fn foreign_px(&self, camera: &PlanePose, matches: &[Match]) -> f64 {
        let scale = self.size.scale_from_1920();
        let standing: Vec<[ImagePoint; 2]> = self
            .grid
            .standing()
            .filter_map(|line| self.visible_part(camera, line))
            .collect();
        // A line of the picture is known as a line of the field or as part of what stands there.
        let is_known = |index: usize, line: &StraightLine| {
            let is_on = |end: &ImagePoint| line.across_px(*end).abs() <= 2.0 * NEAR_PX * scale;
            matches.iter().any(|of| of.of_picture == index)
                || standing.iter().any(|ends| ends.iter().all(is_on))
        };
        let unknown = self
            .lines
            .iter()
            .enumerate()
            .filter(|(index, line)| line.tone == Tone::Bright && !is_known(*index, line));
        let pieces =
            unknown.flat_map(|(_, line)| line.pieces.iter().map(move |piece| (line, piece)));
        pieces
            .filter(|(line, [from, to])| {
                PLACES_ON_FIELD.iter().all(|share| {
                    let at = line.point_at(from + (to - from) * share);
                    let on_ground = self.on_ground(camera, at);
                    on_ground.is_some_and(|at| self.is_on_field(at) && !self.grid.is_on_curve(at))
                })
            })
            .map(|(_, [from, to])| to - from)
            .sum()
    }

    /// The point of the ground that a camera shows at a point of the picture, `world`, m.
    fn on_ground(&self, camera: &PlanePose, at: ImagePoint) -> Option<Vec3> {
        // The ray of the place in the camera's frame, and where it meets the plane of the ground.
        let offset = at.offset_from(self.principal_point()) / camera.focal_px;
        let offset = self.lens.pixels().square_from_pixels(offset);
        let ray = camera.cam_from_world.transpose() * Vec3::new(offset.x, offset.y, 1.0);
        let down = camera.position_m.z / -ray.z;
        (ray.z < 0.0).then(|| camera.position_m + ray * down)
    }

    fn is_on_field(&self, at: Vec3) -> bool {
        at.x.abs() <= 0.5 * self.field.length_m && at.y.abs() <= 0.5 * self.field.width_m
    }

    /// Places on the lines of the picture, as observations of the lines of the field.
    pub fn observations(&self, agreement: &Agreement) -> Vec<Observation> {
        let sigma_px = SIGMA_PX * self.size.scale_from_1920();
        let places = agreement.matches.iter().flat_map(|of| {
            let line = &self.lines[of.of_picture];
            let [from, to] = of.range_px;
            let pieces = line
                .pieces
                .iter()
                .map(move |[a, b]| (a.max(from), b.min(to)));
            let places = pieces.filter(|(a, b)| a < b).flat_map(move |(a, b)| {
                let share = |place: u32| f64::from(place) / f64::from(PLACES_OF_PIECE - 1);
                (0..PLACES_OF_PIECE).map(move |place| line.point_at(a + (b - a) * share(place)))
            });
            places.map(|at| (of.of_field, at))
        });
        places
            .enumerate()
            .filter_map(|(place, (line, at))| {
                Observation::from_paint(self.field, line, at, sigma_px, place)
            })
            .collect()
    }

    /// The nearest line of the picture that covers enough of what lies between two points: its
    /// index, the range along it, and how much of that it covers, px.
    fn nearest_along(&self, ends: [ImagePoint; 2], scale: f64) -> Option<(usize, [f64; 2], f64)> {
        let length_px = ends[0].distance_px(ends[1]);
        let off_px = |line: &StraightLine| {
            let [one, other] = ends.map(|end| line.across_px(end).abs());
            one.max(other)
        };
        // Lines of the picture near both ends; of those that cover enough, the nearest.
        let near = self.lines.iter().enumerate().filter_map(|(index, line)| {
            if off_px(line) > NEAR_PX * scale {
                return None;
            }
            let [one, other] = ends.map(|end| line.along_px(end));
            let range_px = [one.min(other), one.max(other)];
            let covered_px = line.covered_within_px(range_px);
            (covered_px >= MIN_COVERED * length_px).then_some((index, range_px, covered_px))
        });
        near.min_by(|one, other| {
            off_px(&self.lines[one.0]).total_cmp(&off_px(&self.lines[other.0]))
        })
    }

    /// The part of a line of the field that lies in the picture: its ends, px.
    fn visible_part(&self, camera: &PlanePose, line: &GridLine) -> Option<[ImagePoint; 2]> {
        let [mut from, mut to] = line
            .ends_m
            .map(|at| camera.cam_from_world * (at - camera.position_m));
        let near = NEAR_DEPTH * from.z.max(to.z);
        // Negated, so that NaN has no image either.
        if !(near > 0.0) {
            return None;
        }
        if from.z < near {
            from += (to - from) * ((near - from.z) / (to.z - from.z));
        } else if to.z < near {
            to += (from - to) * ((near - to.z) / (from.z - to.z));
        }
        let image = |at: Vec3| {
            let offset = at.xy() * (camera.focal_px / at.z);
            let offset = self.lens.pixels().pixels_from_square(offset);
            self.principal_point().translate(offset)
        };
        clip([image(from), image(to)], self.size)
    }
}

/// The part of a segment inside a picture (Liang and Barsky 1984).
fn clip([from, to]: [ImagePoint; 2], size: ImageSize) -> Option<[ImagePoint; 2]> {
    let along = to.offset_from(from);
    let [width, height] = [size.width, size.height].map(f64::from);
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for (inward, inside) in [
        (along.x, from.x),
        (-along.x, width - from.x),
        (along.y, from.y),
        (-along.y, height - from.y),
    ] {
        if inward > 0.0 {
            start = start.max(-inside / inward);
        } else if inward < 0.0 {
            end = end.min(-inside / inward);
        } else if inside < 0.0 {
            return None;
        }
    }
    (start < end).then(|| [start, end].map(|share| from.translate(along * share)))
}
