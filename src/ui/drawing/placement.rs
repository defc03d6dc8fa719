//! Where a picture is on the screen: conversion between px of the picture, points and physical px
//! of the screen.
//!
//! With offset o (physical px), scale s (physical px per px) and density d (physical px per point):
//! point = corner + (px · s + o) / d. Positions in the picture count from its upper left corner.

use super::canvas;
use egui::{Pos2, Rect, pos2};
use touchline_application::app::MAX_SCALE;
use touchline_application::app::session::PictureView;
use touchline_application::render::View;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};

/// A picture in a rectangle of the window. Scales are physical px of the screen per px of the
/// picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The rectangle, points.
    pub rect: Rect,
    /// Size of the picture, px.
    pub image_size: ImageSize,
    /// The scale at which the picture is shown.
    pub scale: f64,
    /// The scale at which all of the picture just fits.
    pub fit_scale: f64,
    pixels_per_point: f32,
    /// The point of the picture in the middle of the rectangle, apart from the rounding of
    /// `offset_px`.
    centre: ImagePoint,
    /// The picture's corner relative to the rectangle's corner, physical px. Whole numbers, so that
    /// at 100 % the pixels of picture and screen coincide.
    offset_px: [f64; 2],
}

impl Placement {
    /// Places a picture in a rectangle. A view below the fitting scale becomes the fitted view.
    pub fn new(
        rect: Rect,
        pixels_per_point: f32,
        image_size: ImageSize,
        view: PictureView,
    ) -> Self {
        // An empty rectangle or picture counts as one pixel, so that no scale is zero or infinite.
        let size_px = canvas::size_px(rect, pixels_per_point).map(|side| f64::from(side.max(1)));
        let image_px = [image_size.width, image_size.height].map(|side| f64::from(side.max(1)));
        let fit_scale = (size_px[0] / image_px[0]).min(size_px[1] / image_px[1]);
        // A stored view may belong to a smaller window, in which its scale was above the fitting
        // one.
        let (scale, centre) = match view {
            PictureView::Zoomed { scale, centre } if scale > fit_scale => {
                (scale, within(centre, image_size))
            }
            _ => (fit_scale, image_size.centre()),
        };
        // Rounded to whole physical pixels.
        let offset_px = [
            size_px[0] / 2.0 - centre.x * scale,
            size_px[1] / 2.0 - centre.y * scale,
        ]
        .map(f64::round);
        Self {
            rect,
            image_size,
            scale,
            fit_scale,
            pixels_per_point,
            centre,
            offset_px,
        }
    }

    /// The same rectangle with another view of the picture.
    pub fn showing(&self, view: PictureView) -> Self {
        Self::new(self.rect, self.pixels_per_point, self.image_size, view)
    }

    /// Points of the screen per px of the picture.
    pub fn points_per_px(&self) -> f64 {
        self.scale / f64::from(self.pixels_per_point)
    }

    /// The point of the picture at a place on the screen; also outside the picture.
    pub fn image_from_screen(&self, at: Pos2) -> ImagePoint {
        let pixels_per_point = f64::from(self.pixels_per_point);
        let along = |screen: f32, corner: f32, offset: f64| {
            (f64::from(screen - corner) * pixels_per_point - offset) / self.scale
        };
        ImagePoint::new(
            along(at.x, self.rect.left(), self.offset_px[0]),
            along(at.y, self.rect.top(), self.offset_px[1]),
        )
    }

    /// The place on the screen of a point of the picture.
    pub fn screen_from_image(&self, at: ImagePoint) -> Pos2 {
        let pixels_per_point = f64::from(self.pixels_per_point);
        let along = |px: f64, corner: f32, offset: f64| {
            corner + ((px * self.scale + offset) / pixels_per_point) as f32
        };
        pos2(
            along(at.x, self.rect.left(), self.offset_px[0]),
            along(at.y, self.rect.top(), self.offset_px[1]),
        )
    }

    /// A vector on the screen, points, as a vector in the picture, px.
    pub fn image_from_screen_vector(&self, along: egui::Vec2) -> Vec2 {
        Vec2::new(f64::from(along.x), f64::from(along.y)) / self.points_per_px()
    }

    /// The placement in the form that the renderer takes.
    pub fn render_view(&self) -> View {
        View {
            scale: self.scale as f32,
            offset_px: self.offset_px.map(|px| px as f32),
            size_px: canvas::size_px(self.rect, self.pixels_per_point),
            pixels_per_point: self.pixels_per_point,
        }
    }

