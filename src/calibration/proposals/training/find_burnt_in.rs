//! Finds graphics burnt into the pictures of a document, labelled or not, from a few pictures of
//! each camera: by edges that are static throughout or for a while, and by static features.

use super::burnt_in::{FoundMask, has_point_moved};
use super::spread::spread;
use crate::proposals::{FramePictures, read_picture};
use std::ops::ControlFlow;
use std::sync::Arc;
use touchline_core::camera::PtzCamera;
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, Document};
use touchline_vision::features::{
    BurntInGraphic, Features, ReducedPicture, StaticGraphic, burnt_in, standing_graphics,
};
use touchline_vision::media::ReadFrames;

/// Number of pictures of a camera in which edges are compared. It is enough to find a banner that
/// is shown an eighth of the time, and takes less than a minute.
const LOOKED_AT: usize = 64;

/// Features are extracted from every n-th of these pictures.
const FEATURES_EVERY: usize = 4;

/// A sampled picture.
struct SampledPicture {
    /// Index of its frame in the document.
    frame: usize,
    reduced: ReducedPicture,
    /// None if none were extracted.
    features: Option<Arc<Features>>,
}

/// Finds the graphics burnt into the pictures of every camera, outside its masks. Two pictures
/// between which the camera moved suffice; known cameras decide whether it did. Pictures that
/// cannot be read are skipped. Each picture is a step of progress. None if `progress` cancelled it.
pub fn find_burnt_in(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    progress: &Progress<'_, ()>,
) -> Option<Vec<FoundMask>> {
    let mut found = Vec::new();
    for camera in &pictures.document.cameras {
        let frames = &pictures.document.frames;
        let of_camera: Vec<usize> = (0..frames.len())
            .filter(|&index| frames[index].camera == camera.id)
            .collect();
        // Reduced pictures of a sample of frames, with features for a part of them.
        let looked_at = spread(of_camera.clone(), LOOKED_AT);
        let with_features = spread(looked_at.clone(), LOOKED_AT / FEATURES_EVERY);
        let seen = pictures.each_picture(reader, &looked_at, |index, frame, picture| {
            progress.report(())?;
            let Ok(picture) = picture else {
                return ControlFlow::Continue(None);
            };
            let wanted = with_features.binary_search(&index).is_ok();
            let features = wanted
                .then(|| pictures.features_in(frame, &picture).ok())
                .flatten();
            ControlFlow::Continue(Some(SampledPicture {
                frame: index,
                reduced: ReducedPicture::new(&picture),
                features,
            }))
        })?;
        let seen: Vec<SampledPicture> = seen.into_iter().flatten().collect();
        // A graphic that both methods find is kept once, as found by edges, which give a more exact
        // range of frames.
        let by_edges = by_edges(pictures, camera, reader, (&of_camera, &seen), progress)?;
        let looked_at: Vec<(usize, Arc<Features>)> = seen
            .into_iter()
            .filter_map(|seen| Some((seen.frame, seen.features?)))
            .collect();
        let by_features = find_by_features(pictures, camera, &looked_at);
        let by_features: Vec<FoundMask> = by_features
            .into_iter()
            .filter(|graphic| {
                let centre = graphic.mask.pixel_box.centre();
                !by_edges
                    .iter()
                    .any(|known| known.mask.pixel_box.contains(centre))
            })
            .collect();
        found.extend(by_edges.into_iter().chain(by_features));
    }
    Some(found)
}

