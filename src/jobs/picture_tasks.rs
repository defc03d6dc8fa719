//! What is done in the background with pictures of the open document.

use super::SharedPictures;
use super::shared_pictures::SharedReader;
use crate::app::unclicked::UnclickedOrder;
use crate::app::{Action, BurntInSearch, LineCheckOrder, PointSnapOrder, SnapOrder};
use crate::calibrate::WatchUnclicked;
use crate::media::FrameReader;
use crate::paint::WatchFind;
use crate::proposals::{FeatureStore, WorkFolder};
use std::ops::ControlFlow;

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
