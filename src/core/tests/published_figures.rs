//! Figures that the method's papers and programs are known by, and the authors' own formulas for
//! comparison; none of these formulas is used in the library.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{PanTilt, PtzCamera};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
use touchline_core::solve::{Observation, SolveContext, focal_from_two_rays, solve_frame};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{TestBase, base_at};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn camera(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
    let position = Vec3::new(0.0, -60.0, 18.0);
    base_at(position, SIZE).aim(pan_deg, tilt_deg, focal_px)
}

/// The paper's eq. (2), its y turned to our sign: pan and tilt of a ray act on x and y separately.
fn separable_image_from_ray(camera: &PtzCamera, ray: PanTilt) -> ImagePoint {
    let ptz = camera.ptz();
    let x = ptz.focal_px * (ray.pan - ptz.pan).radians().tan();
    let y = -ptz.focal_px * (ray.tilt - ptz.tilt).radians().tan();
    camera.base().principal_point.translate(Vec2::new(x, y))
}

/// The focal length of the authors' released program: the quadratic of appendix 6.1 with d =
/// cosΔpan · cosΔtilt in the place of the cosine between the rays; of two roots the one nearer to
/// the truth.
fn authors_focal_px(pixels: [Vec2; 2], rays: [PanTilt; 2], truth_px: f64) -> Option<f64> {
    let [a, b, c] = [
        pixels[0].norm_squared(),
        pixels[1].norm_squared(),
        pixels[0].dot(&pixels[1]),
    ];
    let d =
        (rays[0].pan - rays[1].pan).radians().cos() * (rays[0].tilt - rays[1].tilt).radians().cos();
    let d2 = d * d;
    let (q2, q1, q0) = (1.0 - d2, 2.0 * c - d2 * (a + b), c * c - d2 * a * b);
    let root = (q1 * q1 - 4.0 * q2 * q0).sqrt();
    [(-q1 + root) / (2.0 * q2), (-q1 - root) / (2.0 * q2)]
        .into_iter()
        .filter(|s| *s > 0.0)
        .map(f64::sqrt)
        .min_by(|a, b| (a - truth_px).abs().total_cmp(&(b - truth_px).abs()))
}

fn random_pixel(rng: &mut Pcg64Mcg) -> ImagePoint {
    ImagePoint::new(
        rng.random_range(0.0..f64::from(SIZE.width)),
        rng.random_range(0.0..f64::from(SIZE.height)),
    )
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(share * (values.len() - 1) as f64).round() as usize]
}

#[test]
fn the_separable_model_is_off_by_30_px_and_132_px_inside_the_frame() {
    for (tilt_deg, focal_px, published_px) in [(-5.0, 1919.0, 30.0), (-20.0, 1500.0, 132.0)] {
        let camera = camera(0.0, tilt_deg, focal_px);
        let mut worst_px = 0.0f64;
        for x in (0..=1280).step_by(16) {
            for y in (0..=720).step_by(16) {
                let pixel = ImagePoint::new(f64::from(x), f64::from(y));
                let ray = camera.ray_from_image(pixel).unwrap();
                worst_px = worst_px.max(separable_image_from_ray(&camera, ray).distance_px(pixel));
            }
        }
        assert!(
            (worst_px - published_px).abs() < 1.0,
            "tilt {tilt_deg}: {worst_px:.1} px, published {published_px}"
        );
    }
}

#[test]
fn the_authors_focal_length_is_biased_without_noise_and_ours_is_not() {
    let mut rng = seeded::rng("the_authors_focal_length_is_biased_without_noise_and_ours_is_not");
    let camera = camera(0.5, -11.4, 1919.0);
    let truth_px = camera.ptz().focal_px;
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    while ours.len() < 20_000 {
        let pixels = [random_pixel(&mut rng), random_pixel(&mut rng)];
        if pixels[0].distance_px(pixels[1]) < 200.0 {
            continue;
        }
        let rays = pixels.map(|pixel| camera.ray_from_image(pixel).unwrap());
        let offsets = pixels.map(|pixel| pixel.offset_from(SIZE.centre()));
        theirs.push(
            authors_focal_px(offsets, rays, truth_px)
                .map_or(truth_px, |focal| (focal - truth_px).abs()),
        );
        let roots = focal_from_two_rays(offsets, rays.map(PanTilt::direction)).unwrap();
        ours.push(
            roots
                .iter()
                .map(|focal| (focal - truth_px).abs())
                .fold(f64::INFINITY, f64::min),
        );
    }
    let (median, high) = (quantile(&mut theirs, 0.5), quantile(&mut theirs, 0.95));
    assert!(
        (median - 15.0).abs() < 1.0 && (high - 93.0).abs() < 4.0,
        "authors: {median:.1} px, 95 % {high:.1} px"
    );
    assert!(
        quantile(&mut ours, 0.5) < 1e-9 && quantile(&mut ours, 1.0) < 1e-5,
        "ours: {}",
        quantile(&mut ours, 1.0)
    );
}

/// Median and 95 % of the error at the worst corner of the frame (the largest of the four), over
/// directions of the pair and click noise.
#[test]
fn what_the_separation_of_two_clicks_is_worth() {
    let mut rng = seeded::rng("what_the_separation_of_two_clicks_is_worth");
    let truth = camera(0.0, -10.0, 3000.0);
    let context = SolveContext::new(SIZE);
    let far_behind = |pixel: ImagePoint| {
        truth.base().position_m + truth.world_direction_from_image(pixel).unwrap() * 60.0
    };
    let corners = SIZE.corners().map(|corner| (corner, far_behind(corner)));
    for (separation_px, median_px, high_px) in
        [(50.0, 15.0, 41.0), (200.0, 4.4, 11.0), (800.0, 1.8, 3.6)]
    {
        let mut errors: Vec<f64> = (0..4000)
            .map(|_| {
                let half = loop {
                    let angle = rng.random_range(0.0..std::f64::consts::TAU);
                    let half = Vec2::new(angle.cos(), angle.sin()) * (0.5 * separation_px);
                    if SIZE.contains(SIZE.centre().translate(half)) {
                        break half;
                    }
                };
                let clicks = [half, -half].map(|half| {
                    let exact = SIZE.centre().translate(half);
                    let noise = Vec2::new(normal(&mut rng), normal(&mut rng));
                    let inside = |x: f64, upto: u32| x.clamp(0.0, f64::from(upto));
                    let image = exact.translate(noise);
                    let image =
                        ImagePoint::new(inside(image.x, SIZE.width), inside(image.y, SIZE.height));
                    Observation::from_point(far_behind(exact), image, 1.0, 0)
                });
                let solution = solve_frame(truth.base(), &clicks, &context).unwrap();
                let solved = PtzCamera::new(*truth.base(), solution.ptz);
                let error = |(corner, at): (ImagePoint, Vec3)| {
                    solved.image_from_world(at).unwrap().distance_px(corner)
                };
                corners.map(error).into_iter().fold(0.0, f64::max)
            })
            .collect();
        let (median, high) = (quantile(&mut errors, 0.5), quantile(&mut errors, 0.95));
        assert!(
            (median / median_px - 1.0).abs() < 0.15 && (high / high_px - 1.0).abs() < 0.15,
            "{separation_px} px apart: {median:.2} / {high:.2} px, published {median_px} / {high_px}"
        );
    }
}
