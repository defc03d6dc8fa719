//! Pan, tilt and focal length of a frame from two clicks.
//!
//! ```sh
//! cargo run --example two_clicks
//! ```

use std::error::Error;
use touchline::camera::{BaseAngles, CameraBase};
use touchline::field::builtin;
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::solve::{Observation, SolveContext, solve_frame};

fn main() -> Result<(), Box<dyn Error>> {
    // A camera 62 m beside the pitch, 17 m up, that looks across it at pan 0.
    let size = ImageSize::new(1920, 1080);
    let base = CameraBase::new(
        Vec3::new(0.0, -62.0, 17.0),
        BaseAngles::default().base_from_world(),
        size.centre(),
    );

    let field = builtin("soccer")?.default_model()?;
    let clicks = [
        Observation::from_landmark(
            &field,
            "centre_mark",
            ImagePoint::new(479.1, 672.1),
            size,
            0,
        )?,
        Observation::from_landmark(
            &field,
            "corner_far_right",
            ImagePoint::new(1477.7, 439.5),
            size,
            1,
        )?,
    ];
    let solved = solve_frame(&base, &clicks, &SolveContext::new(size))?;

    println!(
        "pan {:.2}, tilt {:.2}, focal length {:.0} px",
        solved.ptz.pan, solved.ptz.tilt, solved.ptz.focal_px
    );
    for warning in &solved.warnings {
        println!("{}: {}", warning.code, warning.message);
    }
    Ok(())
}
