//! Runs of frames in which the camera is exactly still.

use super::Disagreements;
use touchline_documents::document::Document;

/// The runs of at least three frames of a shot in which the camera is exactly still, as indices in
/// the document.
pub(super) fn still_runs(document: &Document) -> Vec<Vec<usize>> {
    let known = Disagreements::from_document(document);
    let mut runs = Vec::new();
    for shot in known.shots() {
        let places: Vec<usize> = shot.iter().copied().collect();
        let inside: Vec<usize> = (0..places.len())
            .filter(|&at| {
                known
                    .for_frame(places[at])
                    .is_some_and(|found| found.is_still())
            })
            .collect();
        // A still frame has the same camera as its two neighbours, so each run extends by one frame
        // at both ends. A still frame always has neighbours on both sides.
        for run in inside.chunk_by(|one, next| one + 1 == *next) {
            if let [first, .., last] | [first @ last] = run {
                runs.push(places[first - 1..=last + 1].to_vec());
            }
        }
    }
    runs.sort();
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz};
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_documents::document::{Camera, Clip, FieldSpec, Frame, FramePtz, FrameStatus};

    #[test]
    fn a_run_is_three_frames_of_a_shot_with_one_camera() {
        const SIZE: ImageSize = ImageSize::new(1280, 720);
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), SIZE);
        camera.set_base(&CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        ));
        document.cameras.push(camera.into());
        let still = [
            (1, 2.0),
            (1, 2.0),
            (1, 2.001),
            (1, 3.0),
            (1, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 4.0),
        ];
        for (clip, pan_deg) in still {
            let mut frame = Frame::from_image("x.jpg", "main".into(), SIZE);
            frame.clip = Some(Clip::Number(clip));
            frame.ptz = Some(FramePtz::new(
                Ptz::from_degrees(pan_deg, -10.0, 1400.0),
                None,
            ));
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        assert_eq!(still_runs(&document), [vec![0, 1, 2], vec![5, 6, 7, 8]]);
        document.frames[1].ptz.as_mut().unwrap().tilt_deg += 0.1;
        assert_eq!(still_runs(&document), [vec![5, 6, 7, 8]]);
    }
}
