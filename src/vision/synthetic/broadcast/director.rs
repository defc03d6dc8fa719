//! Which shots a broadcast has: what they show, from which camera, and how one follows another.

use super::transition::TransitionStyle;
use crate::synthetic::play::Play;
use crate::synthetic::texture::{hash, unit};
use std::ops::Range;

/// Frames of a broadcast in a second.
pub const BROADCAST_FPS: f64 = 25.0;

/// What a shot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShotSubject {
    /// The match as it is played.
    Play,
    /// What happened before, slowed; a wipe with a logo comes before the first and after the last.
    Replay,
    /// One player.
    CloseUp,
    /// Spectators.
    Crowd,
}

impl ShotSubject {
    /// The name in documents.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Play => "play",
            Self::Replay => "replay",
            Self::CloseUp => "close_up",
            Self::Crowd => "crowd",
        }
    }

    /// Whether the field is in view, so that its lines determine the camera.
    pub const fn shows_field(self) -> bool {
        matches!(self, Self::Play | Self::Replay)
    }
}

/// One shot of a broadcast.
#[derive(Clone, Debug, PartialEq)]
pub struct BroadcastShot {
    /// The frames that show this shot alone.
    pub frames: Range<usize>,
    /// How it begins, and the frames that this takes, right before its own; they show both shots or
    /// none.
    pub transition: TransitionStyle,
    /// See `transition`.
    pub transition_frames: Range<usize>,
    /// The index of its camera.
    pub camera: usize,
    /// What it shows.
    pub subject: ShotSubject,
    /// Seconds of the match in a second of the broadcast: 1 but in a replay.
    pub speed: f64,
    /// The time since kick-off in the first frame in which it is seen, s.
    pub start_s: f64,
    /// Whether a band with a name lies over it.
    pub lower_third: bool,
}

impl BroadcastShot {
    /// The time since kick-off in a frame, s.
    pub fn time_s(&self, frame: usize) -> f64 {
        let since = frame as f64 - self.transition_frames.start as f64;
        self.start_s + self.speed * since / BROADCAST_FPS
    }
}

/// Which camera takes a shot: the main one, that of the penalty area near the ball, any other of
/// the stands, or the one beside the pitch.
#[derive(Clone, Copy)]
enum Choice {
    Main,
    NearBall,
    Other,
    Pitchside,
}

/// A shot as the director plans it: subject, camera, shortest and longest duration, s.
type Step = (ShotSubject, Choice, [f64; 2]);

/// A minute of a broadcast, which is repeated: what it shows changes as the draws do.
const RUN: [Step; 14] = [
    (ShotSubject::Play, Choice::Main, [5.5, 9.0]),
    (ShotSubject::CloseUp, Choice::Pitchside, [2.4, 4.0]),
    (ShotSubject::Play, Choice::NearBall, [3.5, 6.0]),
    (ShotSubject::Play, Choice::Main, [5.0, 8.0]),
    (ShotSubject::Replay, Choice::NearBall, [3.5, 5.5]),
    (ShotSubject::Replay, Choice::Other, [3.0, 5.0]),
    (ShotSubject::Play, Choice::Main, [5.0, 8.0]),
    (ShotSubject::Crowd, Choice::Pitchside, [2.4, 3.6]),
    (ShotSubject::Play, Choice::Other, [3.5, 6.0]),
    (ShotSubject::CloseUp, Choice::Pitchside, [2.4, 4.0]),
    (ShotSubject::Play, Choice::Main, [5.0, 8.0]),
    (ShotSubject::Play, Choice::NearBall, [3.5, 6.0]),
    (ShotSubject::CloseUp, Choice::Pitchside, [2.4, 3.6]),
    (ShotSubject::Play, Choice::Other, [3.5, 6.0]),
];

/// A replay begins this long before the shot that it interrupts the match in, s.
const REPLAY_BACK_S: f64 = 6.0;
/// No shot is shorter, frames.
const LEAST_FRAMES: usize = 40;

/// Draws of one broadcast, from 0 to 1, one after the other.
struct Draws {
    seed: u32,
    count: i32,
}

impl Draws {
    fn next(&mut self) -> f64 {
        self.count += 1;
        f64::from(unit(hash(self.seed, self.count, 0x5407)))
    }

    fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.next()
    }

    /// How a shot begins that is not next to a replay.
    fn transition(&mut self) -> TransitionStyle {
        match self.next() {
            ..0.6 => TransitionStyle::Cut,
            ..0.8 => TransitionStyle::Dissolve,
            ..0.9 => TransitionStyle::Wipe,
            _ => TransitionStyle::Fade,
        }
    }
}

