//! The stated σ of a field's fitted length and width, against how far off they are.

use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, Template, builtin};
use touchline_core::geometry::{ImageSize, Vec2, Vec3};
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, CameraClicks, CrownModel, FittedSize, FrameClicks, LensModel,
    SizeParam, SizeStart, adjust_base, fit_field_size, usual_displacement_m,
};
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

/// The fitted lengths of a venue with its true ones.
fn fit(name: &str, along: (&[f64], f64), rng: &mut Pcg64Mcg) -> Vec<(FittedSize, f64, f64)> {
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
    let start = adjust_base(&clicks, &views.base, &ptz, &MODEL, &options);
    let start = SizeStart {
        field: &assumed,
        frames: &frames,
        base: &start.base,
        ptz: &start.ptz,
        model: &MODEL,
        image_size: IMAGE,
        options: &options,
    };
    let sized = |values_m: &[f64]| resize(template, &params, values_m);
    let fitted = fit_field_size(&sized, &params, &start).unwrap();
    let known = true_m.into_iter().zip(&params);
    let fitted = fitted.into_iter().zip(known);
    fitted
        .map(|(size, (true_m, param))| (size, true_m, param.sigma_m))
        .collect()
}

/// The root mean square of the lengths' errors over their σ, for one name.
fn rms_z(of: &[(FittedSize, f64, f64)], name: &str) -> f64 {
    let squares: Vec<f64> = of
        .iter()
        .filter(|(size, _, _)| size.name == name)
        .map(|(size, true_m, _)| ((size.value_m - true_m) / size.sigma_m).powi(2))
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
