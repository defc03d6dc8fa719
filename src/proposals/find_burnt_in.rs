//! Graphics burnt into the pictures of a document, labelled or not: found from a few pictures of each camera.

use super::burnt_in::{FoundMask, moved_by_labels};
use super::{FrameFeatures, FramePictures};
use crate::camera::PtzCamera;
use crate::document::{Camera, Extra, MaskSource, RangedMask};
use crate::features::{BurntInGraphic, Features, burnt_in};
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
        let looked_at = pictures.each(reader, &spread(&of_camera, LOOKED_AT), |index, _, found| {
            progress()?;
            ControlFlow::Continue(found.ok().map(|FrameFeatures { features, .. }| (index, features)))
        })?;
        let looked_at: Vec<(usize, Arc<Features>)> = looked_at.into_iter().flatten().collect();
        found.extend(of_pictures(pictures, camera, &looked_at));
    }
    Some(found)
}

/// At most `most` of some places, evenly spread, the first and the last among them.
fn spread(places: &[usize], most: usize) -> Vec<usize> {
    if places.len() <= most {
        return places.to_vec();
    }
    (0..most).map(|at| places[at * (places.len() - 1) / (most - 1)]).collect()
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

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn pictures_are_spread_from_the_first_to_the_last() {
        let places: Vec<usize> = (100..140).collect();
        assert_eq!(spread(&places[..5], 16), [100, 101, 102, 103, 104]);
        let spread = spread(&places, 4);
        assert_eq!(spread, [100, 113, 126, 139]);
    }
}
