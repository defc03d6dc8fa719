//! The lookup says what a look through all frames says.

use super::accepted::MIN_ACCEPTED;
use super::shot::{MIN_MOVES, WITHIN_FRAMES, rates};
use super::{FrameLookup, accepted_ptz, ptz_in_shot, shot_of};
use crate::calibrate::BaseReadiness;
use proptest::prelude::*;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, ImagePoint, ImageSize};
use touchline_core::solve::{Motion, MotionPrior, PtzRanges, PtzStep};
use touchline_documents::document::{
    Click, Clip, Document, Frame, FramePtz, FrameStatus, Shared, VideoFrame,
};
use touchline_documents::testing::soccer_document;

/// What the index keeps, looked up in all frames.
fn looked_up(document: &Document, index: usize) -> MotionPrior {
    let frame = &document.frames[index];
    let others = || {
        let all = document.frames.iter().enumerate();
        all.filter(move |(other, candidate)| *other != index && candidate.camera == frame.camera)
            .map(|(_, other)| &**other)
    };
    let accepted: Vec<Ptz> = others().filter_map(accepted_ptz).collect();
    let range = |of: fn(&Ptz) -> f64| {
        let values = accepted.iter().map(of);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[from, upto], value| {
            [from.min(value), upto.max(value)]
        })
    };
    let ([lowest, highest], [shortest, longest]) =
        (range(|ptz| ptz.tilt.radians()), range(|ptz| ptz.focal_px));
    let seen = (accepted.len() >= MIN_ACCEPTED).then(|| PtzRanges {
        pan: AngleRange::smallest(accepted.iter().map(|ptz| ptz.pan)).unwrap(),
        tilt: Angle::from_radians(lowest)..=Angle::from_radians(highest),
        focal_px: shortest..=longest,
    });
    MotionPrior {
        seen,
        motion: motion_looked_up(frame, others()),
    }
}

fn motion_looked_up<'a>(frame: &Frame, others: impl Iterator<Item = &'a Frame>) -> Option<Motion> {
    let (key, number) = shot_of(frame)?;
    let of_shot = others
        .filter_map(ptz_in_shot)
        .filter(|(other, ..)| *other == key);
    let mut solved: Vec<(u64, Ptz)> = of_shot.map(|(_, number, ptz)| (number, ptz)).collect();
    solved.sort_by_key(|(number, _)| *number);
    let pairs = solved
        .windows(2)
        .map(|pair| (((pair[0].0, 0), pair[0].1), ((pair[1].0, 0), pair[1].1)));
    let moves: Vec<[f64; 3]> = pairs
        .filter_map(|(a, b)| rates((&a.0, &a.1), (&b.0, &b.1)))
        .collect();
    if moves.len() < MIN_MOVES {
        return None;
    }
    let (at, from) = *solved.iter().min_by_key(|(at, _)| at.abs_diff(number))?;
    let frames = at.abs_diff(number).max(1);
    let usual = [0, 1, 2].map(|which| {
        let mut moved: Vec<f64> = moves.iter().map(|moved| moved[which]).collect();
        moved.sort_by(f64::total_cmp);
        moved[moved.len() * 9 / 10] * frames as f64
    });
    let [pan, tilt] = [usual[0], usual[1]].map(Angle::from_degrees);
    (frames <= WITHIN_FRAMES).then_some(Motion {
        from,
        frames,
        usual: PtzStep {
            pan,
            tilt,
            log_focal: usual[2],
        },
    })
}

/// A frame of a camera and a video, perhaps solved. Few different values, so that many are
/// equal.
fn a_frame() -> impl Strategy<Value = Frame> {
    let video = prop_oneof![9 => Just(0_usize), 1 => Just(1)];
    let places = (0..2_usize, 0..2_i64, video, 0..40_u64);
    let ptz = proptest::option::weighted(0.8, (-6..6_i32, -3..0_i32, 0..4_i32));
    let status = prop_oneof![
        3 => Just(FrameStatus::Reference),
        2 => Just(FrameStatus::Draft),
        1 => Just(FrameStatus::Rejected),
    ];
    (places, ptz, status).prop_map(|((camera, clip, video, number), ptz, status)| {
        let video = VideoFrame::new(["a.mp4", "b.mp4"][video], number, None);
        let mut frame = Frame::from_video(
            video,
            ["main", "high"][camera].into(),
            ImageSize::new(64, 36),
        );
        frame.clip = Some(Clip::Number(clip));
        if number % 3 == 0 {
            frame.clicks.push(Click::landmark(
                "centre_mark".into(),
                ImagePoint::new(1.0, 1.0),
            ));
        }
        frame.status = status;
        frame.ptz = ptz.map(|(pan, tilt, focal)| {
            let [pan, tilt, focal] = [pan, tilt, focal].map(f64::from);
            FramePtz::new(
                Ptz::from_degrees(30.0 * pan, 5.0 * tilt, 1000.0 + 100.0 * focal),
                None,
            )
        });
        frame
    })
}

fn same_as_looked_up(index: &FrameLookup, document: &Document) -> Result<(), TestCaseError> {
    for place in 0..document.frames.len() {
        prop_assert_eq!(
            index.prior(place),
            looked_up(document, place),
            "frame {}",
            place
        );
    }
    prop_assert_eq!(index.prior(document.frames.len()), MotionPrior::default());
    for camera in ["main", "high"] {
        let of_camera = |place: &usize| document.frames[*place].camera == camera.into();
        let of_camera: Vec<usize> = (0..document.frames.len()).filter(of_camera).collect();
        let mut readiness = BaseReadiness::default();
        for &place in &of_camera {
            readiness += BaseReadiness::from_frame(&document.frames[place]);
        }
        prop_assert_eq!(index.readiness(&camera.into()), readiness);
        let has_clicks = |place: &usize| !document.frames[*place].clicks.is_empty();
        let places: Vec<usize> = of_camera.into_iter().filter(has_clicks).collect();
        prop_assert_eq!(index.clicked_frames(&camera.into()), places);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_index_says_what_a_look_through_all_frames_says(
        frames in proptest::collection::vec(a_frame(), 1..120),
        edits in proptest::collection::vec((0..120_usize, a_frame()), 0..12),
    ) {
        let mut document = soccer_document();
        document.frames.extend(frames.into_iter().map(Shared::new));
        let mut index = FrameLookup::from_document(&document);
        same_as_looked_up(&index, &document)?;
        for (place, frame) in edits {
            let place = place % document.frames.len();
            document.frames[place] = frame.into();
            index.update(&document);
        }
        same_as_looked_up(&index, &document)?;
        let last = document.frames.len() - 1;
        document.frames[last].status = FrameStatus::Reference;
        index.update(&document);
        same_as_looked_up(&index, &document)?;
        document.frames.remove(0);
        index.update(&document);
        same_as_looked_up(&index, &document)?;
    }
}
