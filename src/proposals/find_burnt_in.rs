//! Graphics burnt into the pictures of a document, labelled or not: found from a few pictures of each camera, by edges that
//! stand throughout and by features that stand for a while.

use super::burnt_in::{FoundMask, moved_by_labels};
use super::spread::spread;
use super::{FrameFeatures, FramePictures, read_picture};
use crate::camera::PtzCamera;
use crate::document::{Camera, Extra, MaskSource, RangedMask};
use crate::features::{BurntInGraphic, Features, ReducedPicture, burnt_in, standing_graphics};
use crate::media::ReadFrames;
use std::ops::ControlFlow;
use std::sync::Arc;

/// As many pictures of a camera are looked at: enough for a banner that is shown for a sixth of a video, and few enough to be
/// done within the first minute.
const LOOKED_AT: usize = 16;

/// Finds the graphics that are burnt into the pictures of every camera, outside the masks that it has. Two pictures between
/// which the camera moved suffice; where cameras are known they say whether it did. Pictures that cannot be read are passed over.
/// `progress` is asked after each picture, from any thread, and may end it: none then.
pub fn find_burnt_in(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    progress: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Option<Vec<FoundMask>> {
    let mut found = Vec::new();
    for camera in &pictures.document.cameras {
        let frames = &pictures.document.frames;
        let of_camera: Vec<usize> = (0..frames.len()).filter(|&index| frames[index].camera == camera.id).collect();
        let frames = spread(of_camera, LOOKED_AT);
        let by_edges = by_edges(pictures, camera, reader, &frames, progress)?;
        let looked_at = pictures.each(reader, &frames, |index, _, found| {
            progress()?;
            ControlFlow::Continue(found.ok().map(|FrameFeatures { features, .. }| (index, features)))
        })?;
        let looked_at: Vec<(usize, Arc<Features>)> = looked_at.into_iter().flatten().collect();
        let by_features = of_pictures(pictures, camera, &looked_at);
        let is_new = |graphic: &FoundMask| {
            let centre = graphic.mask.pixel_box.centre();
            !by_edges.iter().any(|known| known.mask.pixel_box.contains(centre))
        };
        let by_features: Vec<FoundMask> = by_features.into_iter().filter(is_new).collect();
        found.extend(by_edges.into_iter().chain(by_features));
    }
    Some(found)
}

/// The graphics that stand throughout, by their edges; none where `progress` ended it.
fn by_edges(
    pictures: &FramePictures<'_>,
    camera: &Camera,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    progress: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Option<Vec<FoundMask>> {
    let document = pictures.document;
    let mut reduced = Vec::with_capacity(frames.len());
    for &index in frames {
        if progress().is_break() {
            return None;
        }
        let picture = read_picture(reader, &document.frames[index], pictures.folder);
        reduced.extend(picture.ok().map(|picture| ReducedPicture::new(&picture)));
    }
    let (Some(&first), Some(&last)) = (frames.first(), frames.last()) else { return Some(Vec::new()) };
    let masked = document.masks_of(&document.frames[first]);
    let graphics = standing_graphics(&reduced);
    let unknown =
        graphics.into_iter().filter(|(graphic, _)| !masked.iter().any(|mask| mask.contains(graphic.centre())));
    let found = unknown.map(|(pixel_box, edges)| FoundMask {
        camera: camera.id.clone(),
        mask: RangedMask { pixel_box, from: None, to: None, source: MaskSource::Found, extra: Extra::new() },
        frames: [first, last],
        features: edges,
    });
    Some(found.collect())
}

fn of_pictures(pictures: &FramePictures<'_>, camera: &Camera, looked_at: &[(usize, Arc<Features>)]) -> Vec<FoundMask> {
    let frames = &pictures.document.frames;
    let cameras: Vec<Option<PtzCamera>> = looked_at.iter().map(|(index, _)| camera.pointed(&frames[*index])).collect();
    let features: Vec<&Features> = looked_at.iter().map(|(_, features)| &**features).collect();
    let scale = camera.image_size.scale_from_1920();
    let found = burnt_in(&features, &|one, other, point| {
        let pair = [one, other].map(|at| cameras[at].as_ref());
        // Without cameras the pictures alone say that they moved.
        let [Some(one), Some(other)] = pair else { return true };
        moved_by_labels(one, other, point, scale)
    });
    let mask = |graphic: &BurntInGraphic| {
        let number = |picture: usize| frames[looked_at[picture].0].video.as_ref().map(|video| video.frame_index);
        // The graphic may have come right after the picture before its first, and gone right before the one after its last.
        let from = graphic.first.checked_sub(1).and_then(number).map(|before| before + 1);
        let to = Some(graphic.last + 1).filter(|after| *after < looked_at.len()).and_then(number);
        FoundMask {
            camera: camera.id.clone(),
            mask: RangedMask {
                pixel_box: graphic.pixel_box,
                from,
                to: to.map(|after| after.saturating_sub(1)),
                source: MaskSource::Found,
                extra: Extra::new(),
            },
            frames: [graphic.first, graphic.last].map(|picture| looked_at[picture].0),
            features: graphic.features,
        }
    };
    found.graphics.iter().map(mask).collect()
}
