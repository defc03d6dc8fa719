//! The residual of a click in the bundle adjustment, as a function of the base, the crown and the
//! field's size.

use super::parameters::{CROWN, K1, PRINCIPAL_POINT, ROTATION, SIZE, SIZES, SLOPE, Shared};
use crate::camera::{Ptz, PtzCamera};
use crate::field::Crown;
use crate::geometry::{Vec2, Vec3};
use crate::solve::observations::shape::ShapeJacobian;
use crate::solve::optimiser::residual::{Linearised, Residual};
use crate::solve::{Observation, ObservedShape};
use nalgebra::SMatrix;

/// A click whose shape depends on the crown and the size of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::solve) struct BaseClick {
    /// The click, with its shape on flat ground.
    pub(super) flat: Observation,
    /// The shape on flat ground if one of the fitted lengths is one metre larger; none where that
    /// length is not fitted.
    larger: [Option<ObservedShape>; SIZES],
}

/// The parameters of one frame: the shared ones, and its camera.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct FrameView {
    shared: Shared,
    camera: PtzCamera,
}

impl FrameView {
    /// The frame with the given pan, tilt and focal length.
    pub fn new(shared: &Shared, ptz: Ptz) -> Self {
        Self {
            shared: *shared,
            camera: PtzCamera::new(shared.base, ptz),
        }
    }
}

impl BaseClick {
    /// A click on a field of known size; `crown` is the crown of the field on which the
    /// observation's shape lies.
    pub fn new(observation: &Observation, crown: Crown) -> Self {
        let shape = observation.shape.change_crown(crown, Crown::FLAT);
        Self {
            flat: Observation {
                shape,
                ..*observation
            },
            larger: [None; SIZES],
        }
    }

    /// The same click with a fitted length of the field: its shape becomes `larger` (on flat
    /// ground) when the length grows by `by_m`. The shape is linear in the length.
    pub fn growing(mut self, size: usize, larger: &ObservedShape, by_m: f64) -> Self {
        self.larger[size] = Some(
            self.flat
                .shape
                .move_along(&self.flat.shape, larger, 1.0 / by_m),
        );
        self
    }

    /// How many equations it gives.
    pub const fn equations(&self) -> usize {
        self.flat.equations()
    }

    /// Its squared distance from its shape, sigmas²; none where that has no image.
    pub fn squared_sigmas(&self, at: &FrameView) -> Option<f64> {
        let off_px = self
            .observation(&at.shared)
            .shape
            .residual_px(&at.camera, self.flat.image)?;
        Some(off_px.norm_squared() / (self.flat.sigma_px * self.flat.sigma_px))
    }

    /// The click, with its shape at the field's size and crown of the shared parameters.
    fn observation(&self, shared: &Shared) -> Observation {
        // The size moves the shape on flat ground; the crown lifts it afterwards, because it
        // depends on where the size has put it.
        let mut shape = self.flat.shape;
        for (larger, larger_m) in self.larger.iter().zip(shared.larger_m) {
            if let Some(larger) = larger {
                shape = shape.move_along(&self.flat.shape, larger, larger_m);
            }
        }
        Observation {
            shape: shape.change_crown(Crown::FLAT, shared.crown),
            ..self.flat
        }
    }

    /// The derivative of the point that a click was compared with by a length of the field, m/m.
    fn world_by_size(&self, shared: &Shared, size: usize, here: &ShapeJacobian) -> Vec3 {
        let Some(larger) = &self.larger[size] else {
            return Vec3::zeros();
        };
        let mut by = larger.nominal_at(here.parameter) - self.flat.shape.nominal_at(here.parameter);
        // On a crowned pitch the height of the point changes as well: it moves across the crown,
        // and the crown becomes wider.
        let [by_y, by_width] = shared
            .crown
            .drop_share_by_y_and_width(here.nearest_in_world.y);
        by.z -= shared.crown.height_m * (by_y * by.y + by_width * shared.width_by_size[size]);
        by
    }
}

impl<const SHARED: usize> Residual<2, SHARED, 3> for BaseClick {
    type State = FrameView;

    fn sigma(&self) -> f64 {
        self.flat.sigma_px
    }

    fn value(&self, at: &FrameView) -> Option<Vec2> {
        self.observation(&at.shared)
            .shape
            .residual_px(&at.camera, self.flat.image)
    }

    fn linearise(&self, at: &FrameView) -> Option<Linearised<2, SHARED, 3>> {
        let FrameView { shared, camera } = at;
        let here = self
            .observation(shared)
            .shape
            .jacobian(camera, self.flat.image)?;
        // k₁ = value + slope (f − f₀) / 1000, so the derivative by the slope is that by k₁ times (f
        // − f₀) / 1000.
        let focal_px = camera.ptz().focal_px;
        let kilo_px = (focal_px - shared.base.distortion.at_focal_px) / 1000.0;
        let mut by_shared = SMatrix::<f64, 2, SHARED>::zeros();
        by_shared
            .fixed_columns_mut::<5>(0)
            .copy_from(&here.by_base.fixed_columns::<5>(0));
        by_shared.set_column(K1, &here.by_k1);
        by_shared.set_column(SLOPE, &(here.by_k1 * kilo_px));
        // The crown's height c enters as z = −c · `drop_share(y)`.
        let drop = shared.crown.drop_share(here.nearest_in_world.y);
        by_shared.set_column(CROWN, &(here.by_world.column(2) * -drop));
        by_shared
            .fixed_columns_mut::<2>(PRINCIPAL_POINT)
            .copy_from(&here.by_image);
        for size in 0..SHARED.saturating_sub(SIZE) {
            by_shared.set_column(
                SIZE + size,
                &(here.by_world * self.world_by_size(shared, size, &here)),
            );
        }
        // By log f: f times the derivative by f.
        let mut by_own = here.by_ptz;
        by_own.column_mut(2).scale_mut(focal_px);
        Some(Linearised {
            value: here.value_px,
            by_shared,
            by_own,
        })
    }
}

