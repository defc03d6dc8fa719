//! Tests that need a part which not every machine has: a graphics adapter, real frames, ffmpeg.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test says what failed by failing"
)]

mod bad_videos;
mod cameras_of_videos;
mod drawn_broadcast;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/headless.rs"]
mod headless;
mod media;
mod motion_330;
mod mutated_originals;
mod originals;
mod overlay_pixels;
mod overlay_projection;
mod parts;
#[allow(dead_code, reason = "shared by several crates")]
#[path = "../shared/program.rs"]
mod program;
mod real_base;
mod real_base_in_app;
mod real_cameras;
mod real_clicks;
mod real_courts;
mod real_exchange;
mod real_frames;
mod real_paint;
mod real_trust;
mod real_video;
mod real_wood;
mod render_command;
mod season_of_videos;
#[cfg(feature = "gui")]
#[path = "../window/mod.rs"]
mod window;

use std::process::ExitCode;

fn main() -> ExitCode {
    let modules: &[&[parts::Test]] = &[
        bad_videos::TESTS,
        cameras_of_videos::TESTS,
        drawn_broadcast::TESTS,
        media::TESTS,
        motion_330::TESTS,
        mutated_originals::TESTS,
        originals::TESTS,
        overlay_pixels::TESTS,
        overlay_projection::TESTS,
        real_base::TESTS,
        real_base_in_app::TESTS,
        real_cameras::TESTS,
        real_clicks::TESTS,
        real_exchange::TESTS,
        real_frames::TESTS,
        real_paint::TESTS,
        real_trust::TESTS,
        #[cfg(feature = "opencv")]
        real_video::TESTS,
        #[cfg(feature = "opencv")]
        real_courts::TESTS,
        #[cfg(feature = "opencv")]
        real_wood::TESTS,
        render_command::TESTS,
        #[cfg(feature = "opencv")]
        season_of_videos::TESTS,
    ];
    #[cfg(feature = "gui")]
    let modules = &[modules, window::TESTS].concat();
    parts::run(modules)
}
