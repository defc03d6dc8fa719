//! What a drawn match looks like and how a camera takes it, with units, and presets from easy to
//! hard.

use std::str::FromStr;
use thiserror::Error;
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImageSize, Vec3};

/// What the stadium is. The same options draw the same stadium, to the last seat.
#[derive(Clone, Debug, PartialEq)]
pub struct StadiumOptions {
    /// Chooses colours, crowd, boards, grass and how the match runs.
    pub seed: u64,
    /// The place around the field, and its floor. Default a stadium.
    pub scene: Scene,
    /// The painted field; posts, crossbars, nets and flags stand where its landmarks and lines say.
    pub field: FieldModel,
    /// The light over the ground.
    pub daylight: Daylight,
    /// The share of seats that are taken, 0 to 1. Default 0.93.
    pub attendance: f64,
    /// How much of the lines' paint is left, 0 to 1; below 1 it goes in patches. Default 1.
    pub paint_left: f64,
}

impl StadiumOptions {
    /// A full stadium in soft daylight around a field.
    pub fn new(field: FieldModel, seed: u64) -> Self {
        Self {
            seed,
            scene: Scene::Stadium,
            field,
            daylight: Daylight::default(),
            attendance: 0.93,
            paint_left: 1.0,
        }
    }
}

/// What is drawn: the stadium with its soccer match, or the court of another sport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Scene {
    /// A soccer match in a stadium.
    #[default]
    Stadium,
    /// A basketball hall, with the lines of other sports.
    Basketball,
    /// An ice hockey rink.
    Hockey,
    /// A tennis court, hard or clay.
    Tennis,
    /// A badminton court on a mat.
    Badminton,
    /// A volleyball court in a hall.
    Volleyball,
    /// A handball court in a hall.
    Handball,
    /// A field of American football.
    Football,
}

/// What changes in a stadium while a match goes on: spectators move, people come and go, boards
/// show something else. The default changes nothing: spectators sit still, and all frames show the
/// same people and boards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Chooses who came and went and which boards changed; frames of one stretch of play share it.
    pub occasion: u64,
    /// The share of seats with another person than at first, 0 to 1.
    pub people_changed: f64,
    /// The share of boards that are drawn again, 0 to 1; a few of them show what they showed.
    pub boards_changed: f64,
    /// Chooses how spectators move; every frame has its own.
    pub instant: u64,
    /// How much spectators move, 0 to 1. At 1 they lean up to 0.11 m to either side, and one in
    /// eight stands.
    pub restlessness: f64,
}

/// The light over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Daylight {
    /// A sun behind thin cloud: soft shadows that point one way.
    #[default]
    Hazy,
    /// A low sun that leaves a part of the pitch in the shadow of the stand: hard on exposure.
    LowSun,
    /// Night: four masts and a faint cross of shadows.
    Floodlit,
}

/// How one frame is taken: everything that is not the camera's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameOptions {
    /// The time since kick-off, s: it places the players and sets the clock.
    pub time_s: f64,
    /// How the camera rotates and zooms while the shutter is open; the frame's camera is that of
    /// mid-exposure.
    pub motion: CameraMotion,
    /// How long the shutter is open, s. Zero, the default: no motion blur.
    pub shutter_s: f64,
    /// The radius of the lens's circle of confusion, px. Zero, the default: sharp.
    pub defocus_px: f64,
    /// Brightness, in stops: +1 doubles the light. Default 0.
    pub exposure_ev: f64,
    /// The loss of light in the corners, a share. Default 0.
    pub vignetting: f64,
    /// 1-σ of the sensor's noise, in levels of 255. Default 0.
    pub noise_levels: f64,
    /// Chooses the noise.
    pub noise_seed: u64,
    /// Which of the broadcaster's graphics are laid over the picture.
    pub graphics: Graphics,
    /// Whether the players (and the ball) are on the pitch. Default true.
    pub players: bool,
}

impl Default for FrameOptions {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            motion: CameraMotion::default(),
            shutter_s: 0.0,
            defocus_px: 0.0,
            exposure_ev: 0.0,
            vignetting: 0.0,
            noise_levels: 0.0,
            noise_seed: 0,
            graphics: Graphics::default(),
            players: true,
        }
    }
}

/// How fast a camera rotates and zooms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraMotion {
    /// Change of pan per second.
    pub pan_per_s: Angle,
    /// Change of tilt per second.
    pub tilt_per_s: Angle,
    /// Relative change of the focal length per second: 0.1 is ten per cent longer.
    pub zoom_per_s: f64,
}

impl CameraMotion {
    /// The same way back.
    #[must_use]
    pub fn reverse(self) -> Self {
        Self {
            pan_per_s: -self.pan_per_s,
            tilt_per_s: -self.tilt_per_s,
            zoom_per_s: -self.zoom_per_s,
        }
    }
}

/// How a whole sequence is taken; a preset of it makes frames comparable between runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShootOptions {
    /// The light over the ground.
    pub daylight: Daylight,
    /// Seconds between frames.
    pub step_s: f64,
    /// Whether the camera neither pans, tilts nor zooms; it then shows the whole field.
    pub is_still: bool,
    /// Shortest and longest focal length, px at 1280 px width; a preset is scaled to other widths.
    pub focal_px_at_1280: [f64; 2],
    /// The lens: k₁ by focal length, for a picture 1280 px wide.
    pub distortion_at_1280: FocalCurve,
    /// How long the shutter is open, s.
    pub shutter_s: f64,
    /// The largest circle of confusion (radius), px at 1280 px width; each frame draws its own.
    pub defocus_px_at_1280: f64,
    /// 1-σ of the exposure from frame to frame, stops.
    pub exposure_sigma_ev: f64,
    /// The loss of light in the corners, a share.
    pub vignetting: f64,
    /// 1-σ of the sensor's noise, levels of 255.
    pub noise_levels: f64,
    /// JPEG quality, 1 to 100.
    pub jpeg_quality: u8,
}

