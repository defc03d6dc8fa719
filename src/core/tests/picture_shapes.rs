//! Pictures of other proportions than 16:9 are judged as strictly as these.

use rand::RngExt;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Vec2};
use touchline_core::solve::{Observation, SolveContext, WarningCode, solve_frame};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{base_at, soccer};

const WHOLE: ImageSize = ImageSize::new(1920, 1080);

/// The share of frames, in per cent, in which clicks with just their stated noise contradict each
/// other, in pictures of a size that are cut from the middle of larger ones.
fn contradictions_percent(size: ImageSize) -> f64 {
    const FRAMES: usize = 150;
    let mut rng = seeded::rng("contradictions_percent");
    let field = soccer();
    let base = base_at([2.0, -66.0, 19.0], size);
    let (mut frames, mut contradicted) = (0, 0);
    while frames < FRAMES {
        let ptz = Ptz::from_degrees(
            rng.random_range(-33.0..33.0),
            rng.random_range(-16.0..-11.0),
            rng.random_range(1200.0..2200.0),
        );
        let camera = PtzCamera::new(base, ptz);
        let mut clicks = Vec::new();
        for landmark in &field.landmarks {
            let Ok(exact) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            // The noise is that of the whole picture, whatever was cut off.
            let noise_px = landmark.click_sigma_px;
            let image = exact.translate(Vec2::new(normal(&mut rng), normal(&mut rng)) * noise_px);
            if size.contains(image) {
                let (id, click) = (landmark.id.as_str(), clicks.len());
                clicks.push(Observation::from_landmark(&field, id, image, size, click).unwrap());
            }
        }
        if clicks.len() < 4 {
            continue;
        }
        frames += 1;
        let solved = solve_frame(&base, &clicks, &SolveContext::new(size)).unwrap();
        let mut codes = solved.warnings.iter().map(|warning| warning.code);
        contradicted += usize::from(codes.any(|code| code == WarningCode::Contradiction));
    }
    100.0 * f64::from(contradicted as u32) / FRAMES as f64
}

#[test]
fn clicks_of_the_stated_noise_agree_in_pictures_of_every_proportion() {
    for size in [
        WHOLE,
        ImageSize::new(1440, 1080),
        ImageSize::new(1080, 1080),
        ImageSize::new(608, 1080),
    ] {
        let percent = contradictions_percent(size);
        assert!(percent <= 2.0, "{percent:.1} % at {size:?}");
    }
}
