//! A click as an observation: a pixel that shows a landmark, or a point of a line.

use crate::camera::PtzCamera;
use crate::field::{FieldElement, FieldModel};
use crate::geometry::{ImagePoint, ImageSize, Vec2, Vec3};
use crate::solve::optimiser::residual::{Linearised, Residual};
use crate::solve::{ObservationError, ObservedShape};

/// One click, ready for solving: the pixel, its 1-σ, and the landmark or line that it shows with
/// its shape in `world`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The clicked pixel, px of the frame.
    pub image: ImagePoint,
    /// 1-σ of the click in each direction, px of the frame.
    pub sigma_px: f64,
    /// Which landmark or line of the field it shows; none where it shows something else, such as a
    /// feature of the stadium.
    pub element: Option<FieldElement>,
    /// The shape of it in `world`, m.
    pub shape: ObservedShape,
    /// Which of the frame's clicks this is, from 0.
    pub click: usize,
    /// Held out of the solve; its error is reported.
    pub check: bool,
}

impl Observation {
    /// A pixel that shows a point of `world`, m, which is no landmark of a field.
    pub const fn from_point(at: Vec3, image: ImagePoint, sigma_px: f64, click: usize) -> Self {
        Self {
            image,
            sigma_px,
            element: None,
            shape: ObservedShape::Point(at),
            click,
            check: false,
        }
    }

    /// A click on a landmark of the field, with the landmark's own click noise scaled to the frame.
    ///
    /// # Errors
    /// The field has no landmark of this name.
    pub fn from_landmark(
        field: &FieldModel,
        name: &str,
        image: ImagePoint,
        image_size: ImageSize,
        click: usize,
    ) -> Result<Self, ObservationError> {
        let landmark = field.landmark(name).zip(field.landmark_element(name));
        let observation = landmark.and_then(|(landmark, element)| {
            let sigma_px = landmark.click_sigma_px * image_size.scale_from_1920();
            Self::from_point(Vec3::zeros(), image, sigma_px, click).with_element(field, element)
        });
        observation.ok_or_else(|| ObservationError::UnknownLandmark {
            name: name.to_owned(),
            template: field.template.clone(),
        })
    }

    /// A click on a line of the field.
    ///
    /// # Errors
    /// The field has no line of this name.
    pub fn from_line(
        field: &FieldModel,
        name: &str,
        image: ImagePoint,
        image_size: ImageSize,
        click: usize,
    ) -> Result<Self, ObservationError> {
        let observation = field.line_element(name).and_then(|element| {
            let sigma_px = field.line_click_sigma_px * image_size.scale_from_1920();
            Self::from_point(Vec3::zeros(), image, sigma_px, click).with_element(field, element)
        });
        observation.ok_or_else(|| ObservationError::UnknownLine {
            name: name.to_owned(),
            template: field.template.clone(),
        })
    }

    /// A pixel at which the middle of a line's paint was measured; `place` is its index. None if
    /// the field has no such line.
    pub fn from_paint(
        field: &FieldModel,
        line: usize,
        image: ImagePoint,
        sigma_px: f64,
        place: usize,
    ) -> Option<Self> {
        Self::from_point(Vec3::zeros(), image, sigma_px, place)
            .with_element(field, FieldElement::Paint(line))
    }

    /// Whether it is a measurement of paint, not a click.
    pub const fn is_paint(&self) -> bool {
        matches!(self.element, Some(FieldElement::Paint(_)))
    }

    /// The same click under another name, or on another size of its field; its noise stays. None if
    /// the field has no such element.
    pub fn with_element(self, field: &FieldModel, element: FieldElement) -> Option<Self> {
        Some(Self {
            element: Some(element),
            shape: ObservedShape::from_element(field, element)?,
            ..self
        })
    }

    /// The same click on the same field with another crown.
    #[must_use]
    pub(in crate::solve) fn change_crown(&self, from: &FieldModel, to: &FieldModel) -> Self {
        Self {
            shape: self.shape.change_crown(from.crown(), to.crown()),
            ..*self
        }
    }

    /// The same click, held out of the solve.
    #[must_use]
    pub const fn hold_out(self) -> Self {
        Self {
            check: true,
            ..self
        }
    }

    /// How many equations it gives.
    pub const fn equations(&self) -> usize {
        self.shape.equations()
    }

    /// Its distance from the image of its shape, px; none where that has no image.
    pub fn distance_px(&self, camera: &PtzCamera) -> Option<f64> {
        self.shape
            .residual_px(camera, self.image)
            .map(|residual| residual.norm())
    }

    /// The same distance, infinite where there is no image, so that a camera gains nothing by
    /// hiding what was clicked.
    pub(in crate::solve) fn distance_px_or_infinite(&self, camera: &PtzCamera) -> f64 {
        self.distance_px(camera).unwrap_or(f64::INFINITY)
    }

    /// Its distance from the image of its shape, in its own 1-σ; infinite where there is no image.
    pub fn distance_sigmas(&self, camera: &PtzCamera) -> f64 {
        self.distance_px(camera)
            .map_or(f64::INFINITY, |px| px / self.sigma_px)
    }
}

/// The observations of landmarks among others, in their order.
pub(in crate::solve) fn landmark_observations(
    observations: &[Observation],
) -> impl Iterator<Item = &Observation> {
    observations
        .iter()
        .filter(|observation| observation.shape.point().is_some())
}

/// A click in a frame of a known base.
impl Residual<2, 0, 3> for Observation {
    type State = PtzCamera;

    #[inline]
    fn sigma(&self) -> f64 {
        self.sigma_px
    }

    #[inline]
    fn value(&self, camera: &PtzCamera) -> Option<Vec2> {
        self.shape.residual_px(camera, self.image)
    }

    #[inline]
    fn linearise(&self, camera: &PtzCamera) -> Option<Linearised<2, 0, 3>> {
        // The third parameter of a fit is log f: d/d(log f) = f d/df.
        let (value, mut by_own) = self.shape.residual_by_ptz(camera, self.image)?;
        by_own.column_mut(2).scale_mut(camera.ptz().focal_px);
        Some(Linearised::without_shared(value, by_own))
    }
}
