//! The length of a field that one end of it does not tell, measured on frames that show its middle.

use std::path::Path;
use touchline_calibration::calibrate::{length_on_lines, take_length};
use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline_core::field::builtin;
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_documents::document::{
    Document, FieldSize, Frame, FramePtz, FrameStatus, Solution, SolutionSource, SolutionWarning,
    VideoFrame, document_from_bytes,
};
use touchline_vision::media::Picture;
use touchline_vision::synthetic::{FrameOptions, Stadium, StadiumOptions, stadium};

const SIZE: ImageSize = ImageSize::new(640, 360);

/// A match on a pitch of some length, seen from a camera beside its middle.
struct Match {
    scene: Stadium,
    length_m: f64,
    base: CameraBase,
    frames: Vec<Ptz>,
}

impl Match {
    fn on_pitch_of(length_m: f64) -> Self {
        let template = builtin("soccer").unwrap();
        let mut params = template.default_params();
        params.insert("length_m".to_owned(), length_m);
        let scene = stadium(&StadiumOptions::new(
            template.model(&params, 0.0).unwrap(),
            7,
        ));
        let base = CameraBase::new(
            Vec3::new(1.0, -62.0, 17.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        );
        let pans = (0..8)
            .map(|index| 13.0 + f64::from(index))
            .chain((0..4).map(|index| 33.0 + 2.0 * f64::from(index)));
        Self {
            scene,
            length_m,
            base,
            frames: pans
                .map(|pan_deg| Ptz::from_degrees(pan_deg, -12.0, 1066.0))
                .collect(),
        }
    }

    /// The match as it is known on a pitch of 105 m of which the right end was seen: those frames
    /// are certain, and the first eight have doubts.
    fn as_known(&self) -> Document {
        let mut document: Document = document_from_bytes(
            br#"{"format": "touchline", "version": 1, "field": {"template": "soccer", "params": {}}, "frames": [],
                "cameras": [{"id": "main", "image_size_px": [640, 360], "principal_point_px": [320, 180]}]}"#,
        )
        .unwrap();
        let by_m = (105.0 - self.length_m) / 2.0;
        let base = CameraBase {
            position_m: self.base.position_m + Vec3::new(by_m, 0.0, 0.0),
            ..self.base
        };
        document.cameras[0].set_base(&base);
        for (index, ptz) in self.frames.iter().enumerate() {
            let video = VideoFrame::new("match.mp4", index as u64, None);
            let mut frame = Frame::from_video(video, document.cameras[0].id.clone(), SIZE);
            let has_doubts = index < 8;
            frame.ptz = Some(FramePtz::new(*ptz, None));
            frame.status = FrameStatus::Suggested;
            let warnings = has_doubts
                .then(|| SolutionWarning::new("line_check", "not where the paint is".to_owned()));
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Tracking),
                confidence: Some(if has_doubts { 0.3 } else { 0.97 }),
                warnings: warnings.into_iter().collect(),
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        document
    }
}

impl Match {
    fn picture(&self, frame: &Frame) -> Option<Picture> {
        let camera = PtzCamera::new(
            self.base,
            self.frames[frame.video.as_ref()?.frame_index as usize],
        );
        let drawn = self
            .scene
            .render(&camera, SIZE, &FrameOptions::default())
            .image;
        let rgba: Vec<u8> = drawn
            .pixels()
            .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
            .collect();
        Picture::new(SIZE, rgba).ok()
    }
}

#[test]
fn the_paint_of_the_middle_tells_the_length_and_the_camera_moves_with_the_end_it_saw() {
    for length_m in [101.0, 108.0] {
        let seen = Match::on_pitch_of(length_m);
        let mut document = seen.as_known();
        let found = length_on_lines(document.at(Path::new("nowhere")), &mut |frame| {
            seen.picture(frame)
        })
        .unwrap()
        .expect("a length");
        assert!(
            (found.size.value_m - length_m).abs() < 0.5,
            "{found:?} of {length_m} m"
        );
        assert!(
            (found.size.value_m - length_m).abs() < 2.0 * found.size.sigma_m,
            "{found:?} of {length_m} m"
        );
        assert!(!found.is_prescribed);
        take_length(&mut document, &found);
        assert_eq!(document.field.size, Some(FieldSize::Fitted));
        let off_m = (document.cameras[0].position_m.unwrap() - seen.base.position_m).norm();
        assert!(off_m < 0.25, "{off_m} m off");
    }
}

#[test]
fn frames_with_doubts_of_other_kinds_give_no_length() {
    let seen = Match::on_pitch_of(105.0);
    let document = seen.as_known();
    assert_eq!(
        length_on_lines(document.at(Path::new("nowhere")), &mut |frame| seen
            .picture(frame))
        .unwrap(),
        None
    );
    // A length that a person gave is not taken, and said all the same.
    let seen = Match::on_pitch_of(101.0);
    let mut document = seen.as_known();
    document.field.size = Some(FieldSize::Confirmed);
    let found = length_on_lines(document.at(Path::new("nowhere")), &mut |frame| {
        seen.picture(frame)
    })
    .unwrap();
    assert!(found.is_some_and(|found| found.is_prescribed));
}
