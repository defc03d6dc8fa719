//! Long straight lines of a picture, found without any camera and on ground of any colour: bright
//! ones, dark ones, and borders of two areas.
//!
//! # Method
//!
//! 1. Crests of each tone as marking pixels have them, everywhere in the picture: what is ground
//!    is not known yet, and a court may have several colours. Those beside a line of a tone before
//!    are left out.
//! 2. A Hough transform: each ridge votes for the lines through it whose direction is about its
//!    own. The lines are taken one by one, the one with the most votes first, and the ridges on it
//!    vote no more.
//! 3. Each is fitted to its ridges by total least squares. It counts as far as these cover it
//!    without long gaps; a player in front of it may leave a gap, scattered ridges of a crowd do
//!    not make a line.

use super::marking_pixels::{Crests, Tone};
use crate::paint::GroundPicture;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

/// Maximum number of lines.
const MAX_LINES: usize = 28;

/// Minimum length that the ridges cover, as a share of the picture's larger side.
const MIN_COVERED: f64 = 0.05;

/// Steps of the Hough transform: of the direction, and across, px at 1920 px width.
const STEPS_OF_HALF_TURN: usize = 360;
const ACROSS_PX: f64 = 2.5;

/// A ridge votes for directions this near to its own, in steps.
const VOTED_STEPS: isize = 6;

/// Distance across of the ridges of a line, px at 1920 px width, and the least cosine between
/// their normals and the line's.
const WITHIN_PX: f64 = 2.5;
const MIN_COS: f64 = 0.97;

/// Ridges with a gap of at most this between them cover the line, px at 1920 px width.
const GAP_PX: f64 = 20.0;

/// Pieces shorter than this are chance, px at 1920 px width.
const MIN_PIECE_PX: f64 = 40.0;

/// Other ridges within this of a line are its edges or its halo, px at 1920 px width.
const BESIDE_PX: f64 = 14.0;

/// Minimum number of ridges per px of a piece.
const MIN_DENSITY: f64 = 0.5;

/// A straight line of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct StraightLine {
    /// How it differs from what is beside it.
    pub tone: Tone,
    /// A point on it, px.
    pub at: ImagePoint,
    /// Unit vector across it.
    pub normal: Vec2,
    /// The pieces that ridges cover, as distances along it from [`Self::at`], px, ascending; never
    /// empty.
    pub pieces: Vec<[f64; 2]>,
}

impl StraightLine {
    /// Unit vector along it.
    pub fn direction(&self) -> Vec2 {
        Vec2::new(-self.normal.y, self.normal.x)
    }

    /// The point at a distance along it, px.
    pub fn point_at(&self, along_px: f64) -> ImagePoint {
        self.at.translate(self.direction() * along_px)
    }

    /// The signed distance of a point across it, px.
    pub fn across_px(&self, point: ImagePoint) -> f64 {
        point.offset_from(self.at).dot(&self.normal)
    }

    /// The distance of a point along it, px.
    pub fn along_px(&self, point: ImagePoint) -> f64 {
        point.offset_from(self.at).dot(&self.direction())
    }

    /// The length that ridges cover, px.
    pub fn covered_px(&self) -> f64 {
        self.pieces.iter().map(|[from, to]| to - from).sum()
    }

    /// The part of what is covered that lies within a range along it, px.
    pub fn covered_within_px(&self, [from, to]: [f64; 2]) -> f64 {
        let within = |[start, end]: &[f64; 2]| (end.min(to) - start.max(from)).max(0.0);
        self.pieces.iter().map(within).sum()
    }
}

/// A ridge: its centre and the unit vector across it.
type Ridge = (ImagePoint, Vec2);

/// The long straight lines of a picture: bright ones, then dark ones, then borders of areas, of
/// each those with the most ridges first. The borders of a crowd are longer than lines, so length is no
/// reason to prefer one.
pub fn straight_lines(ground: &GroundPicture) -> Vec<StraightLine> {
    let mut lines = Vec::new();
    let crests = Crests::new(ground);
    for tone in [Tone::Bright, Tone::Dark, Tone::Border] {
        add_lines(ground, &crests, tone, &mut lines);
    }
    lines
}

