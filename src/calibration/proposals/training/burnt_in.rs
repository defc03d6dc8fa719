//! Graphics burnt into the pictures of references: score bugs, watermarks, black boxes. They stay
//! in one place of the picture while the camera moves, so the forest would learn them as parts of
//! the stadium in all directions.

use super::training_sample::FeatureRays;
use crate::proposals::TrainingSample;
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
    /// A mask for a graphic of a camera that was found in `frames`, the first and the last. Its
    /// range reaches to the frames of the video just inside those before and after that do not show
    /// it; it is open where there is none, or where that is of another video.
    pub(in crate::proposals) fn new(
        document: &Document,
        camera: &Camera,
        pixel_box: PixelBox,
        without: [Option<usize>; 2],
        frames: [usize; 2],
        features: usize,
    ) -> Self {
        let [first, last] = frames;
        let [before, after] = without.map(|frame| {
            // The numbers of two videos give no range for what is shown in both.
            frame.filter(|_| range_in_video(document, frames).is_some())
        });
        let before = before.and_then(|before| range_in_video(document, [before, first]));
        let after = after.and_then(|after| range_in_video(document, [last, after]));
        let mask = RangedMask {
            pixel_box,
            from: before.map(|[before, first]| before.saturating_add(1).min(first)),
            to: after.map(|[last, after]| after.saturating_sub(1).max(last)),
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

/// The numbers of two frames in their video. None for images, for frames of different videos, and
/// where the first comes later in the video.
fn range_in_video(document: &Document, frames: [usize; 2]) -> Option<[u64; 2]> {
    let [first, last] = frames.map(|index| &document.frames[index]);
    let range = [first.video_frame_index()?, last.video_frame_index()?];
    (first.video_path() == last.video_path() && range[0] <= range[1]).then_some(range)
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
            let range = range_in_video(document, ends);
            let [from, to] = [0, 1].map(|end| range.map(|range| range[end]));
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

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::{Frame, VideoFrame};
    use touchline_documents::testing::soccer_document;

    #[test]
    fn a_range_ends_at_frames_of_the_same_video_alone() {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        for (path, number) in [("a.mp4", 5), ("a.mp4", 9), ("b.mp4", 2), ("b.mp4", 7)] {
            let video = VideoFrame::new(path, number, None);
            let frame = Frame::from_video(video, "main".into(), size);
            document.frames.push(frame.into());
        }
        let camera = Camera::new("main".into(), size);
        let pixel_box = pixel_box(1.0, 1.0, 9.0, 9.0);
        for (without, frames, range) in [
            ([Some(0), None], [1, 1], (Some(6), None)),
            ([None, Some(3)], [2, 2], (None, Some(6))),
            // Before it comes another video, or a later frame of the same one.
            ([Some(1), None], [2, 3], (None, None)),
            ([Some(1), None], [0, 0], (None, None)),
            // It is shown in two videos.
            ([Some(0), Some(3)], [1, 2], (None, None)),
        ] {
            let mask = FoundMask::new(&document, &camera, pixel_box, without, frames, 1).mask;
            assert_eq!((mask.from, mask.to), range, "{without:?} {frames:?}");
        }
    }
}
