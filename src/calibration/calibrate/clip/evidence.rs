//! Tracked points and paint of a clip's pictures, kept for the next adjustment of the clip.

use super::frames::ClipFrames;
use super::paint::PaintAlignmentOutcome;
use crate::calibrate::kept::{Kept, from_bytes, kept, to_bytes};
use std::collections::BTreeMap;
use touchline_core::camera::{AngularDistance, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_vision::media::{FrameRef, MediaError};
use touchline_vision::track::{ClipCamera, FollowOptions, PointTracks};

/// The points that were tracked through a clip's pictures, and the paint that was found in them.
/// With it a clip is adjusted to a corrected frame without reading its pictures again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipEvidence {
    followed: Option<Followed>,
    /// Why no more pictures of the clip could be read than points were tracked through.
    unreadable: Option<MediaError>,
    /// The camera and the field with which the paint was found.
    seen_with: Option<(ClipCamera, FieldModel)>,
    paint: BTreeMap<usize, CameraPaintVerdict>,
}

/// The pictures through which points were tracked, and with which options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FollowedPictures {
    pub sources: Vec<FrameRef>,
    pub options: FollowOptions,
}

#[derive(Clone, Debug, PartialEq)]
struct Followed {
    pictures: FollowedPictures,
    /// One entry for each picture.
    masks: Vec<Vec<PixelBox>>,
    tracks: PointTracks,
}

/// The verdict of a frame's paint on a camera.
#[derive(Clone, Debug, PartialEq)]
struct CameraPaintVerdict {
    camera: Ptz,
    says: PaintAlignmentOutcome,
}

/// The evidence of a clip as bytes, to be kept on disk: the points, which stay the same, apart from
/// the paint, which each adjustment adds to.
pub(crate) struct EvidenceBytes {
    pub points: Vec<u8>,
    pub paint: Vec<u8>,
}

/// The points, without the pictures, which are those of the clip.
type KeptPoints = (FollowOptions, (Vec<Vec<PixelBox>>, PointTracks));

/// With what the paint was found, and its verdicts.
type KeptPaint = (
    Option<(ClipCamera, FieldModel)>,
    BTreeMap<usize, CameraPaintVerdict>,
);

kept! {
    CameraPaintVerdict { camera, says }
}

/// A camera that begins within this distance of where another was aligned is aligned to the same
/// place, px at 1920 px width.
const PULLED_ALIKE_PX: f64 = 8.0;

/// If no camera was aligned to the paint, the verdict applies to cameras within this distance, px
/// at 1920 px width.
const VERDICT_ALIKE_PX: f64 = 1.0;

impl ClipEvidence {
    /// Whether points were tracked through this picture.
    pub fn shows(&self, picture: &FrameRef) -> bool {
        self.followed
            .as_ref()
            .is_some_and(|followed| followed.pictures.sources.contains(picture))
    }

    /// The evidence as bytes; none if there is none, or if not all pictures could be read.
    pub(crate) fn to_bytes(&self) -> Option<EvidenceBytes> {
        let Followed {
            pictures,
            masks,
            tracks,
        } = self.followed.as_ref()?;
        let points: KeptPoints = (pictures.options, (masks.clone(), tracks.clone()));
        let paint: KeptPaint = (self.seen_with.clone(), self.paint.clone());
        self.unreadable.is_none().then(|| EvidenceBytes {
            points: to_bytes(&points),
            paint: to_bytes(&paint),
        })
    }

    /// The evidence of a clip that was kept as bytes; none if they are damaged.
    pub(crate) fn from_bytes(bytes: &EvidenceBytes, clip: &ClipFrames) -> Option<Self> {
        let (options, (masks, tracks)): KeptPoints = from_bytes(&bytes.points)?;
        let (seen_with, paint): KeptPaint = from_bytes(&bytes.paint)?;
        let sources: Vec<FrameRef> = clip.frames.iter().map(|it| it.source.clone()).collect();
        let is_of_clip = sources.len() == tracks.frames && sources.len() == masks.len();
        is_of_clip.then_some(Self {
            followed: Some(Followed {
                pictures: FollowedPictures { sources, options },
                masks,
                tracks,
            }),
            unreadable: None,
            seen_with,
            paint,
        })
    }

    /// The points, if they were tracked through the same pictures with the same options. Points
    /// under the new masks are removed.
    pub(super) fn tracks(
        &mut self,
        pictures: &FollowedPictures,
        masks: &[Vec<PixelBox>],
    ) -> Option<PointTracks> {
        let followed = self
            .followed
            .as_mut()
            .filter(|followed| followed.pictures == *pictures)?;
        if followed.masks != masks {
            // A new mask removes points and needs no new tracking. The paint is kept only in frames
            // whose masks are the same.
            // Points under a mask that was removed do not come back. The others suffice for the
            // adjustment, as they did before.
            followed.tracks = followed.tracks.outside(masks);
            let Followed { masks: before, .. } = followed;
            self.paint
                .retain(|frame, _| before.get(*frame) == masks.get(*frame));
            *before = masks.to_vec();
        }
        Some(followed.tracks.clone())
    }

