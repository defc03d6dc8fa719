//! Masks of a camera that count for a part of its frames, or that the program found itself.

use super::adapters;
use crate::document::{Extra, Frame};
use serde::{Deserialize, Serialize};
use touchline_core::geometry::PixelBox;

/// A box of a camera whose pixels give no features, for some of its frames or all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangedMask {
    /// The box, px.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 4]"))]
    #[serde(rename = "box_px", with = "adapters::pixel_box")]
    pub pixel_box: PixelBox,
    /// The first video frame that it covers, counted from 0; absent: from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<u64>,
    /// The last video frame that it covers, itself included; absent: to the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<u64>,
    /// Where it is from.
    pub source: MaskSource,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// Where a mask is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MaskSource {
    /// The program found a graphic that is burnt into the pictures.
    Found,
    /// A person drew it.
    ByHand,
}

impl RangedMask {
    /// Whether it covers a frame. A frame without a number in a video, an image, is always covered:
    /// what lies on some images of a camera may lie on all.
    pub fn covers(&self, frame: &Frame) -> bool {
        let Some(video) = &frame.video else {
            return true;
        };
        self.from.is_none_or(|from| from <= video.frame_index)
            && self.to.is_none_or(|to| video.frame_index <= to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, VideoFrame};
    use crate::testing::{new_frame, soccer_document};
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_range_covers_its_ends_and_every_image() {
        let size = ImageSize::new(1280, 720);
        let mask = |x| PixelBox {
            x,
            y: 0.0,
            width: 10.0,
            height: 10.0,
        };
        let ranged = |from, to| RangedMask {
            pixel_box: mask(3.0),
            from,
            to,
            source: MaskSource::Found,
            extra: Extra::new(),
        };
        let mut camera = Camera::new("main".into(), size);
        camera.masks.push(mask(1.0));
        camera.ranged_masks.push(ranged(Some(10), Some(20)));
        let mut frame = new_frame("1.jpg", size);
        frame.masks.push(mask(2.0));
        let mut document = soccer_document();
        document.cameras.push(camera.into());
        assert_eq!(document.masks_of(&frame), [mask(1.0), mask(3.0), mask(2.0)]);
        frame.image = None;
        for (index, covered) in [(9, false), (10, true), (20, true), (21, false)] {
            frame.video = Some(VideoFrame::new("a.mp4", index, None));
            assert_eq!(
                document.masks_of(&frame).len(),
                if covered { 3 } else { 2 },
                "frame {index}"
            );
            assert!(ranged(None, None).covers(&frame));
        }
    }
}
