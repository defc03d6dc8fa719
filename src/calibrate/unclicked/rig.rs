//! A rig of frames adjusted to paint together with what a search holds fixed: the focal scale, the crown and the size of the field.
//!
//! From a low camera these trade off against its place: a pitch 2 m wider, seen from 3 m farther away, looks nearly the same, and
//! only all of them together, with every frame held to the others by the ties, say which it is.

use super::joint::FramePaint;
use super::pitch_map::PitchMap;
use super::pose::{PaintSight, RigPose, UPRIGHT_SIGMA, share_of_angles};
use super::starts::Start;
use super::turn_levels::{FocalScale, TurnLevels};
use super::venue::Venue;
use crate::camera::{BaseAngles, CameraBase};
use crate::field::{FieldElement, FieldModel};
use crate::geometry::{ImagePoint, Vec3};
use crate::solve::base::BasePriors;
use crate::solve::{BlockEquations, Linearised, Loss, Problem, Residual, Stopping, minimise};
use crate::track::Turns;
use nalgebra::{SMatrix, SVector, Vector1};
use std::collections::{BTreeMap, BTreeSet};

/// Position and rotation of the rig, then the logarithm of the focal scale, the crown and two lengths of the field.
const UNKNOWNS: usize = 10;
const SCALE: usize = 6;
const CROWN: usize = 7;
const LENGTHS: usize = 8;

/// How far off paint still pulls in each round, degrees, from the usual height.
const ROUNDS_DEG: [f64; 7] = [0.4, 0.3, 0.2, 0.15, 0.12, 0.1, 0.1];

/// Paint belongs to a line this near, degrees, from the usual height.
const WITHIN_DEG: f64 = 0.15;

/// Lines lie on a crown of any height the rules of building allow, m.
const CROWNS_M: [f64; 2] = [-0.1, 0.5];

/// A rig where it was adjusted to.
#[derive(Clone)]
pub(super) struct Rig {
    pub pose: RigPose,
    /// The logarithm of the focal scale.
    pub log_scale: f64,
    /// At that scale.
    pub turns: Turns,
    /// With its crown and, where that is open, its size.
    pub field: FieldModel,
    /// The share of the paint that lies on a line.
    pub explained: f64,
}

impl Rig {
    /// The base of its frames' cameras.
    pub fn base(&self) -> CameraBase {
        let RigPose { position_m, world_from_rig } = self.pose;
        let base_from_world = BaseAngles::default().base_from_world() * world_from_rig.transpose();
        let centre = self.turns.image_size.centre();
        CameraBase { distortion: self.turns.lens, ..CameraBase::new(position_m, base_from_world, centre) }
    }
}

/// What is adjusted.
#[derive(Clone, Copy)]
struct State {
    pose: RigPose,
    log_scale: f64,
    crown_m: f64,
    lengths_m: [f64; 2],
}

/// Paint and its line, how the paint moves with the focal scale and the line with the field.
struct Sight {
    /// As it is at `linearised_at`.
    paint: PaintSight,
    direction_by_scale: Vec3,
    line_by: [Vec3; 3],
    linearised_at: State,
}

impl Sight {
    fn moved(&self, at: &State) -> PaintSight {
        let from = &self.linearised_at;
        let direction = self.paint.direction_in_rig + self.direction_by_scale * (at.log_scale - from.log_scale);
        let mut line = self.paint.line;
        line.at += self.line_by[0] * (at.crown_m - from.crown_m);
        for (by, (to, from)) in self.line_by[1..].iter().zip(at.lengths_m.iter().zip(from.lengths_m)) {
            line.at += by * (to - from);
        }
        PaintSight { direction_in_rig: direction.normalize(), line, sigma: self.paint.sigma }
    }
}

impl Residual<1, 0, UNKNOWNS> for Sight {
    type State = State;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        self.paint.sigma
    }

    fn value(&self, at: &State) -> Option<SVector<f64, 1>> {
        self.moved(at).value(&at.pose)
    }

    fn linearised(&self, at: &State) -> Option<Linearised<1, 0, UNKNOWNS>> {
        let moved = self.moved(at);
        let of_pose = moved.linearised(&at.pose)?;
        let (normal, _) = moved.plane(&at.pose)?;
        let mut by_own = SMatrix::<f64, 1, UNKNOWNS>::zeros();
        by_own.fixed_columns_mut::<6>(0).copy_from(&of_pose.by_own);
        by_own[SCALE] = normal.dot(&(at.pose.world_from_rig * self.direction_by_scale));
        // A line that moves is a camera that moves the other way.
        let by_position = of_pose.by_own.fixed_columns::<3>(0);
        for (place, line_by) in self.line_by.iter().enumerate() {
            by_own[CROWN + place] = -(by_position * line_by)[0];
        }
        Some(Linearised { value: of_pose.value, by_shared: SMatrix::zeros(), by_own })
    }
}

