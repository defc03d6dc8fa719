//! The course of a match: where the ball and the players are, as a plain function of time and seed.

use super::texture::{hash, smooth_walk, sub_seed, unit};
use touchline_core::geometry::Vec3;

/// Which side a person on the pitch belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Plays towards +x.
    Home,
    /// Plays towards −x.
    Away,
    /// The goalkeeper of [`Side::Home`].
    HomeKeeper,
    /// The goalkeeper of [`Side::Away`].
    AwayKeeper,
    /// The referee and the assistants.
    Official,
}

/// A person on the pitch at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Person {
    pub side: Side,
    /// Where the feet are, `world`, m (on the flat ground z = 0).
    pub place: [f64; 2],
    /// m/s.
    pub velocity: [f64; 2],
    /// Where the person looks, radians from +x towards +y.
    pub facing: f64,
    /// How far the stride has gone, radians.
    pub stride: f64,
    /// Body height, m.
    pub height_m: f64,
    /// Chooses skin, hair and build.
    pub look: u32,
}

/// Who plays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Squad {
    /// Players of a side without its goalkeeper.
    players: usize,
    has_keepers: bool,
    /// Whether a net keeps the sides apart.
    has_net: bool,
}

impl Squad {
    /// A soccer team.
    pub const SOCCER: Self = Self::new(10, true, false);

    pub const fn new(players: usize, has_keepers: bool, has_net: bool) -> Self {
        Self {
            players,
            has_keepers,
            has_net,
        }
    }
}

/// The match of one seed on a field of one size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Play {
    seed: u32,
    squad: Squad,
    /// From how far players close in on the ball, m.
    press_m: f64,
    half_length: f64,
    half_width: f64,
}

/// Home positions of ten outfield players (4-4-2) as shares of half the length and half the width,
/// attacking +x.
const FORMATION: [[f64; 2]; 10] = [
    [-0.52, -0.62],
    [-0.58, -0.2],
    [-0.58, 0.22],
    [-0.5, 0.64],
    [-0.12, -0.66],
    [-0.2, -0.18],
    [-0.18, 0.22],
    [-0.1, 0.68],
    [0.24, -0.2],
    [0.3, 0.24],
];

impl Play {
    pub fn new(seed: u64, length_m: f64, width_m: f64, squad: Squad) -> Self {
        Self {
            seed: sub_seed(seed, 0x91A1),
            squad,
            press_m: 8.0 * (length_m / 90.0).min(1.0),
            half_length: 0.5 * length_m,
            half_width: 0.5 * width_m,
        }
    }

    /// Where the ball is, `world`, m: it rolls, and now and then it flies.
    pub fn ball(&self, time_s: f64) -> Vec3 {
        // Play swings from end to end: the wide walk is stretched until it spends as long near the
        // goals as between.
        let x = (1.7 * smooth_walk(self.seed, time_s / 11.0)).tanh()
            + 0.15 * smooth_walk(self.seed ^ 1, time_s / 3.1);
        let y = 0.7 * smooth_walk(self.seed ^ 2, time_s / 6.1)
            + 0.25 * smooth_walk(self.seed ^ 3, time_s / 2.9);
        let height = (smooth_walk(self.seed ^ 4, time_s / 1.7) - 0.55).max(0.0) * 5.0;
        Vec3::new(
            x.clamp(-0.97, 0.97) * self.half_length,
            y.clamp(-0.95, 0.95) * self.half_width,
            0.11 + height,
        )
    }

    /// Everyone on the pitch.
    pub fn people(&self, time_s: f64) -> Vec<Person> {
        // Velocities are central differences of the places, which are functions of time alone.
        let step = 0.08;
        let (before, after) = (self.places(time_s - step), self.places(time_s + step));
        let ball = self.ball(time_s);
        self.places(time_s)
            .into_iter()
            .enumerate()
            .map(|(index, (side, place))| {
                let velocity = [0, 1]
                    .map(|axis| (after[index].1[axis] - before[index].1[axis]) / (2.0 * step));
                let speed = velocity[0].hypot(velocity[1]);
                let to_ball = (ball.y - place[1]).atan2(ball.x - place[0]);
                let look = hash(self.seed ^ 0x700D, index as i32, 5);
                Person {
                    side,
                    place,
                    velocity,
                    // A person who runs looks ahead, all others look at the ball.
                    facing: if speed > 1.6 {
                        velocity[1].atan2(velocity[0])
                    } else {
                        to_ball
                    },
                    stride: time_s * (5.5 + speed) + f64::from(unit(look)) * std::f64::consts::TAU,
                    height_m: 1.70 + 0.22 * f64::from(unit(hash(look, 3, 3))),
                    look,
                }
            })
            .collect()
    }

