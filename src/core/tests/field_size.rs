//! The stated σ of a field's fitted length and width, against how far off they are.

use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, Template, builtin};
use touchline_core::geometry::{ImageSize, Vec2, Vec3};
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, CameraClicks, CrownModel, FittedSize, FrameClicks, LensModel,
    SizeParam, SizeStart, adjust_base, fit_field_size, usual_displacement_m,
};
use touchline_core::solve::{Observation, Uncertainty};
use touchline_core::testing::base_at;
use touchline_core::testing::seeded::{self, normal};

const IMAGE: ImageSize = ImageSize::new(1920, 1080);

/// The fields of which the rules leave the length open.
const FIELDS: [&str; 8] = [
    "soccer",
    "futsal",
    "handball",
    "ice_hockey_iihf",
    "ice_hockey_nhl",
    "basketball_fiba",
    "basketball_nba",
    "basketball_ncaa",
];

const MODEL: BaseModel = BaseModel {
    lens: LensModel::Pinhole,
    crown: CrownModel::Fixed(0.0),
    principal_point: None,
};

/// The lengths for which the rules of a template give a range, with a quarter of it as prior.
fn open_lengths(template: &Template) -> Vec<SizeParam> {
    let open = template
        .params
        .iter()
        .filter(|param| ["length_m", "width_m"].contains(&param.name.as_str()))
        .filter(|param| param.min < param.max);
    open.map(|param| SizeParam {
        name: param.name.clone(),
        assumed_m: param.default,
        usual_m: param.default,
        sigma_m: (param.max - param.min) / 4.0,
        min_m: param.min,
        max_m: param.max,
    })
    .collect()
}

/// The field with some of its lengths changed.
fn resize(template: &Template, params: &[SizeParam], values_m: &[f64]) -> Option<FieldModel> {
    let mut sizes: BTreeMap<String, f64> = template.default_params();
    sizes.extend(params.iter().zip(values_m).map(|(param, value_m)| {
        let value_m = value_m.clamp(param.min_m, param.max_m);
        (param.name.clone(), value_m)
    }));
    template.model(&sizes, 0.0).ok()
}

/// A size of venues, within the rules.
fn venue(param: &SizeParam, rng: &mut Pcg64Mcg) -> f64 {
    std::iter::repeat_with(|| param.usual_m + param.sigma_m * normal(rng))
        .find(|value_m| (param.min_m..=param.max_m).contains(value_m))
        .unwrap()
}

/// The frames of a camera beside the middle of a field that look at these shares of its half length.
struct Views<'a> {
    truth: &'a FieldModel,
    base: CameraBase,
    ptz: Vec<Ptz>,
    displaced_m: Vec<Vec3>,
}

impl<'a> Views<'a> {
    fn new(truth: &'a FieldModel, (along, focal_px): (&[f64], f64), rng: &mut Pcg64Mcg) -> Self {
        let (length_m, width_m) = (truth.length_m, truth.width_m);
        let position_m = Vec3::new(
            -0.05 * length_m,
            -0.5 * width_m - 0.3 * length_m,
            0.17 * length_m,
        );
        let base = base_at(position_m, IMAGE);
        let look = |along: &f64| {
            let to = Vec3::new(0.5 * along * length_m, 0.0, 0.0) - position_m;
            let tilt = -to.z.atan2(to.xy().norm()).abs();
            Ptz::from_degrees(to.x.atan2(to.y).to_degrees(), tilt.to_degrees(), focal_px)
        };
        // Landmarks are painted off their places, in the same way in every frame.
        let sigma_m = usual_displacement_m(width_m);
        let displace = |_| Vec3::new(normal(rng), normal(rng), 0.0) * sigma_m;
        Self {
            truth,
            base,
            ptz: along.iter().map(look).collect(),
            displaced_m: (0..truth.landmarks.len()).map(displace).collect(),
        }
    }

    /// The clicks in each frame, as clicks on a field of the assumed size.
    fn clicks(&self, assumed: &FieldModel, rng: &mut Pcg64Mcg) -> Vec<FrameClicks> {
        let frames = self.ptz.iter().map(|ptz| {
            let camera = PtzCamera::new(self.base, *ptz);
            let mut seen = Vec::new();
            for (landmark, displaced_m) in self.truth.landmarks.iter().zip(&self.displaced_m) {
                let at_m = self.truth.landmark_in_world(landmark) + displaced_m;
                let exact = camera.image_from_world(at_m);
                let Some(exact) = exact.ok().filter(|_| landmark.nominal_m.z == 0.0) else {
                    continue;
                };
                let id = landmark.id.as_str();
                let click = Observation::from_landmark(assumed, id, exact, IMAGE, seen.len());
                let click = click.unwrap();
                let off_px = Vec2::new(normal(rng), normal(rng)) * click.sigma_px;
                let image = exact.translate(off_px);
                if IMAGE.contains(image) {
                    seen.push(Observation { image, ..click });
                }
            }
            FrameClicks {
                observations: seen,
                start: None,
            }
        });
        frames.collect()
    }
}