/// Adds the lines that some ridges make. Those beside a line that is there already are its edges,
/// or the halo of a sharpened picture.
fn add_lines(ground: &GroundPicture, crests: &Crests, tone: Tone, lines: &mut Vec<StraightLine>) {
    let size = ground.size();
    let scale = size.scale_from_1920();
    let min_covered_px = MIN_COVERED * f64::from(size.width.max(size.height));
    let beside_px = BESIDE_PX * scale;
    let mut ridges: Vec<Ridge> = crests
        .anywhere(tone)
        .into_iter()
        .filter(|ridge| {
            let is_edge = |line: &StraightLine| {
                is_on(ridge, line, beside_px)
                    && line.covered_within_px(around(line.along_px(ridge.0))) > 0.0
            };
            !ground.is_masked(ridge.0) && !lines.iter().any(is_edge)
        })
        .collect();
    let mut votes = Votes::new(size);
    for ridge in &ridges {
        votes.count(ridge, 1);
    }
    while lines.len() < MAX_LINES {
        let Some((start, num_votes)) = votes.strongest() else {
            break;
        };
        if f64::from(num_votes) < MIN_DENSITY * min_covered_px {
            break;
        }
        let line = fit(&start, &ridges, scale);
        // The ridges at the start do not vote again, whether or not they made a line.
        let near_px = (WITHIN_PX + ACROSS_PX) * scale;
        let is_taken = |ridge: &Ridge| {
            is_on(ridge, &start, near_px)
                || line
                    .as_ref()
                    .is_some_and(|line| is_on(ridge, line, near_px))
        };
        let (taken, left): (Vec<Ridge>, Vec<Ridge>) = ridges.into_iter().partition(is_taken);
        for ridge in &taken {
            votes.count(ridge, -1);
        }
        ridges = left;
        if taken.is_empty() {
            break;
        }
        let line = line.filter(|line| line.covered_px() >= min_covered_px);
        lines.extend(line.map(|line| StraightLine { tone, ..line }));
    }
}

/// The line of the ridges near a line, without an end. None where they do not cover it.
fn fit(start: &StraightLine, ridges: &[Ridge], scale: f64) -> Option<StraightLine> {
    let mut line = start.clone();
    // The first time from farther away: the start is as coarse as the transform.
    for within_px in [2.0 * WITHIN_PX, WITHIN_PX, WITHIN_PX] {
        let near: Vec<ImagePoint> = ridges
            .iter()
            .filter(|ridge| is_on(ridge, &line, within_px * scale))
            .map(|(at, _)| *at)
            .collect();
        line = StraightLine {
            pieces: covered_pieces(&line, &near, scale),
            ..line
        };
        if line.pieces.is_empty() {
            return None;
        }
        // Ridges off the pieces are other things on the same ray.
        let is_within =
            |at: &&ImagePoint| line.covered_within_px(around(line.along_px(**at))) > 0.0;
        line = through(near.iter().filter(is_within), line.pieces.clone())?;
    }
    Some(line)
}

/// A short range around a distance, px.
fn around(along_px: f64) -> [f64; 2] {
    [along_px - 1.0, along_px + 1.0]
}

/// Whether a ridge lies on a line and runs along it.
fn is_on((at, normal): &Ridge, line: &StraightLine, within_px: f64) -> bool {
    normal.dot(&line.normal).abs() >= MIN_COS && line.across_px(*at).abs() <= within_px
}

/// The pieces of a line that points on it cover.
fn covered_pieces(line: &StraightLine, points: &[ImagePoint], scale: f64) -> Vec<[f64; 2]> {
    let mut along: Vec<f64> = points.iter().map(|at| line.along_px(*at)).collect();
    along.sort_by(f64::total_cmp);
    along
        .chunk_by(|one, next| next - one <= GAP_PX * scale)
        .filter_map(|piece| {
            let (from, to) = (*piece.first()?, *piece.last()?);
            let is_piece = to - from >= MIN_PIECE_PX * scale
                && piece.len() as f64 >= MIN_DENSITY * (to - from);
            is_piece.then_some([from, to])
        })
        .collect()
}