    fn places(&self, time_s: f64) -> Vec<(Side, [f64; 2])> {
        let ball = self.ball(time_s);
        let ball_share = [ball.x / self.half_length, ball.y / self.half_width];
        let mut places = Vec::with_capacity(25);
        for (side, sign) in [(Side::Home, 1.0), (Side::Away, -1.0)] {
            let mut team: Vec<[f64; 2]> = (0..self.squad.players)
                .map(|player| {
                    // Another number of players is spread over the formation.
                    let [x, y] = FORMATION[player * FORMATION.len() / self.squad.players];
                    // The block shifts with the ball and every player wanders about the place the
                    // shape gives him.
                    let wander = |axis: u32, period: f64| {
                        let seed = self.seed ^ hash(axis, player as i32, sign as i32);
                        smooth_walk(seed, time_s / period)
                    };
                    [
                        (sign * x + 0.46 * ball_share[0] + 0.1 * wander(11, 4.1))
                            .clamp(-0.97, 0.97)
                            * self.half_length,
                        (sign * y * 0.86 + 0.2 * ball_share[1] + 0.12 * wander(12, 3.7))
                            .clamp(-0.97, 0.97)
                            * self.half_width,
                    ]
                })
                .collect();
            self.press(&mut team, ball, sign);
            // No player is nearer to the net than an arm's length, each side on its own half.
            if self.squad.has_net {
                for place in &mut team {
                    place[0] = sign * (sign * place[0]).min(-0.4);
                }
            }
            places.extend(team.into_iter().map(|place| (side, place)));
        }
        // A goalkeeper is farther out the farther the ball is; the referee follows the play behind
        // it; each assistant runs along one half of a touchline.
        let keeper = |sign: f64| {
            let near = (0.5 - 0.5 * sign * ball_share[0]).clamp(0.0, 1.0);
            let out = 0.375 * self.press_m + 1.125 * self.press_m * near;
            [
                sign * (self.half_length - out),
                0.11 * ball.y + smooth_walk(self.seed ^ 0x28, time_s / 3.0),
            ]
        };
        // Keepers stand between the ball and their goals.
        if self.squad.has_keepers {
            places.push((Side::HomeKeeper, keeper(-1.0)));
            places.push((Side::AwayKeeper, keeper(1.0)));
        }
        let roam_m = 0.375 * self.press_m;
        let referee = [
            (ball.x * 0.8 - self.press_m + roam_m * smooth_walk(self.seed ^ 0x32, time_s / 3.0))
                .clamp(-self.half_length, self.half_length),
            (ball.y * 0.6
                + 1.125 * self.press_m
                + roam_m * smooth_walk(self.seed ^ 0x33, time_s / 3.3))
            .clamp(-self.half_width, self.half_width),
        ];
        if !self.squad.has_net {
            places.push((Side::Official, referee));
        }
        let assistant = (0.5 * self.half_length + 0.45 * ball.x).clamp(0.0, self.half_length);
        places.push((Side::Official, [assistant, -self.half_width - 0.7]));
        places.push((
            Side::Official,
            [-self.half_length + assistant, self.half_width + 0.7],
        ));
        places
    }

    /// The players near the ball close in on it, the nearest most; two of a team never stand in one
    /// another.
    fn press(&self, team: &mut [[f64; 2]], ball: Vec3, sign: f64) {
        for (player, place) in team.iter_mut().enumerate() {
            let (dx, dy) = (ball.x - place[0], ball.y - place[1]);
            let distance = dx.hypot(dy);
            // Each player has an own place at up to 0.9 m from the ball: 2.4 rad is about the
            // golden angle, so that these places lie all around it.
            let pull = 0.85 * (-distance / self.press_m).exp();
            let angle = sign + 2.4 * player as f64 + f64::from(unit(self.seed));
            place[0] += dx * pull - 0.9 * pull * angle.cos();
            place[1] += dy * pull - 0.9 * pull * angle.sin();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_two_players_and_three_officials_move_like_people() {
        let play = Play::new(5, 105.0, 68.0, Squad::SOCCER);
        let mut fastest: f64 = 0.0;
        for step in 0..400 {
            let people = play.people(f64::from(step) * 0.7);
            assert_eq!(people.len(), 25);
            for person in &people {
                assert!(person.place[0].abs() < 56.0 && person.place[1].abs() < 38.0);
                fastest = fastest.max(person.velocity[0].hypot(person.velocity[1]));
            }
        }
        assert!(fastest < 25.0, "{fastest} m/s");
    }

    #[test]
    fn the_same_seed_plays_the_same_match() {
        let (a, b) = (
            Play::new(5, 105.0, 68.0, Squad::SOCCER),
            Play::new(5, 105.0, 68.0, Squad::SOCCER),
        );
        assert_eq!(a.ball(12.5), b.ball(12.5));
        assert_ne!(
            a.ball(12.5),
            Play::new(6, 105.0, 68.0, Squad::SOCCER).ball(12.5)
        );
    }
}
