//! Which camera each shot of a video was filmed with, by the positions of the given cameras.

use super::given::{GivenCamera, mirror};
use crate::calibrate::{ptz_on_base, withdraw};
use std::collections::BTreeSet;
use std::ops::Range;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::base::{SharedPlace, shared_places};
use touchline_documents::document::{
    Camera, CameraId, Document, FrameStatus, Solution, SolutionSource,
};

/// A place is that of a shot if at least this share of the shot's possible cameras stand there.
/// One frame in four may be wrong; a close-up whose cameras are invented agrees on nothing.
const LEAST_SHARE_OF_SHOT: f64 = 0.3;
/// And at least this number of them.
const FEWEST_IN_SHOT: usize = 3;

/// A given camera stands elsewhere if its ground moves by more than this on the place of its shot,
/// px at 1920 px width: the median over the picture. Paint does not attract lines from so far.
const FAR_PX: f64 = 100.0;

/// The shots of a video, and where their cameras stand.
pub(super) struct Shots {
    /// The frames with which shots begin, without the first.
    pub cuts: Vec<usize>,
    /// The frames of each shot, by their indices in the document.
    pub ranges: Vec<Range<usize>>,
    /// The places, the one with the most frames first.
    pub places: Vec<SharedPlace>,
    /// The place of each shot; none where its cameras agree on none.
    pub of_shot: Vec<Option<usize>>,
}

impl Shots {
    /// The shots between cuts with their places. None if no shot has a place.
    pub fn new(document: &Document, cuts: Vec<usize>, given: &[GivenCamera]) -> Option<Self> {
        // A shot reaches from one cut to the next, the last one to the end of the document.
        let mut ends = cuts.clone();
        ends.push(document.frames.len());
        let mut begin = 0;
        let mut ranges = Vec::new();
        for end in ends {
            ranges.push(begin..end);
            begin = end;
        }
        let places = places_of_given(given);
        let mut of_shot = Vec::new();
        for range in &ranges {
            let possible = range
                .clone()
                .filter(|index| given[*index].usable().is_some());
            // Impossible cameras do not count against a place: they stand nowhere.
            let enough = LEAST_SHARE_OF_SHOT * possible.count() as f64;
            let counts = places.iter().map(|place| members_in(place, range));
            // The first of equals, which has the most frames in all.
            let most = counts.enumerate().rev().max_by_key(|(_, count)| *count);
            // A shot of one or two frames has a place if all of them stand there.
            let fewest = FEWEST_IN_SHOT.min(range.len());
            let most = most.filter(|(_, count)| *count as f64 >= enough && *count >= fewest);
            of_shot.push(most.map(|(place, _)| place));
        }
        of_shot.iter().any(Option::is_some).then_some(Self {
            cuts,
            ranges,
            places,
            of_shot,
        })
    }

    /// The place of a frame's shot.
    pub fn place_of(&self, index: usize) -> Option<&SharedPlace> {
        let shot = self
            .ranges
            .iter()
            .position(|range| range.contains(&index))?;
        self.places.get(self.of_shot[shot]?)
    }

    /// Gives each place that a shot has one camera of the document, and computes pan, tilt and
    /// focal length of the frames of its shots there. Frames that people decided on are not
    /// changed. Cameras that no frame uses any more are removed. Returns the cameras of the places.
    pub fn place_cameras(
        &self,
        document: &mut Document,
        given: &[GivenCamera],
        lens: Option<FocalCurve>,
    ) -> Vec<(CameraId, SharedPlace)> {
        // A place that no shot has gets no camera.
        let used: BTreeSet<usize> = self.of_shot.iter().flatten().copied().collect();
        let mut ids = vec![None; self.places.len()];
        for place in used {
            let open: Vec<bool> = document
                .frames
                .iter()
                .map(|frame| frame.is_open())
                .collect();
            ids[place] = place_camera(document, &self.places[place], lens, |index| open[index]);
        }
        let main = ids.iter().flatten().next().cloned();
        for (shot, range) in self.ranges.iter().enumerate() {
            let place = self.of_shot[shot];
            let camera = place.and_then(|place| ids[place].clone());
            for index in range.clone() {
                let frame = &mut document.frames[index];
                if !frame.is_open() {
                    continue;
                }
                // The frames of a shot without a place go to the main camera without a pose.
                if let Some(id) = camera.as_ref().or(main.as_ref()) {
                    frame.camera.clone_from(id);
                }
                let start = given[index]
                    .usable()
                    .zip(place)
                    .and_then(|(camera, place)| {
                        let base = with_lens(&self.places[place].base, lens);
                        Some((ptz_near_place(camera, &base, frame.image_size)?, base))
                    });
                // The given camera stays in the copy before, from which it is recorded later. Here
                // it is replaced by its equivalent on the common place, or removed.
                withdraw(frame);
                let Some((ptz, base)) = start else { continue };
                frame.point(ptz, base.distortion.radial_at(ptz.focal_px));
                frame.status = FrameStatus::Suggested;
                frame.solution = Some(Solution {
                    source: Some(SolutionSource::Import),
                    ..Solution::default()
                });
            }
        }
        // Given cameras come with one base for each frame; those are unused from here on.
        let used = document.used_cameras();
        document.cameras.retain(|camera| used.contains(&camera.id));
        let places = self.places.iter().cloned();
        ids.into_iter()
            .zip(places)
            .filter_map(|(id, place)| Some((id?, place)))
            .collect()
    }
}

