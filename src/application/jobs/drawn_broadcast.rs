//! The truth of a drawn broadcast as a document: for `touchline synth --broadcast`.

use serde_json::json;
use touchline_calibration::pipelines::shot_starts;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{
    Camera, Document, FieldSpec, Frame, FramePtz, FrameStatus, RejectReason, ShotContent, ShotKind,
    VideoFrame, VideoShots,
};
use touchline_vision::synthetic::{BROADCAST_FPS, Broadcast, BroadcastShot, ShotSubject};
use touchline_vision::track::FoundCut;

/// The document of a broadcast in a video: every frame of a shot with its exact camera, frames
/// between shots without one, and the shots with their cameras and what they show.
///
/// What the schema has no key for is under `truth`: of a shot its subject and speed, of the frames
/// between two shots the kind of transition. Frames that show no field are rejected and yet have
/// their camera.
pub fn broadcast_truth(broadcast: &Broadcast, video: &str, image_size: ImageSize) -> Document {
    let mut truth = Document::new(FieldSpec::new("soccer"));
    for (name, base) in broadcast.cameras() {
        let mut camera = Camera::new(name.into(), image_size);
        camera.set_base(base);
        truth.cameras.push(camera.into());
    }
    let shots = broadcast.shots();
    for shot in shots {
        for index in shot.transition_frames.start..shot.frames.end {
            let frame = true_frame(broadcast, shot, index, (video, image_size));
            truth.frames.push(frame.into());
        }
    }
    let cuts: Vec<FoundCut> = shots.iter().skip(1).map(found_cut).collect();
    let last = truth.frames.len().saturating_sub(1) as u64;
    VideoShots::from_cuts(&truth, video, last, &shot_starts(&cuts)).write(&mut truth);
    let names: Vec<&str> = broadcast.cameras().map(|(name, _)| name).collect();
    // The document lists a transition before the shot that it leads to.
    let mut drawn = shots.iter();
    let mut next = drawn.next();
    for written in &mut truth.shots {
        let Some(shot) = next else { break };
        if written.kind == ShotKind::Transition {
            let transition = json!({ "transition": shot.transition.as_str() });
            written.extra.insert("truth".to_owned(), transition);
            continue;
        }
        written.camera = Some(names[shot.camera].into());
        written.content = Some(if shot.subject.shows_field() {
            ShotContent::Field
        } else {
            ShotContent::NoField
        });
        let shows = json!({ "shows": shot.subject.as_str(), "speed": shot.speed });
        written.extra.insert("truth".to_owned(), shows);
        next = drawn.next();
    }
    truth
}

/// How a shot begins, as a search reports it.
fn found_cut(shot: &BroadcastShot) -> FoundCut {
    FoundCut {
        frame: shot.frames.start,
        transition: shot.transition_frames.clone(),
    }
}

/// A frame of a shot, or of the transition before it.
fn true_frame(
    broadcast: &Broadcast,
    shot: &BroadcastShot,
    index: usize,
    (video, image_size): (&str, ImageSize),
) -> Frame {
    let camera = broadcast.camera(shot, index);
    let name = broadcast.cameras().nth(shot.camera).map(|(name, _)| name);
    let pts_s = index as f64 / BROADCAST_FPS;
    let mut frame = Frame::from_video(
        VideoFrame::new(video, index as u64, Some(pts_s)),
        name.unwrap_or_default().into(),
        image_size,
    );
    if shot.frames.contains(&index) {
        frame.ptz = Some(FramePtz::new(camera.ptz(), Some(camera.lens())));
        (frame.status, frame.reason) = match shot.subject {
            ShotSubject::Play | ShotSubject::Replay => (FrameStatus::Reference, None),
            ShotSubject::CloseUp => (FrameStatus::Rejected, Some(RejectReason::CloseUp)),
            ShotSubject::Crowd => (FrameStatus::Rejected, Some(RejectReason::TooLittleField)),
        };
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::field::builtin;
    use touchline_documents::document::shots_of_frames;
    use touchline_vision::synthetic::{BroadcastOptions, Preset, TransitionStyle};

    #[test]
    fn every_frame_of_a_shot_has_its_camera_and_transitions_have_none() {
        let image_size = ImageSize::new(128, 72);
        let options = BroadcastOptions {
            seed: 3,
            frames: 1500,
            cameras: 5,
            image_size,
            shoot: Preset::Paper.shoot(),
        };
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let broadcast = Broadcast::new(&options, field);
        let truth = broadcast_truth(&broadcast, "broadcast.mp4", image_size);
        assert_eq!((truth.frames.len(), truth.cameras.len()), (1500, 6));
        for (frame, shot) in truth.frames.iter().zip(shots_of_frames(&truth)) {
            let shot = &truth.shots[shot.unwrap()];
            let is_transition = shot.kind == ShotKind::Transition;
            assert_eq!(frame.ptz.is_none(), is_transition);
            assert!(is_transition || shot.camera.as_ref() == Some(&frame.camera));
        }
        let gradual = broadcast.shots().iter().skip(1);
        let gradual = gradual.filter(|shot| shot.transition != TransitionStyle::Cut);
        let transitions = truth.shots.iter();
        let transitions = transitions.filter(|shot| shot.kind == ShotKind::Transition);
        for (drawn, written) in gradual.zip(transitions) {
            assert_eq!(
                written.extra["truth"]["transition"],
                drawn.transition.as_str()
            );
        }
    }
}
