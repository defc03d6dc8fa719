//! The place of each frame by its own camera, where no picture shows which frames are of one shot.
//!
//! Given cameras scatter along the view: a camera 10 % farther off with a focal length 10 % longer
//! shows nearly the same picture. So places of different matches overlap, and a position alone does
//! not say to which of them a camera belongs. The picture does: on the place of another match a
//! camera cannot be turned and zoomed so that its ground stays where it was.

use super::given::GivenCamera;
use super::tails::find_tail;
use crate::calibrate::{OnBase, ptz_on_base};
use std::collections::BTreeMap;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImageSize;
use touchline_core::solve::base::{SharedPlace, shared_places};
use touchline_documents::document::Document;

/// A camera fits a place if its ground stays within this on the picture, px at 1920 px width: the
/// median over the picture. On the place of their own stadium, published cameras of single stills
/// move by 5 to 44 px, on that of another one by 37 to 160; of 20 and 30 px, which were tried on
/// these, 30 leaves fewer to a person.
const FITS_PX: f64 = 30.0;

/// A place of fewer frames than this is none.
const MIN_MEMBERS: usize = 3;

/// A camera on a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedFrame {
    /// The index of the place.
    pub place: usize,
    /// The camera there.
    pub on_base: OnBase,
}

/// The places that cameras share, and the frames that stand at them.
pub(super) struct FramePlaces {
    /// The places, the one with the most frames first. Their members are the frames that fit.
    pub places: Vec<SharedPlace>,
    /// The place of each frame; none where its camera fits none.
    pub of_frame: Vec<Option<PlacedFrame>>,
}

impl FramePlaces {
    /// The places of the usable cameras.
    pub fn from_given(document: &Document, given: &[GivenCamera]) -> Self {
        // A camera of the document has one size of picture.
        let mut by_size: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (index, frame) in document.frames.iter().enumerate() {
            if given[index].usable().is_some() {
                let ImageSize { width, height } = frame.image_size;
                by_size.entry([width, height]).or_default().push(index);
            }
        }
        let mut places = Vec::new();
        for ([width, height], frames) in by_size {
            let size = ImageSize::new(width, height);
            places.extend(fitting_places(given, frames, size));
        }
        places.sort_by_key(|place: &SharedPlace| std::cmp::Reverse(place.members.len()));
        // Frames of which another place is the nearer one leave a place, until each has enough and
        // none is the tail of another.
        loop {
            let of_frame = nearest_places(document, given, &mut places);
            let number = places.len();
            places.retain(|place| place.members.len() >= MIN_MEMBERS);
            if places.len() < number {
                continue;
            }
            let Some(tail) = find_tail(document, given, &places) else {
                return Self { places, of_frame };
            };
            places.remove(tail);
        }
    }
}

/// The place of each frame, the nearest by the picture of those that it fits. The frames become the
/// members of their places.
fn nearest_places(
    document: &Document,
    given: &[GivenCamera],
    places: &mut [SharedPlace],
) -> Vec<Option<PlacedFrame>> {
    let mut of_frame: Vec<Option<PlacedFrame>> = vec![None; given.len()];
    for (place, shared) in places.iter().enumerate() {
        let first = shared.members.first();
        let Some(size) = first.map(|index| document.frames[*index].image_size) else {
            continue;
        };
        for (index, frame) in document.frames.iter().enumerate() {
            let camera = given[index].usable().filter(|_| frame.image_size == size);
            let Some(on_base) = camera.and_then(|camera| fit(camera, shared, size)) else {
                continue;
            };
            let best = &mut of_frame[index];
            if best.is_none_or(|best| on_base.moved_px < best.on_base.moved_px) {
                *best = Some(PlacedFrame { place, on_base });
            }
        }
    }
    for (place, shared) in places.iter_mut().enumerate() {
        let is_here = |placed: &Option<PlacedFrame>| placed.is_some_and(|at| at.place == place);
        shared.members = (0..of_frame.len())
            .filter(|index| is_here(&of_frame[*index]))
            .collect();
    }
    of_frame
}

/// The places that frames (by index) share, each with those members that fit it.
fn fitting_places(
    given: &[GivenCamera],
    mut open: Vec<usize>,
    size: ImageSize,
) -> Vec<SharedPlace> {
    let mut places = Vec::new();
    while let Some(found) = most_shared(given, &open) {
        // Cameras of another place among the members displace the median. The place is determined
        // once more from those that fit it.
        let mut fitting = found.members.clone();
        fitting.retain(|index| {
            let camera = given[*index].usable();
            camera
                .and_then(|camera| fit(camera, &found, size))
                .is_some()
        });
        let settled = most_shared(given, &fitting);
        let done = settled
            .as_ref()
            .map_or(&found.members, |place| &place.members);
        open.retain(|index| done.binary_search(index).is_err());
        places.extend(settled);
    }
    places
}

/// The place that most of some frames share; its members are indices of frames.
fn most_shared(given: &[GivenCamera], frames: &[usize]) -> Option<SharedPlace> {
    let cameras: Vec<PtzCamera> = frames
        .iter()
        .filter_map(|index| given[*index].usable().copied())
        .collect();
    let mut place = shared_places(&cameras).into_iter().next()?;
    for member in &mut place.members {
        *member = frames[*member];
    }
    Some(place)
}

/// A camera that stands at a place, on the place's base; none if it does not fit.
fn fit(camera: &PtzCamera, place: &SharedPlace, size: ImageSize) -> Option<OnBase> {
    place
        .contains(camera.base().position_m)
        .then(|| ptz_on_base(camera, &place.base, size))?
        .filter(|on_base| on_base.moved_px <= FITS_PX)
}
