//! How well solved frames agree with the motion of their neighbours.

use super::{Document, Frame, FramePtz, FrameStatus, shots};
use crate::camera::{Ptz, PtzCamera};
use crate::geometry::{Angle, ImageSize};

/// Neighbours farther away than this say nothing: a camera has had time to go anywhere.
const WITHIN: f64 = 50.0;

/// For every frame how far its picture's corners lie from where a steady motion between the solved frames before and after
/// it would have them: root mean square, px at 1920 px width. None without a camera of its own or without two neighbours
/// in its shot.
#[must_use]
pub fn disagreements_px(document: &Document) -> Vec<Option<f64>> {
    let mut found = vec![None; document.frames.len()];
    for shot in shots(document) {
        let solved: Vec<(usize, &Frame, Ptz)> = shot.iter().filter_map(|&index| solved(document, index)).collect();
        for three in solved.windows(3) {
            let [(_, before, from), (index, frame, _), (_, after, to)] = *three else { continue };
            let (behind, ahead) = (way(before, three[0].0, frame, index), way(frame, index, after, three[2].0));
            if !(behind > 0.0 && ahead > 0.0 && behind + ahead <= WITHIN) {
                continue;
            }
            let expected = between(from, to, behind / (behind + ahead));
            found[index] = document.pointed(frame).and_then(|camera| {
                let expected = PtzCamera::new(*camera.base(), expected);
                Some(corners_apart_px(&camera, &expected, frame.image_size)? / frame.image_size.scale_from_1920())
            });
        }
    }
    found
}

fn solved(document: &Document, index: usize) -> Option<(usize, &Frame, Ptz)> {
    let frame = &*document.frames[index];
    let ptz = frame.ptz.as_ref().filter(|_| frame.status != FrameStatus::Rejected)?;
    Some((index, frame, FramePtz::ptz(ptz)))
}

/// How many frames lie between two: of the video where both come from one, else of the document.
fn way(from: &Frame, from_index: usize, to: &Frame, to_index: usize) -> f64 {
    match (&from.video, &to.video) {
        (Some(from), Some(to)) if from.path == to.path => to.frame_index as f64 - from.frame_index as f64,
        _ => to_index as f64 - from_index as f64,
    }
}

/// A camera on the way from one to another.
fn between(from: Ptz, to: Ptz, share: f64) -> Ptz {
    let turned = |from: Angle, to: Angle| {
        Angle::from_radians(from.radians() + share * (to - from).wrapped().radians()).wrapped()
    };
    Ptz {
        pan: turned(from.pan, to.pan),
        tilt: turned(from.tilt, to.tilt),
        focal_px: from.focal_px * (to.focal_px / from.focal_px).powf(share),
    }
}

/// How far one camera's corners lie in the picture of another, px; none where a corner has no image there.
fn corners_apart_px(own: &PtzCamera, other: &PtzCamera, image_size: ImageSize) -> Option<f64> {
    let mut squares = 0.0;
    for corner in image_size.corners() {
        let seen = other.image_from_ray(own.ray_from_image(corner).ok()?).ok()?;
        squares += seen.distance_px(corner).powi(2);
    }
    Some((squares / 4.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase};
    use crate::geometry::Vec3;
    use crate::project::{Camera, Clip, FieldSpec};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    /// A shot whose frames look at these pans, one every second frame of the document's numbering.
    fn document(pans_deg: &[f64]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), SIZE);
        let base = CameraBase::new(Vec3::new(0.0, -60.0, 18.0), BaseAngles::default().base_from_world(), SIZE.centre());
        camera.set_base(&base);
        document.cameras.push(camera.into());
        for &pan_deg in pans_deg {
            let mut frame = Frame::from_image("x.jpg", "main".into(), SIZE);
            frame.clip = Some(Clip::Number(1));
            frame.ptz = Some(FramePtz::new(Ptz::from_degrees(pan_deg, -10.0, 2000.0), None));
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn a_steady_pan_agrees_and_a_jump_stands_out() {
        let mut document = document(&[0.0, 0.5, 1.0, 1.5, 2.0]);
        let steady = disagreements_px(&document);
        assert_eq!((steady[0], steady[4]), (None, None), "no neighbour on one side");
        assert!(steady[1..4].iter().all(|px| px.unwrap() < 1e-6), "{steady:?}");
        if let Some(ptz) = &mut document.frames[2].ptz {
            ptz.pan_deg += 1.0;
        }
        let jump = disagreements_px(&document);
        // A degree of pan at 2000 px is 35 px in the middle of the picture.
        assert!((34.0..45.0).contains(&jump[2].unwrap()), "{jump:?}");
        assert!(jump[1].unwrap() < 0.6 * jump[2].unwrap());
    }

    #[test]
    fn only_solved_frames_of_the_shot_count_at_their_distance() {
        let mut document = document(&[0.0, 0.5, 9.0, 2.0]);
        document.frames[2].ptz = None;
        // Half a degree a frame: after the gap two frames farther on.
        document.frames[3].ptz.as_mut().unwrap().pan_deg = 1.5;
        assert!(disagreements_px(&document)[1].unwrap() < 1e-6);
        document.frames[3].clip = Some(Clip::Number(2));
        assert_eq!(disagreements_px(&document), [None; 4]);
    }
}