/// What is known of one of the unknowns beforehand.
struct Known {
    unknown: usize,
    value: f64,
    sigma: f64,
}

impl Known {
    fn of(&self, at: &State) -> f64 {
        let up = at.pose.world_from_rig.column(2);
        match self.unknown {
            axis @ 0..3 => at.pose.position_m[axis],
            // The pan axis: its lean along x turns the rig about y, and the other way round.
            3 => -up[1],
            4 => up[0],
            SCALE => at.log_scale,
            CROWN => at.crown_m,
            length => at.lengths_m[length - LENGTHS],
        }
    }
}

impl Residual<1, 0, UNKNOWNS> for Known {
    type State = State;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        self.sigma
    }

    fn value(&self, at: &State) -> Option<SVector<f64, 1>> {
        Some(Vector1::new(self.of(at) - self.value))
    }

    fn linearised(&self, at: &State) -> Option<Linearised<1, 0, UNKNOWNS>> {
        let mut by_own = SMatrix::<f64, 1, UNKNOWNS>::zeros();
        by_own[self.unknown] = 1.0;
        Some(Linearised { value: self.value(at)?, by_shared: SMatrix::zeros(), by_own })
    }

    fn loss(&self, _: Loss) -> Loss {
        Loss::Squared
    }
}

struct OnPaint {
    sights: Vec<Sight>,
    known: Vec<Known>,
}

impl Problem for OnPaint {
    type State = State;
    type Equations = BlockEquations<0, UNKNOWNS>;

    fn equations(&self, at: &State) -> Self::Equations {
        let loss = Loss::Cauchy { c: 1.0 };
        let mut equations = BlockEquations::zero();
        for sight in &self.sights {
            equations.add(sight, at, loss);
        }
        for known in &self.known {
            equations.add(known, at, loss);
        }
        equations
    }

    fn stepped(&self, from: &State, step: &SVector<f64, UNKNOWNS>) -> State {
        State {
            pose: from.pose.moved(step.fixed_rows::<3>(0).into_owned(), step.fixed_rows::<3>(3).into_owned()),
            log_scale: from.log_scale + step[SCALE],
            crown_m: (from.crown_m + step[CROWN]).clamp(CROWNS_M[0], CROWNS_M[1]),
            lengths_m: [0, 1].map(|length| from.lengths_m[length] + step[LENGTHS + length]),
        }
    }
}

/// Paint of frames that are turned together.
struct RigPaint<'a> {
    levels: &'a TurnLevels,
    /// The frame of each place.
    places: Vec<(usize, ImagePoint)>,
}

impl<'a> RigPaint<'a> {
    /// The paint of a start, spread over the sphere.
    fn of(levels: &'a TurnLevels, turns: &Turns, paint: &[FramePaint]) -> Self {
        const APART_DEG: f64 = 0.1;
        const KEPT: usize = 12_000;
        let mut taken = BTreeSet::new();
        let mut places = Vec::new();
        for (frame, paint) in paint.iter().enumerate() {
            let camera = turns.camera(frame);
            for image in paint {
                let Ok(direction) = camera.world_direction_from_image(*image) else { continue };
                let cell = [direction.x.atan2(direction.y), direction.z.atan2(direction.xy().norm())]
                    .map(|angle| (angle.to_degrees() / APART_DEG).round() as i64);
                // Several frames that see one place each say it.
                if taken.insert((frame, cell)) {
                    places.push((frame, *image));
                }
            }
        }
        let every = places.len().div_ceil(KEPT).max(1);
        Self { levels, places: places.into_iter().step_by(every).collect() }
    }

    /// The directions of all places at a focal scale.
    fn directions(&self, log_scale: f64) -> Option<Vec<Option<Vec3>>> {
        let turns = self.levels.at(log_scale)?;
        let cameras: Vec<_> = (0..turns.ptz.len()).map(|frame| turns.camera(frame)).collect();
        let direction = |(frame, image): &(usize, ImagePoint)| cameras[*frame].world_direction_from_image(*image).ok();
        Some(self.places.iter().map(direction).collect())
    }
}