/// The places that given cameras share, with the indices of the given cameras as members.
pub(super) fn places_of_given(given: &[GivenCamera]) -> Vec<SharedPlace> {
    let (indices, cameras): (Vec<usize>, Vec<PtzCamera>) = (0..given.len())
        .filter_map(|index| Some((index, given[index].usable().copied()?)))
        .unzip();
    let mut places = shared_places(&cameras);
    for place in &mut places {
        // `shared_places` counts the usable cameras only. Their indices ascend, so the members
        // still do, as `members_in` needs.
        for member in &mut place.members {
            *member = indices[*member];
        }
    }
    places
}

fn members_in(place: &SharedPlace, range: &Range<usize>) -> usize {
    let members = &place.members;
    // Members ascend, so those within a range are counted by two binary searches.
    members.partition_point(|at| *at < range.end) - members.partition_point(|at| *at < range.start)
}

/// Sets the base of a place in a camera that its members came with, and returns that camera's id.
/// A camera with frames that do not move there (those that people decided on, above all) keeps its
/// base; the place then gets a copy of it.
pub(super) fn place_camera(
    document: &mut Document,
    place: &SharedPlace,
    lens: Option<FocalCurve>,
    moves: impl Fn(usize) -> bool,
) -> Option<CameraId> {
    let frames = &document.frames;
    let first = place.members.iter().find(|index| moves(**index))?;
    let mut id = frames[*first].camera.clone();
    let mut of_camera = (0..frames.len()).filter(|index| frames[*index].camera == id);
    if !of_camera.all(&moves) {
        let camera = document.camera(&id)?.clone();
        id = document.add_copy(&camera);
    }
    let camera: &mut Camera = document.camera_mut(&id)?;
    let base = with_lens(&place.base, lens);
    camera.set_base(&base);
    // A base without a lens is written without one, and not as a lens of zero coefficients.
    if base
        .distortion
        .radial_at(base.distortion.at_focal_px)
        .is_none()
    {
        camera.distortion = None;
    }
    Some(id)
}

/// A given camera on the base of its place; none if it moves too far there to begin with: it stands
/// elsewhere.
pub(super) fn ptz_near_place(
    camera: &PtzCamera,
    base: &CameraBase,
    image_size: ImageSize,
) -> Option<Ptz> {
    let on_base = ptz_on_base(camera, base, image_size)?;
    (on_base.moved_px <= FAR_PX).then_some(on_base.ptz)
}

/// A base with a lens in place of its own, if there is one.
pub(super) fn with_lens(base: &CameraBase, lens: Option<FocalCurve>) -> CameraBase {
    CameraBase {
        distortion: lens.unwrap_or(base.distortion),
        ..*base
    }
}

/// The given cameras with those mirrored back, or turned round, that then stand at a place and do
/// not now.
pub(super) fn mirror_back(given: &[GivenCamera], places: &[SharedPlace]) -> Vec<GivenCamera> {
    given
        .iter()
        .map(|given| mirror_one_back(given, places))
        .collect()
}

/// The given camera as it is if it stands at a place; else turned round, mirrored, or mirrored and
/// turned round, the first of these that does; as it is if none does.
fn mirror_one_back(given: &GivenCamera, places: &[SharedPlace]) -> GivenCamera {
    let GivenCamera::Possible(camera) = given else {
        return given.clone();
    };
    if stands_at_one_of(places, camera) {
        return given.clone();
    }
    // A field looks the same after half a turn, so a program may as well give the camera opposite.
    // That is the same picture and no mirrored one, and is tried first.
    let turned = camera.after_half_turn();
    if stands_at_one_of(places, &turned) {
        return GivenCamera::Possible(Box::new(turned));
    }
    let reflected = [mirror(camera), mirror(&turned)];
    let at_place = reflected
        .into_iter()
        .find(|camera| stands_at_one_of(places, camera));
    at_place.map_or_else(
        || given.clone(),
        |camera| GivenCamera::Mirrored(Box::new(camera)),
    )
}

