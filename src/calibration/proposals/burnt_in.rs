//! Graphics that are burnt into the pictures of references: score bugs, watermarks, black boxes.
//! They stand still on the screen whatever the camera does, and would have the forest learn them as
//! parts of the stadium.

use super::TrainingSample;
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{CameraId, Document, Extra, MaskSource, RangedMask};
use touchline_vision::features::{Features, burnt_in};

/// What two references show at one place of the screen is elsewhere by their labels if it moved by
/// more than this, px at 1920 px width: people's clicks leave a camera that did not move a few px
/// to wander.
const MOVED_PX: f64 = 20.0;

/// A graphic that was found, as a mask of its camera.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundMask {
    /// The camera.
    pub camera: CameraId,
    /// The mask.
    pub mask: RangedMask,
    /// The frames in which it was found first and last, by their places in the document.
    pub frames: [usize; 2],
    /// How many features of all pictures together, or edges, stand still there.
    pub features: usize,
}

impl FoundMask {
    /// Makes it one of its camera's masks.
    pub fn mask_in(&self, document: &mut Document) {
        if let Some(camera) = document.camera_mut(&self.camera) {
            camera.ranged_masks.push(self.mask.clone());
        }
    }

    /// What was found, in one line.
    #[must_use]
    pub fn describe(&self, document: &Document) -> String {
        let area = &self.mask.pixel_box;
        let name = |index: usize| {
            document
                .frames
                .get(index)
                .map(|frame| frame.name())
                .unwrap_or_default()
        };
        format!(
            "camera {}: {:.0} × {:.0} px at {:.0}, {:.0} look burnt in from {} to {} ({} features stand still) and are left out \
             of the training",
            self.camera,
            area.width,
            area.height,
            area.x,
            area.y,
            name(self.frames[0]),
            name(self.frames[1]),
            self.features
        )
    }
}

/// Finds what is burnt into the pictures of training samples, camera by camera, and removes it from
/// them.
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
            .map(|&at| camera.pointed(&document.frames[training_samples[at].frame]))
            .collect();
        let pictures: Vec<&Features> = of_camera
            .iter()
            .map(|&at| &*training_samples[at].features)
            .collect();
        let scale = camera.image_size.scale_from_1920();
        let burnt = burnt_in(&pictures, &|one, other, point| {
            moved(&cameras, [one, other], point, scale)
        });
        let frames: Vec<usize> = of_camera
            .iter()
            .map(|&at| training_samples[at].frame)
            .collect();
        for graphic in &burnt.graphics {
            let ends = [graphic.first, graphic.last];
            let number = |picture: usize, is_end: bool| {
                let video = document.frames[frames[picture]].video.as_ref();
                video.filter(|_| !is_end).map(|video| video.frame_index)
            };
            let mask = RangedMask {
                pixel_box: graphic.pixel_box,
                from: number(graphic.first, graphic.first == 0),
                to: number(graphic.last, graphic.last + 1 == frames.len()),
                source: MaskSource::Found,
                extra: Extra::new(),
            };
            let frames = ends.map(|picture| frames[picture]);
            found.push(FoundMask {
                camera: camera.id.clone(),
                mask,
                frames,
                features: graphic.features,
            });
        }
        for (&at, burnt) in of_camera.iter().zip(&burnt.features) {
            let burnt: BTreeSet<u32> = burnt.iter().map(|&feature| feature as u32).collect();
            training_samples[at]
                .rays
                .retain(|(feature, _)| !burnt.contains(feature));
        }
    }
    found
}

/// Whether what one reference shows at a point lies elsewhere in another, as their labels say.
fn moved(cameras: &[Option<PtzCamera>], pair: [usize; 2], point: ImagePoint, scale: f64) -> bool {
    let [Some(one), Some(other)] = pair.map(|at| cameras[at].as_ref()) else {
        return false;
    };
    moved_by_labels(one, other, point, scale)
}

/// Whether what one labelled picture shows at a point lies elsewhere in another; `scale` is the
/// picture's width in units of 1920 px.
pub(super) fn moved_by_labels(
    one: &PtzCamera,
    other: &PtzCamera,
    point: ImagePoint,
    scale: f64,
) -> bool {
    let Ok(ray) = one.ray_from_image(point) else {
        return false;
    };
    // What the other does not see at all has moved out of its picture.
    !other
        .image_from_ray(ray)
        .is_ok_and(|image| image.distance_px(point) <= MOVED_PX * scale)
}

/// A document whose cameras have the masks that were found.
pub(super) fn with_found_masks(mut document: Document, found: &[FoundMask]) -> Document {
    for found in found {
        found.mask_in(&mut document);
    }
    document
}