/// The shots of a broadcast of this many frames. Of the `cameras` the first is the main one, the
/// next two are those of the left and the right penalty area, and the one with the number `cameras`
/// stands beside the pitch.
pub(super) fn plan_shots(
    seed: u32,
    frames: usize,
    cameras: usize,
    play: &Play,
) -> Vec<BroadcastShot> {
    let mut draws = Draws { seed, count: 0 };
    let mut shots: Vec<BroadcastShot> = Vec::new();
    let mut event_s = 0.0;
    for &(subject, choice, seconds) in RUN.iter().cycle() {
        let begin = shots.last().map_or(0, |shot| shot.frames.end);
        let live_s = begin as f64 / BROADCAST_FPS;
        let before = shots.last().map(|shot| (shot.subject, shot.camera));
        let is_replay = subject == ShotSubject::Replay;
        let was_replay = before.map(|(subject, _)| subject == ShotSubject::Replay);
        // All shots of a replay show one event, from different cameras.
        if is_replay && was_replay != Some(true) {
            event_s = (live_s - REPLAY_BACK_S).max(0.0);
        }
        // The first shot begins at once, and a logo stands between the match and its replays.
        let transition = match was_replay {
            None => TransitionStyle::Cut,
            Some(was_replay) if was_replay != is_replay => TransitionStyle::LogoWipe,
            Some(_) => draws.transition(),
        };
        // The frames of a transition belong to neither shot: they come before the new one's own.
        let span = draws.between(transition.frames().map(|frames| frames as f64)) as usize;
        let own = (BROADCAST_FPS * draws.between(seconds)) as usize;
        let start = begin + span;
        if start + LEAST_FRAMES > frames {
            break;
        }
        // A replay shows the past; everything else goes on with the match.
        let start_s = if is_replay { event_s } else { live_s };
        // Left and right by where the ball is when the shot begins, which a director sees.
        let wanted = match choice {
            Choice::Main => 0,
            Choice::NearBall => 1 + usize::from(play.ball(start_s).x > 0.0),
            Choice::Other => 1 + (draws.next() * (cameras - 1) as f64) as usize,
            Choice::Pitchside => cameras,
        };
        // No shot is followed by one of the same camera: the picture would jump.
        let is_same = before.is_some_and(|(_, camera)| camera == wanted);
        shots.push(BroadcastShot {
            frames: start..(start + own).min(frames),
            transition,
            transition_frames: begin..start,
            camera: if is_same {
                (wanted + 1) % cameras
            } else {
                wanted
            },
            subject,
            speed: if is_replay {
                draws.between([0.35, 0.5])
            } else {
                1.0
            },
            start_s,
            lower_third: !is_replay && draws.next() < 0.3,
        });
    }
    // What is too short for another shot is the last one's.
    if let Some(last) = shots.last_mut() {
        last.frames.end = frames;
    }
    shots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::play::Squad;

    #[test]
    fn shots_follow_each_other_without_gaps_and_replays_lie_between_logos() {
        let play = Play::new(7, 105.0, 68.0, Squad::SOCCER);
        for (seed, cameras) in (0..40).zip((3..=7).cycle()) {
            let shots = plan_shots(seed, 2250, cameras, &play);
            assert!(shots.len() >= 15, "{} shots", shots.len());
            assert_eq!(
                (shots[0].transition_frames.start, shots[0].frames.start),
                (0, 0)
            );
            assert_eq!(shots.last().unwrap().frames.end, 2250);
            for pair in shots.windows(2) {
                let [before, after] = pair else {
                    unreachable!()
                };
                assert_eq!(before.frames.end, after.transition_frames.start);
                assert_eq!(after.transition_frames.end, after.frames.start);
                assert!(after.frames.len() >= LEAST_FRAMES && after.camera <= cameras);
                assert_ne!(before.camera, after.camera);
                let replays = [before, after].map(|shot| shot.subject == ShotSubject::Replay);
                let is_logo = after.transition == TransitionStyle::LogoWipe;
                assert_eq!(is_logo, replays[0] != replays[1]);
            }
        }
    }

    #[test]
    fn a_broadcast_too_short_for_a_shot_has_none() {
        let play = Play::new(7, 105.0, 68.0, Squad::SOCCER);
        assert_eq!(plan_shots(1, LEAST_FRAMES - 1, 5, &play), []);
    }
}
