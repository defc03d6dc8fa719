//! Queries the forest for a frame.

use crate::proposals::{
    Answer, FrameFeatures, FrameRequest, NoProposal, PictureError, Proposal, Timings,
};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{Document, FramePtz};
use touchline_vision::relocalize::{ForestModel, Pose, RelocalizeOptions, Relocalized, relocalize};

/// Proposes a camera for a frame with these features, from the forest of its camera.
pub fn propose(
    document: &Document,
    index: usize,
    found: Result<FrameFeatures, PictureError>,
    (model, generation): (&ForestModel, u64),
    options: &RelocalizeOptions,
) -> Proposal {
    let frame = &*document.frames[index];
    let request = FrameRequest::from_frame(document, frame);
    let mut timings = Timings::default();
    let outcome = found.map_err(NoProposal::from).and_then(|found| {
        // The times are those of the steps that were reached, also if a later one gives no answer.
        timings.features = found.time;
        let camera = frame.camera.as_str();
        let forest = model
            .camera(camera)
            .ok_or_else(|| NoProposal::NoReferences {
                camera: camera.to_owned(),
            })?;
        let base = request.base.ok_or_else(|| NoProposal::NoBase {
            camera: camera.to_owned(),
        })?;
        // Match the features in the forest and estimate the pose from the matched rays.
        let Relocalized {
            pose,
            predict_time,
            pose_time,
        } = relocalize(
            &found.features,
            &forest.forest,
            &forest.seen,
            &base,
            options,
        );
        (timings.predict, timings.pose) = (predict_time, pose_time);
        Ok(answer(&pose?, &base, frame.image_size))
    });
    Proposal {
        frame: frame.id.clone(),
        request,
        generation,
        outcome,
        timings,
    }
}

fn answer(pose: &Pose, base: &CameraBase, image_size: ImageSize) -> Answer {
    // Documents state the lens of a frame only where there is one.
    let lens = Some(base.distortion.radial_at(pose.ptz.focal_px)).filter(|lens| !lens.is_none());
    Answer {
        ptz: FramePtz::new(pose.ptz, lens),
        covariance: pose.covariance,
        own_covariance: pose.own_covariance,
        rms_px: pose.rms_px,
        worst_corner_sigma_px: pose.worst_corner_sigma_px,
        confidence: pose.confidence,
        inliers: pose.inliers.len(),
        places: pose.places,
        evidence: pose.evidence(image_size),
        line_check: None,
        samples: None,
    }
}