/// A venue, and what was fitted to clicks of it as of the usual field.
struct Fitted {
    truth: FieldModel,
    assumed: FieldModel,
    params: Vec<SizeParam>,
    true_m: Vec<f64>,
    camera: CameraBase,
    true_ptz: Vec<Ptz>,
    frames: Vec<FrameClicks>,
    /// The base on the assumed field, with what is open of its size, and its frames.
    base: CameraBase,
    ptz: Vec<Ptz>,
    sizes: Vec<FittedSize>,
}

fn fit_venue(name: &str, along: (&[f64], f64), rng: &mut Pcg64Mcg) -> Fitted {
    let template = builtin(name).unwrap();
    let params = open_lengths(template);
    let true_m: Vec<f64> = params.iter().map(|param| venue(param, rng)).collect();
    let truth = resize(template, &params, &true_m).unwrap();
    let assumed = template.model(&template.default_params(), 0.0).unwrap();
    let views = Views::new(&truth, along, rng);
    let frames = views.clicks(&assumed, rng);
    let options = AdjustOptions::default();
    let clicks = CameraClicks::with_centred_principal_point(&assumed, &frames, IMAGE);
    let ptz: Vec<Option<Ptz>> = views.ptz.iter().copied().map(Some).collect();
    let adjusted = adjust_base(&clicks, &views.base, &ptz, &MODEL, &options);
    let start = SizeStart {
        field: &assumed,
        frames: &frames,
        base: &adjusted.base,
        ptz: &adjusted.ptz,
        model: &MODEL,
        image_size: IMAGE,
        options: &options,
    };
    let sized = |values_m: &[f64]| resize(template, &params, values_m);
    let sizes = fit_field_size(&sized, &params, &start).unwrap();
    // The base again on the field as fitted; what is open of it stays as assumed.
    let stated_m = sizes.iter().map(|size| {
        if size.is_open {
            size.assumed_m
        } else {
            size.value_m
        }
    });
    let assumed = sized(&stated_m.collect::<Vec<_>>()).unwrap();
    let element = |click: Observation| click.with_element(&assumed, click.element?);
    let frames: Vec<FrameClicks> = frames
        .iter()
        .map(|frame| FrameClicks {
            observations: frame
                .observations
                .iter()
                .filter_map(|it| element(*it))
                .collect(),
            start: None,
        })
        .collect();
    let clicks = CameraClicks::with_centred_principal_point(&assumed, &frames, IMAGE);
    let adjusted = adjust_base(&clicks, &adjusted.base, &adjusted.ptz, &MODEL, &options);
    let mut base = adjusted.base;
    for size in &sizes {
        base.sigma.size[size.axis()] = size.error;
    }
    let (camera, true_ptz) = (views.base, views.ptz);
    Fitted {
        ptz: adjusted.ptz.into_iter().map(Option::unwrap).collect(),
        truth,
        assumed,
        params,
        true_m,
        camera,
        true_ptz,
        frames,
        base,
        sizes,
    }
}

/// The fitted lengths of a venue with its true ones and the σ of the rules.
fn fit(name: &str, along: (&[f64], f64), rng: &mut Pcg64Mcg) -> Vec<(FittedSize, f64, f64)> {
    let venue = fit_venue(name, along, rng);
    let known = venue.true_m.into_iter().zip(&venue.params);
    let fitted = venue.sizes.into_iter().zip(known);
    fitted
        .map(|(size, (true_m, param))| (size, true_m, param.sigma_m))
        .collect()
}

