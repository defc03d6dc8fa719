//! What a drag with the pointer moves: a click, a drawn line, a mask, or the picture.

use egui::{PointerButton, Pos2};
use touchline_core::geometry::{ImagePoint, PixelBox};

/// What the pointer holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DragTarget {
    /// Nothing.
    #[default]
    Nothing,
    /// A click of the frame, existing or new.
    Click {
        /// Where the click is, px of the picture. It keeps its offset from the pointer.
        at: ImagePoint,
        /// Where the pointer went down.
        pressed: Pos2,
        /// Whether the pointer has moved far enough for a drag.
        moving: bool,
    },
    /// The picture, by this button.
    Picture(PointerButton),
    /// A mask that is being drawn.
    Mask {
        /// The corner where it began, px of the picture.
        from: ImagePoint,
        /// The corner under the pointer, px of the picture.
        to: ImagePoint,
        /// Whether the mask is for every frame of the camera.
        of_camera: bool,
    },
}

impl DragTarget {
    /// The mask that is being drawn, and whether it is for every frame of the camera.
    pub fn mask(&self) -> Option<(bool, PixelBox)> {
        let Self::Mask {
            from,
            to,
            of_camera,
        } = self
        else {
            return None;
        };
        // The corners may have been drawn in any direction; a box has its upper left corner and
        // positive sides.
        let (x, y) = (from.x.min(to.x), from.y.min(to.y));
        Some((
            *of_camera,
            PixelBox {
                x,
                y,
                width: (from.x - to.x).abs(),
                height: (from.y - to.y).abs(),
            },
        ))
    }
}
