//! The scenes that can be drawn, as a table: for each sport its template, its floor, its lines and
//! what else is on it, and where its cameras stand.
//!
//! Lines, posts, nets and boards come from the template itself, so that a sport needs a row of this
//! table and no code.

use super::options::{Daylight, Scene};
use super::play::Squad;
use super::texture::{hash, sub_seed, unit};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Where a camera stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraSide {
    /// Beside the field, opposite its middle.
    Side,
    /// Behind an end.
    End,
    /// Beyond a corner.
    Corner,
}

/// A scene and where its camera stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    scene: Scene,
    side: CameraSide,
}

/// Why a scene cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SceneError {
    /// No scene has this name.
    #[error("there is no scene {0:?}; there are {names}", names = names(&Scene::ALL))]
    UnknownScene(String),
    /// No place of a camera has this name.
    #[error("no camera stands at {0:?}; there are {names}", names = names(&CameraSide::ALL))]
    UnknownSide(String),
    /// The scene has no camera there.
    #[error("the scene {scene} has no camera at the {side}; it has {}", names(&sides(*.scene)))]
    NoCamera {
        /// The scene.
        scene: Scene,
        /// Where a camera was wanted.
        side: CameraSide,
    },
}

impl Scene {
    const ALL: [Self; 8] = [
        Self::Stadium,
        Self::Basketball,
        Self::Hockey,
        Self::Tennis,
        Self::Badminton,
        Self::Volleyball,
        Self::Handball,
        Self::Football,
    ];

    /// The name of its field's template.
    pub fn template(self) -> &'static str {
        self.court().map_or("soccer", |court| court.template)
    }

    /// Its light: halls keep their lamps on, whatever the weather.
    pub fn daylight(self, outdoors: Daylight) -> Daylight {
        match self.court() {
            Some(court) if court.is_hall => Daylight::Floodlit,
            _ => outdoors,
        }
    }

    pub(super) const fn court(self) -> Option<&'static Court> {
        match self {
            Self::Stadium => None,
            Self::Basketball => Some(&BASKETBALL),
            Self::Hockey => Some(&HOCKEY),
            Self::Tennis => Some(&TENNIS),
            Self::Badminton => Some(&BADMINTON),
            Self::Volleyball => Some(&VOLLEYBALL),
            Self::Handball => Some(&HANDBALL),
            Self::Football => Some(&FOOTBALL),
        }
    }
}

impl CameraSide {
    const ALL: [Self; 3] = [Self::Side, Self::End, Self::Corner];
}

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

impl fmt::Display for CameraSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

impl FromStr for Scene {
    type Err = SceneError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL
            .into_iter()
            .find(|scene| scene.to_string() == name);
        named.ok_or_else(|| SceneError::UnknownScene(name.to_owned()))
    }
}

impl FromStr for CameraSide {
    type Err = SceneError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|side| side.to_string() == name);
        named.ok_or_else(|| SceneError::UnknownSide(name.to_owned()))
    }
}

fn names(all: &[impl fmt::Display]) -> String {
    let names: Vec<String> = all.iter().map(ToString::to_string).collect();
    names.join(", ")
}

/// Where a scene's cameras stand, the usual one first.
fn sides(scene: Scene) -> Vec<CameraSide> {
    scene.court().map_or_else(
        || vec![CameraSide::Side],
        |court| court.cameras_m.iter().map(|(side, _)| *side).collect(),
    )
}

impl Default for Setting {
    /// The stadium from its main camera.
    fn default() -> Self {
        Self {
            scene: Scene::Stadium,
            side: CameraSide::Side,
        }
    }
}

impl Setting {
    /// A scene seen from a side; none: from where its sport is usually seen.
    ///
    /// # Errors
    /// The scene has no camera there.
    pub fn new(scene: Scene, side: Option<CameraSide>) -> Result<Self, SceneError> {
        let sides = sides(scene);
        let side = side.unwrap_or(sides[0]);
        if sides.contains(&side) {
            Ok(Self { scene, side })
        } else {
            Err(SceneError::NoCamera { scene, side })
        }
    }

    /// The scene.
    pub const fn scene(self) -> Scene {
        self.scene
    }

    /// Where the camera of a court stands, `world`, m: each hall has its own stand, so the seed
    /// moves it by up to 8 % of its distance and of its height. None for the stadium, whose main
    /// camera is the preset's.
    pub(super) fn camera_m(self, seed: u64) -> Option<[f64; 3]> {
        let court = self.scene.court()?;
        let (_, place) = court
            .cameras_m
            .iter()
            .find(|(side, _)| *side == self.side)?;
        let seed = sub_seed(seed, 0xCA3B);
        let [away, up] = [0, 1].map(|axis| 0.92 + 0.16 * f64::from(unit(hash(seed, axis, 0))));
        Some([place[0] * away + 0.2, place[1] * away - 0.3, place[2] * up])
    }
}

/// What a floor is made of.
#[derive(Clone, Copy, Debug)]
pub(super) enum Surface {
    Wood,
    Hard,
    Clay,
    Ice,
    Mat,
    Turf,
}

