//! Graphics burnt into the pictures of references: score bugs, watermarks, black boxes. They stay
//! in one place of the picture while the camera moves, so the forest would learn them as parts of
//! the stadium in all directions.

use super::TrainingSample;
use super::training_sample::FeatureRays;
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, PixelBox};
use touchline_documents::document::{Camera, CameraId, Document, Extra, MaskSource, RangedMask};
use touchline_vision::features::{Features, burnt_in};

/// If the labels of two references move a point of the picture by more than this, the camera moved,
/// px at 1920 px width. The labels of a static camera differ by a few px because of click noise.
const MOVED_PX: f64 = 20.0;

/// A graphic that was found, as a mask of its camera.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMask {
    /// The camera.
    pub camera: CameraId,
    /// The mask.
    pub mask: RangedMask,
    /// Indices of the first and the last frame in which it was found.
    pub frames: [usize; 2],
    /// Number of static features, or edges, in all pictures together.
    pub features: usize,
}

impl FoundMask {
    /// A mask for a graphic of a camera that was found in `frames`. Its range reaches to the frames
    /// of the video just inside the two of `between`, which do not show it; it is open where there
    /// is none.
    pub(super) fn new(
        camera: &Camera,
        pixel_box: PixelBox,
        [before, after]: [Option<u64>; 2],
        frames: [usize; 2],
        features: usize,
    ) -> Self {
        let mask = RangedMask {
            pixel_box,
            from: before.map(|before| before + 1),
            to: after.map(|after| after.saturating_sub(1)),
            source: MaskSource::Found,
            extra: Extra::new(),
        };
        Self {
            camera: camera.id.clone(),
            mask,
            frames,
            features,
        }
    }

    /// Adds the graphic to the masks of its camera.
    pub fn mask_in(&self, document: &mut Document) {
        if let Some(camera) = document.camera_mut(&self.camera) {
            camera.ranged_masks.push(self.mask.clone());
        }
    }

    /// Describes the graphic in one line.
    #[must_use]
    pub fn describe(&self, document: &Document) -> String {
        let area = &self.mask.pixel_box;
        let [first, last] = self.frames.map(|index| {
            let frame = document.frames.get(index);
            frame.map(|frame| frame.name()).unwrap_or_default()
        });
        format!(
            "camera {}: {:.0} × {:.0} px at {:.0}, {:.0} look burnt in from {first} to {last} ({} features stand still) and are left out \
             of the training",
            self.camera, area.width, area.height, area.x, area.y, self.features
        )
    }
}

/// Finds graphics that are burnt into the pictures of training samples, camera by camera, and
/// removes the rays of features in them.
pub(super) fn leave_out_burnt_in(
    document: &Document,
    training_samples: &mut [TrainingSample],
) -> Vec<FoundMask> {
    let mut found = Vec::new();
    for camera in &document.cameras {
        let of_camera: Vec<usize> = (0..training_samples.len())
            .filter(|&at| training_samples[at].camera == camera.id)
            .collect();
        let cameras: Vec<Option<PtzCamera>> = of_camera
            .iter()
            .map(|&at| camera.ptz_camera(&document.frames[training_samples[at].frame]))
            .collect();
        let scale = camera.image_size.scale_from_1920();
        let moved =
            |one, other, point| has_point_moved_in_pair(&cameras, [one, other], point, scale);
        // Features that stay in place although the labels say that the camera moved.
        let pictures: Vec<&Features> = of_camera
            .iter()
            .map(|&at| &*training_samples[at].fine.features)
            .collect();
        let burnt = burnt_in(&pictures, &moved);
        let frames: Vec<usize> = of_camera
            .iter()
            .map(|&at| training_samples[at].frame)
            .collect();
        for graphic in &burnt.graphics {
            // A graphic in the first or the last picture has a range that is open at that end.
            let is_open_before = graphic.first == 0;
            let is_open_after = graphic.last + 1 == frames.len();
            // `burnt_in` counts the pictures of this camera; `frames` has their indices in the
            // document.
            let ends = [graphic.first, graphic.last].map(|picture| frames[picture]);
            let [from, to] = ends.map(|index| document.frames[index].video_frame_index());
            let mask = RangedMask {
                pixel_box: graphic.pixel_box,
                from: from.filter(|_| !is_open_before),
                to: to.filter(|_| !is_open_after),
                source: MaskSource::Found,
                extra: Extra::new(),
            };
            found.push(FoundMask {
                camera: camera.id.clone(),
                mask,
                frames: ends,
                features: graphic.features,
            });
        }
        // The coarse features show the same graphics and are only left out.
        // References without coarse features stay in the list, so that its places are those of
        // `of_camera`.
        let none = Features::default();
        let coarse: Vec<&Features> = of_camera
            .iter()
            .map(|&at| training_samples[at].coarse.as_ref())
            .map(|coarse| coarse.map_or(&none, |coarse| &coarse.features))
            .collect();
        let burnt_coarse = burnt_in(&coarse, &moved);
        for (place, &at) in of_camera.iter().enumerate() {
            let sample = &mut training_samples[at];
            leave_out(&mut sample.fine, &burnt.features[place]);
            if let Some(coarse) = &mut sample.coarse {
                leave_out(coarse, &burnt_coarse.features[place]);
            }
        }
    }
    found
}

/// Removes the rays of some features, so that they do not become training samples.
fn leave_out(features: &mut FeatureRays, burnt: &[usize]) {
    let burnt: BTreeSet<u32> = burnt.iter().map(|&feature| feature as u32).collect();
    features
        .rays
        .retain(|(feature, _)| !burnt.contains(feature));
}

/// Whether, by their labels, a point of one reference's picture lies elsewhere in another's. False
/// if either has no camera.
fn has_point_moved_in_pair(
    cameras: &[Option<PtzCamera>],
    pair: [usize; 2],
    point: ImagePoint,
    scale: f64,
) -> bool {
    let [Some(one), Some(other)] = pair.map(|at| cameras[at].as_ref()) else {
        return false;
    };
    has_point_moved(one, other, point, scale)
}

/// Whether a point of one picture lies elsewhere in another one, by their cameras. `scale` is the
/// width of the pictures in units of 1920 px.
pub(super) fn has_point_moved(
    one: &PtzCamera,
    other: &PtzCamera,
    point: ImagePoint,
    scale: f64,
) -> bool {
    let Ok(ray) = one.ray_from_image(point) else {
        return false;
    };
    // A point that the other camera does not see has left its picture.
    !other
        .image_from_ray(ray)
        .is_ok_and(|image| image.distance_px(point) <= MOVED_PX * scale)
}

/// The document, with the graphics that were found as masks of its cameras.
pub(super) fn with_found_masks(mut document: Document, found: &[FoundMask]) -> Document {
    for found in found {
        found.mask_in(&mut document);
    }
    document
}
