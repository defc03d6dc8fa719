//! The document of frames that have a lens each, some of which state no pan and tilt.

use crate::document::{Camera, CameraId, Document, FieldSpec, Frame, FrameLens, FramePtz};
use crate::exchange::cameras::into_document::{Exactness, View, document_of, unsolved_frame};
use std::collections::BTreeMap;

/// A document in which every frame has a lens of its own.
///
/// Frames with one position and one pan axis share a camera, whatever their lenses. The camera's
/// lens is that of its first frame. Frames of which only the lens is known belong to the first
/// camera of their video; they have the status `new` and no `ptz`.
pub(in crate::exchange) fn document_with_lenses(
    field: FieldSpec,
    frames: &[View],
    exact: Exactness,
) -> Document {
    let mut posed: Vec<View> = frames
        .iter()
        .filter(|(frame, _, _)| frame.pinhole().is_some())
        .cloned()
        .collect();
    // `document_of` groups frames of one principal point and one lens; here both belong to the
    // frame, so that all take those of the first to be grouped by place and axis.
    if let Some(first) = posed.first().map(|(_, _, view)| view.known_lens()) {
        for (_, _, view) in &mut posed {
            (view.principal_point, view.lens) = (first.principal_point, first.radial);
        }
    }
    let mut document = document_of(field, &posed, exact);

    // Merge both kinds back in the order of the file: `solved` has the posed frames in that order.
    let mut solved: std::vec::IntoIter<Frame> = document
        .frames
        .iter()
        .map(|frame| Frame::clone(frame))
        .collect::<Vec<_>>()
        .into_iter();
    let mut camera_of_video: BTreeMap<Option<String>, CameraId> = BTreeMap::new();
    let mut made = Vec::with_capacity(frames.len());
    for (read, size, view) in frames {
        let lens = FrameLens::new(view.focal_px, view.principal_point, view.lens);
        // `document_of` leaves out no frame that was checked, so that `solved` has one for each
        // posed frame.
        let frame = if read.pinhole().is_some() {
            solved.next().map(|frame| {
                let ptz = frame.ptz.as_ref().map(FramePtz::ptz);
                let recorded = Some(view.lens).filter(|lens| !lens.is_none());
                Frame {
                    ptz: ptz.map(|ptz| FramePtz::new(ptz, recorded)),
                    ..frame
                }
            })
        } else {
            let camera = camera_of_video
                .get(&read.video)
                .cloned()
                .unwrap_or_else(|| "main".into());
            // A file without any pose has no camera yet.
            if !document.cameras.iter().any(|known| known.id == camera) {
                document
                    .cameras
                    .push(Camera::new(camera.clone(), *size).into());
            }
            Some(unsolved_frame(read, camera, *size))
        };
        if let Some(frame) = frame {
            // The first posed frame of a video says which camera its other frames are of.
            camera_of_video
                .entry(read.video.clone())
                .or_insert_with(|| frame.camera.clone());
            made.push(
                Frame {
                    lens: Some(lens),
                    ..frame
                }
                .into(),
            );
        }
    }
    document.frames = made.into_iter().collect();
    document
}