/// From the far touchline to the boards, m.
const BEHIND_TOUCHLINE_M: f64 = 4.2;
/// From the goal lines to the boards, m.
const BEHIND_GOAL_LINE_M: f64 = 5.6;

/// From the goal lines and from the touchlines of a scene to its boards, m.
pub(super) fn boards_m(scene: Scene) -> [f64; 2] {
    let court = scene.court();
    court.map_or([BEHIND_GOAL_LINE_M, BEHIND_TOUCHLINE_M], |court| {
        court.boards_m
    })
}

/// A court of a sport.
#[derive(Debug)]
pub(super) struct Court {
    pub template: &'static str,
    /// Its surfaces, one of which the seed chooses, and for each the colours of the floor within
    /// the lines, around them, and of the painted areas.
    pub floors: &'static [(Surface, [u32; 3])],
    /// How far the colour of the court reaches beyond its lines, m.
    pub margin_m: f64,
    /// The colours of its lines: the first row whose word is in the line's name counts.
    pub lines: &'static [(&'static str, u32)],
    /// Painted areas: the landmarks at two opposite corners, `@` for left and right.
    pub areas: &'static [[&'static str; 2]],
    /// Courts of other sports on the same floor.
    pub others: &'static [OtherCourt],
    /// The radius of the logo in the middle, m; 0 for none.
    pub logo_m: f64,
    /// From the goal lines and from the touchlines to the advertising boards, m.
    pub boards_m: [f64; 2],
    /// The height of a net from its upper edge down, m.
    pub net_m: f64,
    pub is_hall: bool,
    pub squad: Squad,
    /// Where cameras stand, m, the usual one first.
    cameras_m: &'static [(CameraSide, [f64; 3])],
}

/// A court of another sport on the same floor.
#[derive(Debug)]
pub(super) struct OtherCourt {
    pub template: &'static str,
    pub colour: u32,
    /// Where their middles are, m.
    pub centres_m: &'static [[f64; 2]],
    /// Whether they lie across this court.
    pub is_across: bool,
}

const WHITE: u32 = 0xF3_F5EE;

const BASKETBALL: Court = Court {
    template: "basketball_fiba",
    floors: &[
        // Parquet with red keys, with keys and surround in blue, and with a dark surround.
        (Surface::Wood, [0xC8_9A62, 0xC8_9A62, 0x8C_2B2B]),
        (Surface::Wood, [0xD8_B27C, 0x24_4A86, 0x24_4A86]),
        (Surface::Wood, [0xB9_8450, 0x39_3C40, 0xB9_8450]),
    ],
    margin_m: 0.05,
    lines: &[("", WHITE)],
    areas: &[["key_near_@_end_line", "key_far_@_free_throw"]],
    // A school's hall has a volleyball court across the middle.
    others: &[OtherCourt {
        template: "volleyball",
        colour: 0x2E_5E3C,
        centres_m: &[[0.0, 0.0]],
        is_across: false,
    }],
    logo_m: 1.7,
    boards_m: [3.0, 3.0],
    net_m: 0.0,
    is_hall: true,
    squad: Squad::new(5, false, false),
    cameras_m: &[
        // Broadcasts of halls look from the stands' middle row, behind a basket, and from a corner
        // box.
        (CameraSide::Side, [0.0, -25.0, 10.0]),
        (CameraSide::End, [-33.0, 0.0, 11.0]),
        (CameraSide::Corner, [-22.0, -18.0, 9.0]),
    ],
};

const HOCKEY: Court = Court {
    template: "ice_hockey_nhl",
    floors: &[(Surface::Ice, [0xDF_E8EE, 0xDF_E8EE, 0x9C_C4E4])],
    margin_m: 0.0,
    // Rule 1 of the league: blue lines are blue, all others red.
    lines: &[("blue_line", 0x1F_4C9C), ("", 0xC0_2A34)],
    areas: &[["crease_near_@", "crease_far_@_front"]],
    others: &[],
    logo_m: 3.6,
    boards_m: [2.5, 2.5],
    net_m: 0.0,
    is_hall: true,
    squad: Squad::new(5, true, false),
    cameras_m: &[
        (CameraSide::Side, [0.0, -38.0, 14.0]),
        (CameraSide::End, [-50.0, 0.0, 14.0]),
        (CameraSide::Corner, [-42.0, -26.0, 13.0]),
    ],
};

const TENNIS: Court = Court {
    template: "tennis",
    floors: &[
        // The colours of the large tournaments: court and surround differ, on clay they do not.
        (Surface::Hard, [0x3A_5F93, 0x4C_7A55, 0x3A_5F93]),
        (Surface::Hard, [0x5B_4A86, 0x3F_6F58, 0x5B_4A86]),
        (Surface::Hard, [0x2F_6CA8, 0x2A_4F86, 0x2F_6CA8]),
        (Surface::Clay, [0xB4_683C, 0xB4_683C, 0xB4_683C]),
    ],
    margin_m: 0.15,
    lines: &[("", WHITE)],
    areas: &[],
    others: &[],
    logo_m: 0.0,
    boards_m: [6.0, 4.0],
    net_m: 1.0,
    is_hall: false,
    squad: Squad::new(1, false, true),
    cameras_m: &[
        // Tennis is shown from behind a baseline; the side is for replays.
        (CameraSide::End, [-34.0, 0.0, 9.8]),
        (CameraSide::Side, [0.0, -24.0, 9.0]),
        (CameraSide::Corner, [-25.0, -18.0, 9.0]),
    ],
};