/// A named [`ShootOptions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// A perfect lens and a clean sensor: what is wrong here is wrong in the mathematics.
    Easy,
    /// The conditions of the paper's sequences: long lenses, a trace of noise, ordinary JPEG.
    #[default]
    Paper,
    /// The worst conditions of live television: low sun, motion blur, defocus, noise, a strong
    /// lens, coarse JPEG.
    Hard,
}

/// A preset's name was not known.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no preset {0:?}; there are easy, paper and hard")]
pub struct UnknownPreset(String);

impl FromStr for Preset {
    type Err = UnknownPreset;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "easy" => Ok(Self::Easy),
            "paper" => Ok(Self::Paper),
            "hard" => Ok(Self::Hard),
            _ => Err(UnknownPreset(name.to_owned())),
        }
    }
}

impl Preset {
    /// The settings behind the name.
    pub const fn shoot(self) -> ShootOptions {
        let easy = ShootOptions {
            daylight: Daylight::Hazy,
            step_s: 1.0,
            is_still: false,
            focal_px_at_1280: [1150.0, 2600.0],
            distortion_at_1280: FocalCurve::NONE,
            shutter_s: 0.0,
            defocus_px_at_1280: 0.0,
            exposure_sigma_ev: 0.0,
            vignetting: 0.0,
            noise_levels: 0.0,
            jpeg_quality: 95,
        };
        match self {
            Self::Easy => easy,
            Self::Paper => ShootOptions {
                focal_px_at_1280: [1300.0, 4200.0],
                shutter_s: 1.0 / 500.0,
                exposure_sigma_ev: 0.05,
                vignetting: 0.12,
                noise_levels: 1.5,
                jpeg_quality: 85,
                ..easy
            },
            Self::Hard => ShootOptions {
                daylight: Daylight::LowSun,
                focal_px_at_1280: [1000.0, 4200.0],
                distortion_at_1280: FocalCurve {
                    at_focal_px: 1333.0,
                    value: -0.02,
                    per_1000_px: 0.14,
                    ..FocalCurve::NONE
                },
                shutter_s: 1.0 / 60.0,
                defocus_px_at_1280: 1.6,
                exposure_sigma_ev: 0.25,
                vignetting: 0.3,
                noise_levels: 5.0,
                jpeg_quality: 55,
                ..easy
            },
        }
    }
}

impl ShootOptions {
    /// The main camera of a stadium: on the stand by the halfway line, 66 m from the centre mark
    /// and 18 m up, with this lens, for pictures of this size.
    pub fn main_camera(&self, image_size: ImageSize) -> CameraBase {
        let scale = scale_from_1280(image_size);
        let curve = self.distortion_at_1280;
        CameraBase {
            distortion: FocalCurve {
                at_focal_px: curve.at_focal_px * scale,
                value: curve.value,
                per_1000_px: curve.per_1000_px / scale,
                ..curve
            },
            ..CameraBase::new(
                Vec3::new(1.5, -66.0, 18.0),
                BaseAngles {
                    heading: Angle::ZERO,
                    pitch: Angle::from_degrees(-0.4),
                    roll: Angle::from_degrees(0.25),
                }
                .base_from_world(),
                image_size.centre(),
            )
        }
    }
}

/// How many px of a picture make one px of the presets' width of 1280 px.
pub(super) fn scale_from_1280(image_size: ImageSize) -> f64 {
    f64::from(image_size.width) / 1280.0
}

/// Which graphics are laid over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Graphics {
    /// The score and the clock. Default true.
    pub score_bug: bool,
    /// A band with a name and numbers near the lower edge. Default false.
    pub lower_third: bool,
    /// A channel's half-transparent logo. Default false.
    pub watermark: bool,
    /// How much of its ink covers the picture, 0 to 1. Default 0.45.
    pub watermark_share: f32,
    /// A band near the lower edge through which words run, from the first to the second of these
    /// times since kick-off, s. It slides in from the left and out again, half a second each,
    /// within them. Default none.
    pub ticker_s: Option<[f64; 2]>,
}

impl Default for Graphics {
    fn default() -> Self {
        Self {
            score_bug: true,
            ..Self::NONE
        }
    }
}

impl Graphics {
    /// The picture as the camera takes it.
    pub const NONE: Self = Self {
        score_bug: false,
        lower_third: false,
        watermark: false,
        watermark_share: 0.45,
        ticker_s: None,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_have_names_and_unknown_names_are_refused() {
        for (name, preset) in [
            ("easy", Preset::Easy),
            ("paper", Preset::Paper),
            ("hard", Preset::Hard),
        ] {
            assert_eq!(name.parse::<Preset>(), Ok(preset));
        }
        let error = "harder".parse::<Preset>().unwrap_err().to_string();
        assert_eq!(
            error,
            "there is no preset \"harder\"; there are easy, paper and hard"
        );
    }
}
