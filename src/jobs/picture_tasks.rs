//! What is done in the background with pictures of the open document.

use super::SharedPictures;
use super::shared_pictures::SharedReader;
use crate::app::unclicked::UnclickedOrder;
use crate::app::{
    Action, BurntInSearch, LineCheckOrder, PointSnapOrder, ShotSearch, SnapOrder, TrackAction, TrackOrder, VideoAction,
};
use crate::calibrate::{ClipProgress, WatchUnclicked};
use crate::media::FrameReader;
use crate::paint::WatchFind;
use crate::proposals::{FeatureStore, WorkFolder};
use std::ops::ControlFlow;

/// Progress is told each time this many frames have been looked at.
const PROGRESS_EVERY: usize = 25;

/// Looks for graphics that are burned into the pictures; nothing is found where `watch`, asked after each, ends it.
pub(super) fn burnt_in(
    search: &BurntInSearch,
    pictures: SharedPictures,
    watch: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Action {
    let mut reader = SharedReader::new(Box::new(FrameReader::new()), pictures);
    // The trainer looks at some of the same pictures.
    let store = FeatureStore::on_disk(&WorkFolder::beside(&search.file));
    let found = search.look(&mut reader, &store, watch).unwrap_or_default();
    Action::BurntIn { file: search.file.clone(), found }
}

/// Looks for the cuts of a video. The window goes first: while the picture that it shows is being decoded this waits.
pub(super) fn shots_found(
    search: &ShotSearch,
    pictures: &SharedPictures,
    tell: &dyn Fn(Action) -> ControlFlow<()>,
) -> Action {
    let ticket = search.ticket;
    let found = search.look(&mut FrameReader::new(), &|progress| {
        pictures.wait_for_window();
        if progress.done.is_multiple_of(PROGRESS_EVERY) {
            return tell(Action::Video(VideoAction::ShotProgress { ticket, progress }));
        }
        ControlFlow::Continue(())
    });
    Action::Video(VideoAction::ShotsFound { ticket, found })
}

/// Pulls a frame's camera onto the painted lines, or finds it by them; `watch` is told how far a search has come.
pub(super) fn snapped(order: &SnapOrder, pictures: SharedPictures, watch: WatchFind<'_>) -> Action {
    let result = order.carry_out(&mut SharedReader::new(Box::new(FrameReader::new()), pictures), watch);
    Action::Snapped { ticket: order.ticket, result }
}

/// Finds a camera by the pictures of its frames alone; `watch` is told how far the search has come.
pub(super) fn camera_searched(order: &UnclickedOrder, pictures: SharedPictures, watch: WatchUnclicked<'_>) -> Action {
    let answer = order.carry_out(&mut SharedReader::new(Box::new(FrameReader::new()), pictures), watch);
    Action::CameraSearched { ticket: order.ticket, answer: answer.map(Box::new) }
}

/// Carries known cameras through a clip; `watch` is told how far it has come.
pub(super) fn tracked(
    order: &TrackOrder,
    pictures: SharedPictures,
    watch: &dyn Fn(ClipProgress) -> ControlFlow<()>,
) -> Action {
    let tracked = order.carry_out(&mut SharedReader::new(Box::new(FrameReader::new()), pictures), watch);
    Action::Track(TrackAction::Done { ticket: order.ticket, tracked })
}

/// Looks where the landmarks of clicks are painted.
pub(super) fn points_snapped(order: &PointSnapOrder, pictures: SharedPictures) -> Action {
    let found = order.carry_out(&mut SharedReader::new(Box::new(FrameReader::new()), pictures));
    Action::PointsSnapped { ticket: order.ticket, found }
}

/// Judges cameras by the painted lines; fewer where `watch`, asked before each, ends it.
pub(super) fn lines_checked(
    order: &LineCheckOrder,
    pictures: SharedPictures,
    watch: &dyn Fn() -> ControlFlow<()>,
) -> Action {
    let found = order.carry_out(&mut SharedReader::new(Box::new(FrameReader::new()), pictures), watch);
    Action::LinesChecked { ticket: order.ticket, found: Ok(found) }
}