const BADMINTON: Court = Court {
    template: "badminton",
    floors: &[
        (Surface::Mat, [0x2E_7A54, 0xB9_8450, 0x2E_7A54]),
        (Surface::Mat, [0x2B_7A5A, 0x2C_4C8C, 0x2B_7A5A]),
        (Surface::Mat, [0x35_7F56, 0x4A_4E55, 0x35_7F56]),
    ],
    // A mat ends this far beyond the boundary lines; the hall's floor is seen around it.
    margin_m: 0.6,
    lines: &[("", WHITE)],
    areas: &[],
    others: &[],
    logo_m: 0.0,
    boards_m: [3.0, 3.0],
    net_m: 0.76,
    is_hall: true,
    squad: Squad::new(2, false, true),
    cameras_m: &[
        (CameraSide::End, [-21.0, 0.0, 6.8]),
        (CameraSide::Side, [0.0, -16.0, 6.0]),
        (CameraSide::Corner, [-15.0, -11.0, 6.0]),
    ],
};

const VOLLEYBALL: Court = Court {
    template: "volleyball",
    floors: &[
        (Surface::Mat, [0xD0_7A3C, 0x2F_7C78, 0xD0_7A3C]),
        (Surface::Mat, [0xCC_7440, 0x2C_4F92, 0xB8_6430]),
        (Surface::Wood, [0xC8_9A62, 0xC8_9A62, 0xC8_9A62]),
    ],
    margin_m: 0.0,
    lines: &[("", WHITE)],
    areas: &[["attack_near_@", "halfway_far"]],
    others: &[OtherCourt {
        template: "badminton",
        colour: 0x2E_5E3C,
        // Three badminton courts side by side fill the hall.
        centres_m: &[[-7.0, 0.0], [0.0, 0.0], [7.0, 0.0]],
        is_across: true,
    }],
    logo_m: 0.0,
    boards_m: [5.0, 4.5],
    net_m: 1.0,
    is_hall: true,
    squad: Squad::new(6, false, true),
    cameras_m: &[
        (CameraSide::Side, [0.0, -19.0, 7.0]),
        (CameraSide::End, [-24.0, 0.0, 7.5]),
        (CameraSide::Corner, [-18.0, -13.0, 7.0]),
    ],
};

const HANDBALL: Court = Court {
    template: "handball",
    floors: &[
        // Mats in one or two colours, and a wooden floor.
        (Surface::Mat, [0x3E_78B0, 0x2A_3F70, 0x3E_78B0]),
        (Surface::Wood, [0xC8_9A62, 0xC8_9A62, 0xC8_9A62]),
        (Surface::Mat, [0x46_7C8E, 0x8A_3B36, 0x46_7C8E]),
    ],
    margin_m: 0.0,
    lines: &[("", WHITE)],
    areas: &[],
    others: &[
        OtherCourt {
            template: "basketball_fiba",
            colour: 0x22_2426,
            centres_m: &[[0.0, 0.0]],
            is_across: false,
        },
        OtherCourt {
            template: "volleyball",
            colour: 0x2E_5E3C,
            centres_m: &[[-12.0, 0.0], [0.0, 0.0], [12.0, 0.0]],
            is_across: true,
        },
    ],
    logo_m: 1.5,
    boards_m: [2.5, 2.5],
    net_m: 0.0,
    is_hall: true,
    squad: Squad::new(6, true, false),
    cameras_m: &[
        (CameraSide::Side, [0.0, -27.0, 9.5]),
        (CameraSide::End, [-37.0, 0.0, 10.0]),
        (CameraSide::Corner, [-29.0, -20.0, 9.5]),
    ],
};

const FOOTBALL: Court = Court {
    template: "american_football_nfl",
    floors: &[
        (Surface::Turf, [0x4C_7038, 0x4C_7038, 0x1E_3566]),
        (Surface::Turf, [0x4C_7038, 0x4C_7038, 0x8A_2430]),
    ],
    margin_m: 5.0,
    lines: &[("", WHITE)],
    // Hash marks of 4 in at each yard.
    areas: &[["corner_near_@", "goal_line_far_@"]],
    others: &[],
    logo_m: 4.5,
    boards_m: [6.5, 6.5],
    net_m: 0.0,
    is_hall: false,
    squad: Squad::new(11, false, false),
    cameras_m: &[
        // From the press box at the 50-yard line, the end zone's tower, and the corner between
        // them.
        (CameraSide::Side, [-4.0, -84.0, 29.0]),
        (CameraSide::End, [-98.0, 0.0, 26.0]),
        (CameraSide::Corner, [-78.0, -52.0, 27.0]),
    ],
};
