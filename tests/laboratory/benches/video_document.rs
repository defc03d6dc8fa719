//! Documents of videos.

use crate::drawing::{CAMERA, document};
use touchline::document::{CameraId, Document, FieldSpec, Frame, VideoFrame};
use touchline::media::VideoInfo;

/// Every `stride`-th frame of a video, as a new document.
pub fn document_of_video(
    video: &str,
    info: &VideoInfo,
    field: FieldSpec,
    stride: usize,
) -> Document {
    let mut document = document(field, info.size);
    for index in (0..info.decoded_frames).step_by(stride) {
        let frame = VideoFrame::new(video, index as u64, info.pts_s(index));
        document
            .frames
            .push(Frame::from_video(frame, CameraId::from(CAMERA), info.size).into());
    }
    document
}