fn stands_at_one_of(places: &[SharedPlace], camera: &PtzCamera) -> bool {
    let position_m = camera.base().position_m;
    places.iter().any(|place| place.contains(position_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::Frame;
    use touchline_documents::testing::soccer_document;

    const MAIN_M: Vec3 = Vec3::new(2.0, -70.0, 18.0);
    const BESIDE_M: Vec3 = Vec3::new(-36.0, -62.0, 16.0);

    /// A camera 1 cm or so beside a place, by its number.
    fn near(place_m: Vec3, number: usize) -> GivenCamera {
        let off_m = 0.01 * (number % 3) as f64;
        let ptz = Ptz::from_degrees(0.2 * number as f64, -12.0, 2500.0);
        GivenCamera::Possible(Box::new(PtzCamera::new(
            base_at(place_m.add_scalar(off_m), SIZE),
            ptz,
        )))
    }

    /// A document whose frames have these cameras.
    fn document(given: &[GivenCamera]) -> Document {
        let mut document = soccer_document();
        for (number, given) in given.iter().enumerate() {
            let id = CameraId::from(format!("main-{number}").as_str());
            let mut camera = Camera::new(id.clone(), SIZE);
            let mut frame = Frame::from_image(&format!("{number}.jpg"), id, SIZE);
            if let Some(pointed) = given.usable() {
                camera.set_base(pointed.base());
                frame.point(pointed.ptz(), pointed.lens());
                frame.status = FrameStatus::Suggested;
            }
            document.cameras.push(camera.into());
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn two_cameras_and_a_close_up_are_distinguished() {
        // A shot of each camera, and one whose cameras agree on nothing.
        let mut given: Vec<GivenCamera> = (0..10).map(|number| near(MAIN_M, number)).collect();
        given.extend((0..6).map(|number| near(MAIN_M * (2.0 + number as f64), number)));
        given.extend((0..8).map(|number| near(BESIDE_M, number)));
        let before = document(&given);
        let shots = Shots::new(&before, vec![10, 16], &given).unwrap();
        assert_eq!(shots.of_shot, [Some(0), None, Some(1)]);

        let mut placed = before.clone();
        let cameras = shots.place_cameras(&mut placed, &given, None);
        let camera_of = |index: usize| &placed.frames[index].camera;
        assert!((0..16).all(|index| *camera_of(index) == cameras[0].0));
        assert!((16..24).all(|index| *camera_of(index) == cameras[1].0));
        assert_eq!(placed.cameras.len(), 2, "the others are in no use");
        let is_posed = |index: usize| placed.frames[index].ptz.is_some();
        assert!((0..24).all(|index| is_posed(index) != (10..16).contains(&index)));
    }

    #[test]
    fn frames_keep_their_ground_on_the_common_place() {
        let given: Vec<GivenCamera> = (0..12).map(|number| near(MAIN_M, number)).collect();
        let before = document(&given);
        let shots = Shots::new(&before, Vec::new(), &given).unwrap();
        let mut placed = before.clone();
        shots.place_cameras(&mut placed, &given, None);
        for (index, frame) in placed.frames.iter().enumerate() {
            let ground = given[index]
                .usable()
                .unwrap()
                .plane_from_image(SIZE.centre(), 0.0);
            let now = placed
                .ptz_camera(frame)
                .unwrap()
                .image_from_world(ground.unwrap());
            assert!(now.unwrap().distance_px(SIZE.centre()) < 1.0, "{index}");
        }
    }

    #[test]
    fn what_people_decided_on_keeps_its_camera_and_its_base() {
        let given: Vec<GivenCamera> = (0..12).map(|number| near(MAIN_M, number)).collect();
        let mut before = document(&given);
        // All frames of one camera, and one of them accepted.
        let first = before.frames[0].camera.clone();
        for index in 0..12 {
            before.frames[index].camera.clone_from(&first);
        }
        before.frames[5].status = FrameStatus::Reference;
        let shots = Shots::new(&before, Vec::new(), &given).unwrap();
        let mut placed = before.clone();
        shots.place_cameras(&mut placed, &given, None);
        assert_eq!(placed.frames[5], before.frames[5]);
        assert_eq!(placed.camera(&first), before.camera(&first));
        assert_ne!(placed.frames[4].camera, first);
    }

    #[test]
    fn mirrored_and_turned_cameras_come_back_to_the_place_of_the_others() {
        let mut given: Vec<GivenCamera> = (0..12).map(|number| near(MAIN_M, number)).collect();
        let turn = |given: &GivenCamera, way: fn(&PtzCamera) -> PtzCamera| {
            GivenCamera::Possible(Box::new(way(given.usable().unwrap())))
        };
        given[3] = turn(&given[3], mirror);
        given[7] = turn(&given[7], PtzCamera::after_half_turn);
        let before = document(&given);
        let shots = Shots::new(&before, Vec::new(), &given).unwrap();
        let back = mirror_back(&given, &shots.places);
        assert!(matches!(back[3], GivenCamera::Mirrored(_)));
        assert!(matches!(back[7], GivenCamera::Possible(_)));
        for index in [3, 7] {
            let camera = back[index].usable().unwrap();
            assert!((camera.base().position_m - MAIN_M).amax() < 0.1);
            // Where it looks is where it looked before it was turned.
            let pan_deg = camera.ptz().pan.degrees();
            assert!((pan_deg - 0.2 * index as f64).abs() < 1e-9, "{pan_deg}");
        }
    }

    #[test]
    fn cameras_without_a_common_place_have_no_shot() {
        let given: Vec<GivenCamera> = (0..9)
            .map(|number| near(MAIN_M * (1.0 + number as f64), number))
            .collect();
        assert!(Shots::new(&document(&given), Vec::new(), &given).is_none());
    }
}