    /// Replaces all evidence by newly tracked points.
    pub(super) fn begin(
        &mut self,
        pictures: FollowedPictures,
        masks: Vec<Vec<PixelBox>>,
        tracks: PointTracks,
    ) {
        *self = Self {
            followed: Some(Followed {
                pictures,
                masks,
                tracks,
            }),
            ..Self::default()
        };
    }

    /// Replaces all evidence by points that were tracked up to a picture that could not be read.
    pub(super) fn begin_readable(
        &mut self,
        mut pictures: FollowedPictures,
        masks: &[Vec<PixelBox>],
        tracks: PointTracks,
        why: MediaError,
    ) {
        pictures.sources.truncate(tracks.frames);
        let masks = masks[..tracks.frames].to_vec();
        self.begin(pictures, masks, tracks);
        self.unreadable = Some(why);
    }

    /// The first frames of a clip if no more of it could be read, and why.
    pub(super) fn readable_part(&self, clip: &ClipFrames) -> Option<(ClipFrames, MediaError)> {
        let sources = &self.followed.as_ref()?.pictures.sources;
        let first = clip.frames.get(..sources.len())?;
        let is_same = first.iter().map(|frame| &frame.source).eq(sources);
        let part = ClipFrames {
            camera: clip.camera.clone(),
            frames: first.to_vec(),
        };
        let why = self.unreadable.clone()?;
        (is_same && first.len() < clip.frames.len()).then_some((part, why))
    }

    /// Discards the paint if it was found with another base, other lenses or another field.
    pub(super) fn with_camera(&mut self, camera: &ClipCamera, field: &FieldModel) {
        let is_other = |seen: &(ClipCamera, FieldModel)| seen.0 != *camera || seen.1 != *field;
        if self.seen_with.as_ref().is_none_or(is_other) {
            self.seen_with = Some((camera.clone(), field.clone()));
            self.paint.clear();
        }
    }

    /// The verdict of a frame's paint on a camera, if it was found for one near it.
    pub(super) fn paint(
        &self,
        frame: usize,
        ptz: Ptz,
        size: ImageSize,
    ) -> Option<PaintAlignmentOutcome> {
        let CameraPaintVerdict { camera, says } = self.paint.get(&frame)?;
        // An alignment is valid around its end, with a wide basin; other verdicts only around the
        // camera that was checked.
        let (from, alike_px) = match says {
            PaintAlignmentOutcome::Snapped(anchor) => (anchor.ptz, PULLED_ALIKE_PX),
            PaintAlignmentOutcome::Contradicts | PaintAlignmentOutcome::Open => {
                (*camera, VERDICT_ALIKE_PX)
            }
        };
        (apart_px(from, ptz, size) <= alike_px * size.scale_from_1920()).then(|| says.clone())
    }

    /// Stores the verdict of a frame's paint.
    pub(super) fn keep_paint(&mut self, frame: usize, camera: Ptz, says: PaintAlignmentOutcome) {
        self.paint
            .insert(frame, CameraPaintVerdict { camera, says });
    }
}

/// Approximate distance between the pictures of two cameras, px: the larger of the displacement in
/// the middle and that by zoom at the left and right border.
pub(super) fn apart_px(one: Ptz, other: Ptz, size: ImageSize) -> f64 {
    AngularDistance::between(&one, &other).in_image_px(one.focal_px, size)
}

impl Kept for PaintAlignmentOutcome {
    fn write(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Snapped(prior) => {
                0_u8.write(bytes);
                prior.write(bytes);
            }
            Self::Contradicts => 1_u8.write(bytes),
            Self::Open => 2_u8.write(bytes),
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        match u8::read(bytes)? {
            0 => Kept::read(bytes).map(Self::Snapped),
            1 => Some(Self::Contradicts),
            2 => Some(Self::Open),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::CameraBase;
    use touchline_core::testing::{SIZE, soccer};

    #[test]
    fn paint_is_remembered_for_like_cameras_one_base_and_one_field() {
        let field = soccer();
        let base = |x| {
            ClipCamera::new(CameraBase::new(
                touchline_core::geometry::Vec3::new(x, -60.0, 18.0),
                touchline_core::camera::BaseAngles::default().base_from_world(),
                SIZE.centre(),
            ))
        };
        let ptz = |pan| Ptz::from_degrees(pan, -10.0, 2000.0);
        let mut evidence = ClipEvidence::default();
        evidence.with_camera(&base(0.0), &field);
        evidence.keep_paint(7, ptz(3.0), PaintAlignmentOutcome::Contradicts);
        assert_eq!(
            evidence.paint(7, ptz(3.01), SIZE),
            Some(PaintAlignmentOutcome::Contradicts)
        );
        assert_eq!(evidence.paint(7, ptz(3.1), SIZE), None, "3.4 px away");
        assert_eq!(evidence.paint(8, ptz(3.0), SIZE), None);
        evidence.with_camera(&base(0.0), &field);
        assert!(evidence.paint(7, ptz(3.0), SIZE).is_some());
        for (x, crown_m) in [(0.1, 0.0), (0.0, 0.2)] {
            let mut other = evidence.clone();
            other.with_camera(&base(x), &field.with_crown_m(crown_m));
            let says = other.paint(7, ptz(3.0), SIZE);
            assert_eq!(says, None, "it was seen with another base or field");
        }
    }
}