    /// The view after zooming by a factor. The point of the picture under `at` keeps its place on
    /// the screen.
    pub fn zoom_at(&self, factor: f64, at: Pos2) -> PictureView {
        // Written so that a scale that is not a number gives the fitted view as well.
        let scale = (self.scale * factor).min(MAX_SCALE);
        if !(scale > self.fit_scale) {
            return PictureView::Fit;
        }
        // The point under `at` stays, so its distance from the centre shrinks by the ratio of the
        // scales.
        let held = self.image_from_screen(at);
        let centre = held.translate(self.centre.offset_from(held) * (self.scale / scale));
        PictureView::Zoomed {
            scale,
            centre: within(centre, self.image_size),
        }
    }

    /// The view after moving the picture by a vector on the screen, points.
    pub fn pan_by(&self, along: egui::Vec2) -> PictureView {
        if self.scale <= self.fit_scale {
            return PictureView::Fit;
        }
        let centre = self.centre.translate(-self.image_from_screen_vector(along));
        PictureView::Zoomed {
            scale: self.scale,
            centre: within(centre, self.image_size),
        }
    }
}

/// The centre of a view, limited to the picture, so that the picture cannot leave the window.
fn within(centre: ImagePoint, image_size: ImageSize) -> ImagePoint {
    ImagePoint::new(
        centre.x.clamp(0.0, f64::from(image_size.width)),
        centre.y.clamp(0.0, f64::from(image_size.height)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;
    use touchline_core::testing::SIZE;

    fn placement(pixels_per_point: f32, view: PictureView) -> Placement {
        Placement::new(
            Rect::from_min_size(pos2(10.0, 24.0), vec2(980.0, 580.0)),
            pixels_per_point,
            SIZE,
            view,
        )
    }

    #[test]
    fn a_place_comes_back_at_any_zoom_and_density() {
        let zoomed = PictureView::Zoomed {
            scale: 7.3,
            centre: ImagePoint::new(1200.25, 33.7),
        };
        for pixels_per_point in [1.0, 1.25, 2.0] {
            for view in [PictureView::Fit, zoomed] {
                let placement = placement(pixels_per_point, view);
                let at = pos2(431.5, 300.25);
                let back = placement.screen_from_image(placement.image_from_screen(at));
                assert!(
                    back.distance(at) < 1e-3,
                    "{pixels_per_point} {view:?}: {back:?}"
                );
            }
        }
    }

    #[test]
    fn the_fitted_picture_fills_the_box_at_any_density() {
        for pixels_per_point in [1.0, 2.0] {
            let placement = placement(pixels_per_point, PictureView::Fit);
            assert!((placement.points_per_px() - 980.0 / 1920.0).abs() < 1e-9);
            assert_eq!(
                placement.render_view().size_px,
                [980, 580].map(|side| side * pixels_per_point as u32)
            );
        }
    }

    #[test]
    fn zooming_holds_the_picture_under_the_pointer() {
        let mut placement = placement(1.0, PictureView::Fit);
        let at = pos2(700.0, 400.0);
        let held = placement.image_from_screen(at);
        for _ in 0..12 {
            let view = placement.zoom_at(1.25, at);
            placement = Placement::new(placement.rect, 1.0, SIZE, view);
            let off = placement.image_from_screen(at).distance_px(held) * placement.scale;
            assert!(off < 9.0, "{off} screen px at {}", placement.scale);
        }
        assert_eq!(placement.zoom_at(1e-3, at), PictureView::Fit);
        assert!(
            matches!(placement.zoom_at(1e3, at), PictureView::Zoomed { scale, .. } if scale == MAX_SCALE)
        );
    }

    #[test]
    fn the_picture_cannot_be_lost() {
        let view = placement(
            1.0,
            PictureView::Zoomed {
                scale: 2.0,
                centre: SIZE.centre(),
            },
        );
        let PictureView::Zoomed { centre, .. } = view.pan_by(vec2(1e6, -1e6)) else {
            panic!("still enlarged")
        };
        assert_eq!(centre, ImagePoint::new(0.0, 1080.0));
        assert_eq!(
            placement(1.0, PictureView::Fit).pan_by(vec2(50.0, 0.0)),
            PictureView::Fit
        );
    }
}