/// Adjusts a rig to the paint of a start, from a pose and the logarithm of a focal scale on a field; with a venue whose size is
/// open, the size too. None where too little paint lies near the lines.
pub(super) fn adjusted_rig(
    start: &Start,
    from: (RigPose, f64),
    field: &FieldModel,
    sized: Option<&Venue>,
    levels: &TurnLevels,
) -> Option<Rig> {
    /// The ties are believed of the focal scale unless paint explains so many times as much without them: boards that scroll, or a
    /// lens that is not as the model has it, put them off together.
    const OVER_TIES: f64 = 1.1;
    let paint = RigPaint::of(levels, &start.turns, &start.paint);
    let by_ties = rig_of_scale(levels.scale_by_ties(), &paint, from, field, sized);
    let by_paint = rig_of_scale(FocalScale::unknown(from.1), &paint, from, field, sized);
    match (by_ties, by_paint) {
        (Some(by_ties), Some(by_paint)) if by_paint.explained <= OVER_TIES * by_ties.explained => Some(by_ties),
        (by_ties, by_paint) => by_paint.or(by_ties),
    }
}

/// A rig adjusted to paint where so much is known of the focal scale beforehand.
fn rig_of_scale(
    scale: FocalScale,
    paint: &RigPaint<'_>,
    (pose, from_log_scale): (RigPose, f64),
    field: &FieldModel,
    sized: Option<&Venue>,
) -> Option<Rig> {
    /// Fewer places say nothing.
    const LEAST: usize = 100;
    let lengths = sized.map_or_else(Vec::new, |venue| venue.lengths(field));
    let sized_at = |lengths_m: [f64; 2], crown_m: f64| {
        let sized = sized.and_then(|venue| venue.of_lengths(&lengths_m[..lengths.len()]));
        FieldModel { crown_m, ..sized.unwrap_or_else(|| field.clone()) }
    };
    let mut known = vec![
        Known { unknown: 3, value: 0.0, sigma: UPRIGHT_SIGMA.radians() },
        Known { unknown: 4, value: 0.0, sigma: UPRIGHT_SIGMA.radians() },
        Known { unknown: SCALE, value: scale.log_scale, sigma: scale.sigma },
    ];
    let (crown_m, crown_sigma_m) = if field.may_be_crowned() { BasePriors::default().crown_m } else { (0.0, 1e-6) };
    known.push(Known { unknown: CROWN, value: crown_m, sigma: crown_sigma_m });
    let mut state = State { pose, log_scale: from_log_scale, crown_m: field.crown_m, lengths_m: [0.0; 2] };
    for length in 0..2 {
        let param = lengths.get(length);
        state.lengths_m[length] = param.map_or(0.0, |param| param.value_m);
        let (value, sigma) = param.map_or((0.0, 1e-6), |param| param.assumed);
        known.push(Known { unknown: LENGTHS + length, value, sigma });
    }
    let mut problem = OnPaint { sights: Vec::new(), known };
    for reach_deg in ROUNDS_DEG {
        let reach = share_of_angles(state.pose.position_m.z) * reach_deg.to_radians();
        problem.sights = thinned(sights(&state, paint, &sized_at, reach)?);
        if problem.sights.len() < LEAST {
            return None;
        }
        state = minimise(&problem, state, Stopping { max_iterations: 6, short_step: 1e-6, small_gain: 1e-6 }).state;
    }
    let within = share_of_angles(state.pose.position_m.z) * WITHIN_DEG.to_radians();
    let all = sights(&state, paint, &sized_at, f64::INFINITY)?;
    let on_line = all.iter().filter(|sight| sight.value(&state).is_some_and(|off| off[0].abs() < within)).count();
    Some(Rig {
        pose: state.pose,
        log_scale: state.log_scale,
        turns: paint.levels.at(state.log_scale)?,
        field: sized_at(state.lengths_m, state.crown_m),
        explained: on_line as f64 / paint.places.len().max(1) as f64,
    })
}

/// As many of each line: the near touchline, which every frame shows, would say nearly all, and it says little.
fn thinned(sights: Vec<Sight>) -> Vec<Sight> {
    const OF_LINE: usize = 60;
    let mut of_line: BTreeMap<usize, Vec<Sight>> = BTreeMap::new();
    for sight in sights {
        of_line.entry(sight.paint.line.line).or_default().push(sight);
    }
    let spread = |sights: Vec<Sight>| {
        let every = sights.len().div_ceil(OF_LINE).max(1);
        sights.into_iter().step_by(every)
    };
    of_line.into_values().flat_map(spread).collect()
}

