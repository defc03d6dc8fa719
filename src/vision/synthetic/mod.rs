//! A synthetic match with exact truth: for tests, measurements, the demo and `touchline synth`.
//!
//! [`stadium`] builds a place from a seed: striped grass whose grain differs from spot to spot, the
//! painted lines of a [`FieldModel`](touchline_core::field::FieldModel) at their real width, boards
//! with words, stands full of people, goals with nets, and a match in progress. [`Stadium::render`]
//! takes a picture of it with a [`PtzCamera`](touchline_core::camera::PtzCamera): every pixel is
//! the ray of its centre through the exact camera, so the truth is exact. [`camera_path`] moves the
//! camera as an operator would. Nothing is copied from real footage; all names are invented.
//!
//! Other sports are drawn by the same means: `courts` is a table of their floors, lines and camera
//! places, and `floor` draws what they are played on.
//!
//! [`Stadium::at`] lets spectators move and boards change between frames, as they do in a real one.
//!
//! [`Broadcast`] cuts pictures of several cameras together: shots and replays, with the transitions
//! between them.
//!
//! Patterns finer than a pixel fade instead of aliasing; lines, people, posts and nets are covered
//! analytically; where surfaces meet, a pixel is the mean of a grid of rays. Everything is a plain
//! function of seed, place and time, so the same options give the same bytes at any number of
//! threads.

mod boards;
mod body;
mod bowl;
mod broadcast;
mod clicks;
mod courts;
mod coverage;
mod crowd;
mod floor;
mod graphics;
mod grass;
mod lens;
mod light;
mod options;
mod paint;
mod path;
mod play;
mod props;
mod ray;
mod render;
mod solid;
mod stadium;
mod text;
mod texture;

pub use options::Moment;
pub use stadium::stadium;
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    broadcast::BROADCAST_FPS, broadcast::Broadcast, broadcast::BroadcastOptions,
    broadcast::BroadcastShot, broadcast::ShotSubject, broadcast::TransitionStyle,
    clicks::ClickOptions, clicks::ClickTarget, clicks::SyntheticClick, clicks::generate_clicks,
    courts::CameraSide, courts::SceneError, courts::Setting, options::CameraMotion,
    options::Daylight, options::FrameOptions, options::Graphics, options::Preset, options::Scene,
    options::ShootOptions, options::StadiumOptions, options::UnknownPreset, path::PathStep,
    path::camera_path, play::Side, props::Mover, render::RenderedFrame, render::SeenMover,
    stadium::Stadium,
};