/// The root mean square of the lengths' errors over their σ, for one name.
fn rms_z(of: &[(FittedSize, f64, f64)], name: &str) -> f64 {
    let squares: Vec<f64> = of
        .iter()
        .filter(|(size, _, _)| size.name == name)
        .map(|(size, true_m, _)| ((size.value_m - true_m) / size.error.sigma_m).powi(2))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn fitted_lengths_are_as_far_off_as_they_say() {
    let mut rng = seeded::rng("fitted_lengths_are_as_far_off_as_they_say");
    let both_ends = (
        &[-0.8, -0.55, -0.3, -0.05, 0.2, 0.45, 0.7, 0.85][..],
        2200.0,
    );
    let one_end = (&[0.8, 0.84, 0.88, 0.92, 0.96, 1.0][..], 4500.0);
    let (mut both, mut one) = (Vec::new(), Vec::new());
    for name in FIELDS {
        let (mut of_both, mut of_one) = (Vec::new(), Vec::new());
        for _ in 0..12 {
            of_both.extend(fit(name, both_ends, &mut rng));
            of_one.extend(fit(name, one_end, &mut rng));
        }
        println!(
            "{name}: both ends {:.2}, one end {:.2}",
            rms_z(&of_both, "length_m"),
            rms_z(&of_one, "length_m")
        );
        both.extend(of_both);
        one.extend(of_one);
    }
    for (what, lengths) in [("both ends", &both), ("one end", &one)] {
        let z = rms_z(lengths, "length_m");
        assert!((0.8..1.25).contains(&z), "{what}: {z:.2}");
    }
    let is_open = |(size, _, _): &&(FittedSize, f64, f64)| size.is_open && size.name == "length_m";
    let lengths = |of: &[(FittedSize, f64, f64)]| {
        of.iter()
            .filter(|(size, _, _)| size.name == "length_m")
            .count()
    };
    assert_eq!(both.iter().filter(is_open).count(), 0, "both ends show it");
    let open = one.iter().filter(is_open).count();
    assert!(open as f64 > 0.9 * lengths(&one) as f64, "{open}");
}

/// How far landmarks are drawn from where the picture shows them, in σ of the overlay: with what is
/// open of the size, and with the size taken for known.
fn z_of_landmarks(venue: &Fitted, is_looked_at: impl Fn(&Vec3) -> bool) -> Vec<[f64; 2]> {
    let frame = venue.frames.len() / 2;
    let mut of_known_size = venue.base;
    of_known_size.sigma.size = Default::default();
    let drawn = [venue.base, of_known_size].map(|base| PtzCamera::new(base, venue.ptz[frame]));
    let known = drawn.map(|drawn| {
        let clicks = &venue.frames[frame].observations;
        Uncertainty::from_observations(&drawn, clicks, None).unwrap()
    });
    let truth = PtzCamera::new(venue.camera, venue.true_ptz[frame]);
    let landmarks = venue.assumed.landmarks.iter().zip(&venue.truth.landmarks);
    landmarks
        .filter(|(landmark, _)| landmark.nominal_m.z == 0.0 && is_looked_at(&landmark.nominal_m))
        .filter_map(|(landmark, real)| {
            let real = truth.image_from_world(venue.truth.landmark_in_world(real));
            let at_m = venue.assumed.landmark_in_world(landmark);
            let off = drawn[0]
                .image_from_world(at_m)
                .ok()?
                .offset_from(real.ok()?);
            let z = |which: usize| {
                let covariance = known[which].overlay_at_world(&drawn[which], at_m)?;
                Some(off.norm() / covariance.trace().sqrt())
            };
            Some([z(0)?, z(1)?])
        })
        .collect()
}

/// The ends of a pitch that is clicked around its middle alone.
#[test]
fn lines_that_no_frame_shows_are_off_by_no_more_than_is_stated() {
    let mut rng = seeded::rng("lines_that_no_frame_shows_are_off_by_no_more_than_is_stated");
    let (mut seen, mut unseen) = (Vec::new(), Vec::new());
    for _ in 0..40 {
        let middle = (&[-0.1, -0.05, 0.0, 0.05, 0.1][..], 3000.0);
        let venue = fit_venue("soccer", middle, &mut rng);
        seen.extend(z_of_landmarks(&venue, |at| at.xy().norm() < 10.0));
        unseen.extend(z_of_landmarks(&venue, |at| {
            at.x.abs() > 31.0 && at.y.abs() < 21.0
        }));
    }
    let rms = |of: &[[f64; 2]], which: usize| {
        let squares: f64 = of.iter().map(|z| z[which].powi(2)).sum();
        (squares / of.len() as f64).sqrt()
    };
    let (seen, ends, of_known_size) = (rms(&seen, 0), rms(&unseen, 0), rms(&unseen, 1));
    println!("middle {seen:.2}, ends {ends:.2}, ends of a known size {of_known_size:.2}");
    assert!((0.8..1.25).contains(&seen), "{seen:.2}");
    // The base of such narrow views is known less badly than it says.
    assert!((0.4..1.25).contains(&ends), "{ends:.2}");
    assert!(of_known_size > 1.4, "{of_known_size:.2}");
}