/// Each paint with the line nearest to it, as far as that is within three times the reach.
fn sights(
    at: &State,
    paint: &RigPaint<'_>,
    sized_at: &dyn Fn([f64; 2], f64) -> FieldModel,
    reach: f64,
) -> Option<Vec<Sight>> {
    const SCALE_STEP: f64 = 1e-3;
    const LENGTH_STEP_M: f64 = 0.1;
    let field = sized_at(at.lengths_m, at.crown_m);
    let beside: Vec<FieldModel> = (0..2)
        .map(|length| {
            let mut lengths_m = at.lengths_m;
            lengths_m[length] += LENGTH_STEP_M;
            sized_at(lengths_m, at.crown_m)
        })
        .collect();
    let map = PitchMap::of_few(&field);
    let (here, there) = (paint.directions(at.log_scale)?, paint.directions(at.log_scale + SCALE_STEP)?);
    let sight = |(direction, there): (&Option<Vec3>, &Option<Vec3>)| {
        let (direction, there) = ((*direction)?, (*there)?);
        let line = at.pose.line_at(direction, &map)?;
        let paint = PaintSight { direction_in_rig: direction, line, sigma: reach };
        let off = paint.value(&at.pose)?[0].abs();
        if off > 3.0 * reach {
            return None;
        }
        let drop = Vec3::new(0.0, 0.0, -field.crown().drop_share(line.at.y));
        let line_by = [drop, line.offset_on(&beside[0]) / LENGTH_STEP_M, line.offset_on(&beside[1]) / LENGTH_STEP_M];
        Some(Sight { paint, direction_by_scale: (there - direction) / SCALE_STEP, line_by, linearised_at: *at })
    };
    Some(here.iter().zip(&there).filter_map(sight).collect())
}

#[cfg(test)]
mod tests {
    use super::super::pitch_map::OnLine;
    use super::super::search::Hypothesis;
    use super::*;
    use crate::camera::{FocalCurve, Ptz};
    use crate::document::{Document, FieldSpec};
    use crate::geometry::{Angle, ImageSize, Mat3};
    use std::path::Path;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// Frames along the near half of a pitch, as a low camera on the main stand turns, at a focal scale: the longer the lens, the
    /// smaller the angles.
    fn turns(percent: u32) -> (u32, Turns) {
        let scale = f64::from(percent) / 100.0;
        let ptz = |(pan_deg, focal_px): (f64, f64)| Ptz::from_degrees(pan_deg / scale, -7.0 / scale, focal_px * scale);
        let views = (-5..=5_i32).map(|view| (f64::from(view) * 9.0, 900.0 + 60.0 * f64::from(view.abs())));
        let residual_px = (0.09 + 9.0 * (scale.ln()).powi(2)).sqrt();
        let lens = FocalCurve::NONE;
        (percent, Turns { ptz: views.map(ptz).collect(), lens, image_size: SIZE, residual_px })
    }

    fn levels() -> TurnLevels {
        TurnLevels::new([94, 100, 106].map(turns))
    }

    /// The paint of a field as frames show it from a pose.
    fn start(pose: &RigPose, field: &FieldModel) -> Start {
        start_at(100, pose, field)
    }

    /// The same where the frames are turned as at another focal scale.
    fn start_at(percent: u32, pose: &RigPose, field: &FieldModel) -> Start {
        let (_, turns) = turns(percent);
        let map = PitchMap::of_few(field);
        let of_frame = |frame: usize| -> FramePaint {
            let camera = turns.camera(frame);
            let seen = |at: Vec3| camera.image_from_world(pose.direction_in_rig(at)?).ok();
            let shown = |line: &OnLine| seen(line.at).filter(|image| SIZE.contains(*image));
            map.samples(1.0).filter_map(|line| shown(&line)).collect()
        };
        let paint = (0..turns.ptz.len()).map(of_frame).collect();
        let hypothesis = Hypothesis { pose: *pose, field: 0, explained: 1.0, visible: 1.0 };
        Start { hypothesis, log_scale: (f64::from(percent) / 100.0).ln(), turns, paint }
    }

    /// A soccer pitch whose size is not known, and one of its sizes.
    fn venue() -> (Venue, FieldModel) {
        let document = Document::new(FieldSpec::new("soccer"));
        let venue = Venue::of(document.at(Path::new("")), &"main".into()).unwrap();
        let field = FieldModel { crown_m: 0.3, ..venue.of_lengths(&[107.5, 66.0]).unwrap() };
        (venue, field)
    }

