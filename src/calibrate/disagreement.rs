//! How well solved frames agree with the motion of their neighbours.

use crate::camera::{Ptz, PtzCamera};
use crate::document::{Camera, Document, Frame, FramePtz, FrameStatus, Shared, shots};
use crate::geometry::{ImageSize, Vec2, distance_from_segment};
use nalgebra::SVector;

/// Neighbours farther away than this say nothing: a camera has had time to go anywhere.
const WITHIN: f64 = 50.0;

/// A corner that another camera has behind it lies this far off, px.
const BEHIND_PX: f64 = 20_000.0;

/// How a frame lies to the solved frames before and after it, px at 1920 px width: root mean square over the picture's
/// corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// From the way that leads from the frame before to the one after, wherever on it the frame may be.
    pub apart_px: f64,
    /// How far that way is.
    pub neighbours_px: f64,
}

/// For every frame how it lies to its neighbours, found anew: see [`Disagreements::of`].
#[must_use]
pub fn disagreements(document: &Document) -> Vec<Option<Disagreement>> {
    Disagreements::default().of(document)
}

/// What has been found of a document's frames, so that only what has changed since is compared again.
#[derive(Clone, Debug, Default)]
pub struct Disagreements {
    /// The cameras that were compared with.
    cameras: Vec<Shared<Camera>>,
    /// For each frame the three that were compared, and what was found.
    compared: Vec<Option<Compared>>,
}

#[derive(Clone, Debug)]
struct Compared {
    three: [Shared<Frame>; 3],
    found: Option<Disagreement>,
}

impl Disagreements {
    /// For every frame how it lies to its neighbours; none without a camera of its own or without two neighbours in its shot.
    pub fn of(&mut self, document: &Document) -> Vec<Option<Disagreement>> {
        let same_cameras = self.cameras.len() == document.cameras.len()
            && self.cameras.iter().zip(&document.cameras).all(|(known, camera)| known.is_same(camera));
        if !same_cameras {
            self.cameras.clone_from(&document.cameras);
            self.compared.clear();
        }
        self.compared.resize(document.frames.len(), None);
        let mut found = vec![None; document.frames.len()];
        for shot in shots(document) {
            let solved: Vec<(usize, Ptz)> = shot.iter().filter_map(|&index| solved(document, index)).collect();
            for three in solved.windows(3) {
                let [(before, from), (index, _), (after, to)] = *three else { continue };
                let frames = [before, index, after].map(|place| &document.frames[place]);
                if way(frames[0], before, frames[2], after) <= WITHIN {
                    found[index] = self.compare(document, index, frames, (from, to));
                }
            }
        }
        found
    }

    fn compare(
        &mut self,
        document: &Document,
        index: usize,
        three: [&Shared<Frame>; 3],
        (from, to): (Ptz, Ptz),
    ) -> Option<Disagreement> {
        let known = &mut self.compared[index];
        if let Some(known) = known
            && known.three.iter().zip(three).all(|(known, frame)| known.is_same(frame))
        {
            return known.found;
        }
        let frame = three[1];
        let found = document.pointed(frame).map(|camera| disagreement(&camera, from, to, frame.image_size));
        *known = Some(Compared { three: three.map(Shared::clone), found });
        found
    }
}

fn solved(document: &Document, index: usize) -> Option<(usize, Ptz)> {
    let frame = &*document.frames[index];
    let ptz = frame.ptz.as_ref().filter(|_| frame.status != FrameStatus::Rejected)?;
    Some((index, FramePtz::ptz(ptz)))
}

/// How many frames lie between two: of the video where both come from one, else of the document.
fn way(from: &Frame, from_index: usize, to: &Frame, to_index: usize) -> f64 {
    match (&from.video, &to.video) {
        (Some(from), Some(to)) if from.path == to.path => to.frame_index as f64 - from.frame_index as f64,
        _ => to_index as f64 - from_index as f64,
    }
}