/// The line through some points by total least squares, with these pieces of a line near it.
fn through<'a>(
    points: impl Iterator<Item = &'a ImagePoint> + Clone,
    pieces: Vec<[f64; 2]>,
) -> Option<StraightLine> {
    let count = points.clone().count();
    if count < 2 {
        return None;
    }
    let share = 1.0 / count as f64;
    let (x, y) = points.clone().fold((0.0, 0.0), |(x, y), at| {
        (x + at.x * share, y + at.y * share)
    });
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for at in points {
        let (dx, dy) = (at.x - x, at.y - y);
        (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    // The direction of the largest scatter; across it is the normal.
    let turn = 0.5 * (2.0 * xy).atan2(xx - yy);
    Some(StraightLine {
        tone: Tone::Bright,
        at: ImagePoint::new(x, y),
        normal: Vec2::new(-turn.sin(), turn.cos()),
        pieces,
    })
}

/// The votes of the Hough transform: by the direction of the normal and the distance from the
/// middle of the picture.
struct Votes {
    middle: ImagePoint,
    across_px: f64,
    rows: usize,
    counts: Vec<i32>,
}

impl Votes {
    fn new(size: ImageSize) -> Self {
        let across_px = ACROSS_PX * size.scale_from_1920();
        let half_px = 0.5 * f64::from(size.width).hypot(f64::from(size.height));
        let rows = 2 * (half_px / across_px).ceil() as usize + 1;
        Self {
            middle: size.centre(),
            across_px,
            rows,
            counts: vec![0; rows * STEPS_OF_HALF_TURN],
        }
    }

    /// Adds the votes of a ridge, or takes them back.
    fn count(&mut self, (at, normal): &Ridge, by: i32) {
        let step = std::f64::consts::PI / STEPS_OF_HALF_TURN as f64;
        let own = (normal.y.atan2(normal.x) / step).round() as isize;
        let offset = at.offset_from(self.middle);
        for turned in own - VOTED_STEPS..=own + VOTED_STEPS {
            let turned = turned.rem_euclid(STEPS_OF_HALF_TURN as isize) as usize;
            let across_px = offset.dot(&normal_of(turned));
            let row = (across_px / self.across_px).round() as isize + (self.rows / 2) as isize;
            if (0..self.rows as isize).contains(&row) {
                self.counts[turned * self.rows + row as usize] += by;
            }
        }
    }

    /// The line with the most votes, and their number.
    fn strongest(&self) -> Option<(StraightLine, i32)> {
        let (index, count) = self
            .counts
            .iter()
            .enumerate()
            .max_by_key(|(_, count)| **count)?;
        let (turned, row) = (index / self.rows, index % self.rows);
        let normal = normal_of(turned);
        let across_px = (row as f64 - (self.rows / 2) as f64) * self.across_px;
        let line = StraightLine {
            tone: Tone::Bright,
            at: self.middle.translate(normal * across_px),
            normal,
            pieces: Vec::new(),
        };
        Some((line, *count))
    }
}

fn normal_of(turned: usize) -> Vec2 {
    let angle = std::f64::consts::PI * turned as f64 / STEPS_OF_HALF_TURN as f64;
    Vec2::new(angle.cos(), angle.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{HARD_COURT, SIZE, tennis, tennis_truth};
    use touchline_core::field::Curve;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::pixel_box;

    /// Both ends of a line of the court in the picture; none where one is outside.
    fn seen_ends(from: Vec3, to: Vec3) -> Option<[ImagePoint; 2]> {
        let seen = |at| tennis_truth().image_from_world(at).ok();
        let ends = [seen(from)?, seen(to)?];
        ends.iter().all(|end| SIZE.contains(*end)).then_some(ends)
    }

    #[test]
    fn each_line_of_a_court_in_a_surround_of_another_colour_is_found() {
        let lines = straight_lines(&GroundPicture::new(&HARD_COURT, &[]));
        let mut num_seen = 0;
        for line in tennis().lines.iter().filter(|line| line.painted) {
            let Curve::Segment { from, to } = line.paint_centre else {
                continue;
            };
            let Some(ends) = seen_ends(from, to) else {
                continue;
            };
            let length_px = ends[0].distance_px(ends[1]);
            if length_px < 100.0 {
                continue;
            }
            num_seen += 1;
            let is_shown = |found: &StraightLine| {
                let along = ends.map(|end| found.along_px(end));
                let range_px = [along[0].min(along[1]), along[0].max(along[1])];
                ends.iter().all(|end| found.across_px(*end).abs() < 1.5)
                    && found.covered_within_px(range_px) > 0.8 * length_px
            };
            assert!(lines.iter().any(is_shown), "{} {ends:?}", line.id);
        }
        assert!(num_seen >= 5, "{num_seen}");
        assert!(lines.len() <= 14, "{lines:?}");
    }

    /// The tones of the lines of a picture whose brightness follows from the distance right of a
    /// steep line, px.
    fn tones(grey: impl Fn(f64, u32) -> u8) -> Vec<Tone> {
        let size = ImageSize::new(640, 360);
        let pixels = (0..size.width * size.height).flat_map(|pixel| {
            let (x, y) = (pixel % size.width, pixel / size.width);
            let right_px = f64::from(x) - 300.0 - 0.2 * f64::from(y);
            let grey = grey(right_px, pixel);
            [grey, grey, grey, 255]
        });
        let picture = Picture::new(size, pixels.collect()).unwrap();
        let lines = straight_lines(&GroundPicture::new(&picture, &[]));
        lines.iter().map(|line| line.tone).collect()
    }

    #[test]
    fn a_dark_line_and_the_border_of_two_areas_are_lines_and_have_no_edges() {
        let dark = |right_px: f64, _| if right_px.abs() < 1.5 { 60 } else { 150 };
        assert_eq!(tones(dark), [Tone::Dark]);
        let bright = |right_px: f64, _| if right_px.abs() < 1.5 { 240 } else { 150 };
        assert_eq!(tones(bright), [Tone::Bright]);
        let border = |right_px: f64, _| if right_px < 0.0 { 60 } else { 150 };
        assert_eq!(tones(border), [Tone::Border]);
        // A crowd on one side is no area.
        let crowd = |right_px: f64, pixel: u32| {
            if right_px < 0.0 {
                (pixel.wrapping_mul(2_654_435_761) >> 24) as u8
            } else {
                150
            }
        };
        assert_eq!(tones(crowd), []);
    }

    #[test]
    fn what_is_masked_has_no_lines() {
        let [width, height] = [SIZE.width, SIZE.height].map(f64::from);
        let all = pixel_box(0.0, 0.0, width, height);
        assert_eq!(straight_lines(&GroundPicture::new(&HARD_COURT, &[all])), []);
    }

    /// Ridges everywhere, in all directions.
    #[test]
    fn a_picture_of_noise_or_without_pixels_has_no_lines() {
        let size = ImageSize::new(640, 360);
        let noise = (0..size.width * size.height).flat_map(|pixel| {
            let grey = (pixel.wrapping_mul(2_654_435_761) >> 24) as u8;
            [grey, grey, grey, 255]
        });
        let noise = Picture::new(size, noise.collect()).unwrap();
        assert_eq!(straight_lines(&GroundPicture::new(&noise, &[])), []);
        for size in [ImageSize::new(0, 0), ImageSize::new(3, 2)] {
            let bare = Picture::with_colour(size, [80, 80, 80, 255]);
            assert_eq!(
                straight_lines(&GroundPicture::new(&bare, &[])),
                [],
                "{size:?}"
            );
        }
    }
}