/// The graphics that are static throughout or for a while, by their edges. None if `progress`
/// cancelled it.
fn by_edges(
    pictures: &FramePictures<'_>,
    camera: &Camera,
    reader: &mut dyn ReadFrames,
    (of_camera, seen): (&[usize], &[SampledPicture]),
    progress: &Progress<'_, ()>,
) -> Option<Vec<FoundMask>> {
    let document = pictures.document;
    let reduced: Vec<ReducedPicture> = seen.iter().map(|seen| seen.reduced.clone()).collect();
    let mut found = Vec::new();
    for graphic in standing_graphics(&reduced) {
        let [first, last] = [graphic.first, graphic.last].map(|place| seen[place].frame);
        // Graphics that the document masks already are not reported.
        let masked = document.masks_of(&document.frames[first]);
        if masked
            .iter()
            .any(|mask| mask.contains(graphic.pixel_box.centre()))
        {
            continue;
        }
        // The range of frames that show the graphic ends somewhere between its last sampled picture
        // and the next one; bisect between the two. Images have no frame numbers, so their range
        // stays open.
        let mut bound = |shown: usize, other: Option<&SampledPicture>| -> Option<Option<usize>> {
            let is_of_video = document.frames[shown].video.is_some();
            let Some(other) = other.filter(|_| is_of_video) else {
                return Some(None);
            };
            let without = last_without(
                pictures,
                reader,
                &graphic,
                of_camera,
                [shown, other.frame],
                progress,
            )?;
            Some(Some(without))
        };
        let before = bound(
            first,
            graphic
                .first
                .checked_sub(1)
                .and_then(|place| seen.get(place)),
        )?;
        let after = bound(last, seen.get(graphic.last + 1))?;
        found.push(FoundMask::new(
            document,
            camera,
            graphic.pixel_box,
            [before, after],
            [first, last],
            graphic.edges(),
        ));
    }
    Some(found)
}

/// Bisects the camera's frames between one that shows a graphic and one that does not. Returns the
/// frame without it that is nearest to those with it; none if `progress` cancelled it. A frame that
/// cannot be read counts as showing it.
fn last_without(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    graphic: &StaticGraphic,
    of_camera: &[usize],
    [shown, without]: [usize; 2],
    progress: &Progress<'_, ()>,
) -> Option<usize> {
    // Both frames are of this camera, so they are found; the search is over places in its list.
    let [mut shown, mut without] =
        [shown, without].map(|frame| of_camera.binary_search(&frame).unwrap_or_default());
    while shown.abs_diff(without) > 1 {
        if progress.report(()).is_break() {
            return None;
        }
        let middle = usize::midpoint(shown, without);
        let picture = read_picture(
            reader,
            &pictures.document.frames[of_camera[middle]],
            pictures.folder,
        );
        if picture.is_ok_and(|picture| !graphic.is_shown_in(&ReducedPicture::new(&picture))) {
            without = middle;
        } else {
            shown = middle;
        }
    }
    Some(of_camera[without])
}

/// The graphics in sampled pictures, by features that do not move.
fn find_by_features(
    pictures: &FramePictures<'_>,
    camera: &Camera,
    looked_at: &[(usize, Arc<Features>)],
) -> Vec<FoundMask> {
    let document = pictures.document;
    let cameras: Vec<Option<PtzCamera>> = looked_at
        .iter()
        .map(|(index, _)| camera.ptz_camera(&document.frames[*index]))
        .collect();
    let features: Vec<&Features> = looked_at.iter().map(|(_, features)| &**features).collect();
    let scale = camera.image_size.scale_from_1920();
    let found = burnt_in(&features, &|one, other, point| {
        let pair = [one, other].map(|at| cameras[at].as_ref());
        // Without known cameras, the pictures alone have to show that the camera moved.
        let [Some(one), Some(other)] = pair else {
            return true;
        };
        has_point_moved(one, other, point, scale)
    });
    let sampled: Vec<usize> = looked_at.iter().map(|(index, _)| *index).collect();
    found
        .graphics
        .iter()
        .map(|graphic| mask_of_graphic(document, camera, &sampled, graphic))
        .collect()
}

/// The mask of a graphic that was found in sampled pictures, given by their frames' indices.
///
/// Its range is as wide as the samples allow: the graphic may have appeared right after the picture
/// before its first, and vanished right before the one after its last.
fn mask_of_graphic(
    document: &Document,
    camera: &Camera,
    sampled: &[usize],
    graphic: &BurntInGraphic,
) -> FoundMask {
    let before = graphic.first.checked_sub(1).map(|before| sampled[before]);
    let after = sampled.get(graphic.last + 1).copied();
    FoundMask::new(
        document,
        camera,
        graphic.pixel_box,
        [before, after],
        [graphic.first, graphic.last].map(|picture| sampled[picture]),
        graphic.features,
    )
}