    fn assert_near(found: &Rig, pose: &RigPose, field: &FieldModel) {
        let off_m = (found.pose.position_m - pose.position_m).norm();
        assert!(off_m < 0.1, "{off_m:.3} m off");
        let turned = found.pose.world_from_rig.transpose() * pose.world_from_rig;
        assert!((turned - Mat3::identity()).norm() < 1e-3, "{turned:?}");
        assert!(found.log_scale.abs() < 2e-3, "{}", found.log_scale);
        let [length_m, width_m] = [found.field.length_m - field.length_m, found.field.width_m - field.width_m];
        assert!(length_m.abs() < 0.15 && width_m.abs() < 0.15, "{length_m:.3}, {width_m:.3} m");
        assert!((found.field.crown_m - field.crown_m).abs() < 0.05, "{}", found.field.crown_m);
        assert!(found.explained > 0.97, "{}", found.explained);
    }

    #[test]
    fn place_scale_crown_and_size_are_found_together_from_a_low_camera() {
        let (venue, field) = venue();
        let pose = RigPose::upright(Vec3::new(-12.0, -63.0, 7.5), Angle::from_degrees(4.0));
        let start = start(&pose, &field);
        for (shift_m, turn_deg, log_scale) in [
            (Vec3::zeros(), 0.0, 0.0),
            (Vec3::new(0.6, -0.9, 0.1), 0.3, 0.01),
            (Vec3::new(-0.8, 0.7, -0.1), -0.3, -0.01),
        ] {
            let from = pose.moved(shift_m, Vec3::new(0.0, 0.0, f64::to_radians(turn_deg)));
            let found = adjusted_rig(&start, (from, log_scale), &venue.assumed, Some(&venue), &levels()).unwrap();
            assert_near(&found, &pose, &field);
        }
    }

    #[test]
    fn paint_says_the_focal_scale_where_all_ties_are_put_off_together() {
        let (venue, field) = venue();
        let pose = RigPose::upright(Vec3::new(-5.0, -66.0, 14.0), Angle::from_degrees(2.0));
        let start = start_at(135, &pose, &field);
        let levels = TurnLevels::new([88, 94, 100, 106, 113, 120, 127, 135, 143].map(turns));
        assert!(levels.scale_by_ties().sigma < 0.01, "they are sure of another scale");
        let found = adjusted_rig(&start, (pose, start.log_scale), &venue.assumed, Some(&venue), &levels).unwrap();
        assert!((found.log_scale - start.log_scale).abs() < 5e-3, "{}", found.log_scale);
        assert!((found.pose.position_m - pose.position_m).norm() < 0.3, "{:?}", found.pose.position_m);
    }

    #[test]
    fn a_known_size_is_kept_and_one_that_is_wrong_explains_less() {
        let (venue, field) = venue();
        let pose = RigPose::upright(Vec3::new(20.0, -60.0, 9.0), Angle::from_degrees(-10.0));
        let start = start(&pose, &field);
        let on = |field: &FieldModel| adjusted_rig(&start, (pose, 0.0), field, None, &levels()).unwrap();
        let known = on(&field);
        assert_near(&known, &pose, &field);
        let wrong = on(&venue.of_lengths(&[100.0, 70.0]).unwrap());
        assert!((wrong.field.length_m, wrong.field.width_m) == (100.0, 70.0));
        assert!(wrong.explained < known.explained - 0.1, "{} and {}", wrong.explained, known.explained);
    }

    #[test]
    fn paint_far_from_every_line_or_none_at_all_has_no_rig() {
        let (venue, field) = venue();
        let pose = RigPose::upright(Vec3::new(-12.0, -63.0, 7.5), Angle::from_degrees(4.0));
        let mut start = start(&pose, &field);
        let away = RigPose { position_m: Vec3::new(-12.0, -400.0, 7.5), ..pose };
        assert!(adjusted_rig(&start, (away, 0.0), &venue.assumed, Some(&venue), &levels()).is_none());
        start.paint.iter_mut().for_each(Vec::clear);
        assert!(adjusted_rig(&start, (pose, 0.0), &venue.assumed, Some(&venue), &levels()).is_none());
        assert!(adjusted_rig(&start, (pose, 0.0), &field, None, &TurnLevels::new([])).is_none());
    }
}