fn disagreement(own: &PtzCamera, from: Ptz, to: Ptz, image_size: ImageSize) -> Disagreement {
    let [from, to] = [from, to].map(|ptz| corners_off_px(own, &PtzCamera::new(*own.base(), ptz), image_size));
    let way = to - from;
    // Between neighbours the corners move on lines that are nearly straight.
    let apart = distance_from_segment(SVector::zeros(), [from, to]);
    // Over four corners, at 1920 px width.
    let scale = 0.5 / image_size.scale_from_1920();
    Disagreement { apart_px: scale * apart, neighbours_px: scale * way.norm() }
}

/// Where another camera has the corners of a camera's picture, from these corners, px: x and y of each.
fn corners_off_px(own: &PtzCamera, other: &PtzCamera, image_size: ImageSize) -> SVector<f64, 8> {
    let offsets = image_size.corners().map(|corner| {
        let seen = own.ray_from_image(corner).ok().and_then(|ray| other.image_from_ray(ray).ok());
        seen.map_or(Vec2::new(BEHIND_PX, 0.0), |seen| seen.offset_from(corner))
    });
    SVector::from_iterator(offsets.iter().flat_map(|offset| [offset.x, offset.y]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{BaseAngles, CameraBase};
    use crate::document::{Clip, FieldSpec};
    use crate::geometry::{ImagePoint, Vec3};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    /// A shot whose frames look at these pans.
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
    fn a_pan_agrees_however_fast_and_a_jump_stands_out() {
        let mut document = document(&[0.0, 0.5, 1.5, 1.6, 2.0]);
        let pan = disagreements(&document);
        assert_eq!((pan[0], pan[4]), (None, None), "no neighbour on one side");
        assert!(pan[1..4].iter().all(|found| found.unwrap().apart_px < 0.5), "{pan:?}");
        // A degree of pan at 2000 px is 35 px in the middle of the picture, more at its corners.
        assert!((52.0..66.0).contains(&pan[1].unwrap().neighbours_px), "{pan:?}");
        if let Some(ptz) = &mut document.frames[2].ptz {
            ptz.tilt_deg += 1.0;
        }
        let jump = disagreements(&document);
        assert!((34.0..45.0).contains(&jump[2].unwrap().apart_px), "{jump:?}");
        document.frames[2].ptz = Some(FramePtz::new(Ptz::from_degrees(170.0, -10.0, 2000.0), None));
        assert!(disagreements(&document)[2].unwrap().apart_px > 10_000.0, "it looks the other way");
    }

    #[test]
    fn what_is_known_is_what_would_be_found_anew() {
        let mut document = document(&[0.0, 0.5, 1.5, 1.6, 2.0, 9.0, 2.5]);
        let mut known = Disagreements::default();
        let changes: [fn(&mut Document); 6] = [
            |_| (),
            |document| document.frames[2].ptz.as_mut().unwrap().tilt_deg += 1.0,
            |document| document.frames[3].ptz = None,
            |document| {
                document.cameras[0].set_base(&CameraBase::new(
                    Vec3::new(0.0, -70.0, 9.0),
                    BaseAngles::default().base_from_world(),
                    ImagePoint::new(900.0, 500.0),
                ));
            },
            |document| document.frames[1].clip = Some(Clip::Number(2)),
            |document| drop(document.frames.remove(4)),
        ];
        for change in changes {
            change(&mut document);
            let found = known.of(&document);
            assert_eq!(found, disagreements(&document));
            assert!(found.iter().any(Option::is_some));
        }
    }

    #[test]
    fn only_solved_frames_of_the_shot_count() {
        let mut document = document(&[0.0, 0.5, 9.0, 1.5]);
        document.frames[2].ptz = None;
        assert!(disagreements(&document)[1].unwrap().apart_px < 0.5);
        document.frames[3].clip = Some(Clip::Number(2));
        assert_eq!(disagreements(&document), [None; 4]);
    }
}
