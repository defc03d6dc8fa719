//! Training samples.

use crate::features::Descriptor;
use touchline_core::camera::PanTilt;
use touchline_core::geometry::Vec3;

/// Training samples of a forest: descriptors and their rays, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    pub(super) descriptors: Vec<Descriptor>,
    /// Unit directions in `base`.
    rays: Vec<Vec3>,
    /// End index of each frame's samples.
    frame_ends: Vec<usize>,
}

impl Samples {
    /// No samples.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame's descriptors with their rays in `base`.
    pub fn add_frame(&mut self, samples: impl IntoIterator<Item = (Descriptor, PanTilt)>) {
        for (descriptor, ray) in samples {
            self.descriptors.push(descriptor);
            self.rays.push(ray.direction());
        }
        self.frame_ends.push(self.descriptors.len());
    }

    /// Number of samples.
    pub const fn len(&self) -> usize {
        self.descriptors.len()
    }

    /// Whether there is none.
    pub const fn is_empty(&self) -> bool {
        self.descriptors.is_empty()
    }

    /// Number of frames that were added.
    pub const fn frames(&self) -> usize {
        self.frame_ends.len()
    }

    /// The samples of one frame.
    pub(super) fn frame_range(&self, frame: usize) -> std::ops::Range<u32> {
        let start = frame.checked_sub(1).map_or(0, |last| self.frame_ends[last]);
        start as u32..self.frame_ends[frame] as u32
    }

    /// The ray of a sample: a unit direction in `base`.
    pub(super) fn ray(&self, sample: u32) -> Vec3 {
        self.rays[sample as usize]
    }

    /// One byte of a sample's descriptor.
    pub(super) fn byte(&self, sample: u32, dimension: u8) -> u8 {
        self.descriptors[sample as usize].0[usize::from(dimension)]
    }
}