/// The columns of the rotation follow those of the position, as in the Jacobian of a projection by
/// the base.
const _: () = assert!(ROTATION == 3 && K1 == 5);

#[cfg(test)]
mod tests {
    use super::super::parameters::{OF_BASE, OF_BASE_AND_SIZE};
    use super::*;
    use crate::camera::{CameraBase, FocalCurve};
    use crate::field::{FieldElement, FieldModel, builtin};
    use crate::geometry::ImagePoint;
    use crate::solve::refine;
    use crate::testing::check_derivatives;
    use crate::testing::turned_base;
    use nalgebra::SVector;
    use std::collections::BTreeMap;

    fn field(length_m: f64, width_m: f64) -> FieldModel {
        let size = BTreeMap::from([
            ("length_m".to_owned(), length_m),
            ("width_m".to_owned(), width_m),
        ]);
        builtin("soccer").unwrap().model(&size, 0.15).unwrap()
    }

    fn base() -> CameraBase {
        CameraBase {
            distortion: FocalCurve {
                at_focal_px: 2000.0,
                value: -0.05,
                per_1000_px: 0.2,
                k2_per_k1_squared: 1.5,
                ..FocalCurve::NONE
            },
            ..turned_base(
                [3.0, -62.0, 17.0],
                [0.0, -1.0, 0.7],
                ImagePoint::new(955.0, 543.0),
            )
        }
    }

    fn elements(field: &FieldModel) -> Vec<FieldElement> {
        let landmarks = [
            "centre_circle_halfway_far",
            "penalty_area_far_left_front",
            "post_far_left_top",
        ];
        let lines = [
            "halfway_line",
            "touchline_far",
            "penalty_area_left_front",
            "centre_circle",
            "penalty_arc_left",
        ];
        let landmarks = landmarks.map(|name| field.landmark_element(name).unwrap());
        landmarks
            .into_iter()
            .chain(lines.map(|name| field.line_element(name).unwrap()))
            .collect()
    }

    fn clicks() -> Vec<BaseClick> {
        let usual = field(105.0, 68.0);
        let larger = [field(105.2, 68.0), field(105.0, 68.2)];
        let click = |element: FieldElement| {
            let image = ImagePoint::new(620.0, 420.0);
            let at = Observation::from_point(Vec3::zeros(), image, 2.0, 0)
                .with_element(&usual, element)
                .unwrap();
            let click = BaseClick::new(&at, usual.crown());
            larger
                .iter()
                .enumerate()
                .fold(click, |click, (size, larger)| {
                    let shape = ObservedShape::from_element(larger, element).unwrap();
                    click.growing(size, &shape.change_crown(larger.crown(), Crown::FLAT), 0.2)
                })
        };
        elements(&usual).into_iter().map(click).collect()
    }

    #[test]
    fn a_click_changes_with_every_parameter_as_its_jacobian_says() {
        let shared = Shared {
            larger_m: [0.4, -0.3],
            width_by_size: [0.0, 1.0],
            ..Shared::new(
                &base(),
                Crown {
                    height_m: 0.15,
                    width_m: 67.7,
                },
            )
        };
        let ptz = Ptz::from_degrees(-14.0, -15.0, 1910.0);
        for click in clicks() {
            let what = format!("{:?}", click.flat.element);
            let stepped = |step: &SVector<f64, OF_BASE_AND_SIZE>, own: &Vec3| {
                FrameView::new(&shared.apply_step(step), refine::apply_step(&ptz, own))
            };
            check_derivatives::<2, OF_BASE_AND_SIZE, 3, _>(&click, stepped).expect(&what);
            let stepped = |step: &SVector<f64, OF_BASE>, own: &Vec3| {
                FrameView::new(&shared.apply_step(step), refine::apply_step(&ptz, own))
            };
            check_derivatives::<2, OF_BASE, 3, _>(&click, stepped).expect(&what);
        }
    }

    #[test]
    fn a_click_on_a_larger_field_shows_the_landmark_or_line_of_that_field() {
        let (usual, larger) = (field(105.0, 68.0), field(106.5, 66.0));
        let shared = Shared {
            larger_m: [1.5, -2.0],
            ..Shared::new(&base(), larger.crown())
        };
        for (click, element) in clicks().into_iter().zip(elements(&usual)) {
            let there = ObservedShape::from_element(&larger, element).unwrap();
            let there = there.change_crown(larger.crown(), Crown::FLAT);
            let moved = click
                .observation(&shared)
                .shape
                .change_crown(shared.crown, Crown::FLAT);
            for parameter in [0.0, 0.4, 1.0] {
                let off = (moved.nominal_at(parameter) - there.nominal_at(parameter)).norm();
                assert!(off < 1e-9, "{element:?}: {off}");
            }
        }
    }
}
