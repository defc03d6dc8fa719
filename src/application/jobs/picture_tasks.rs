//! What is done in the background with pictures of the open document.

use super::SharedPictures;
use super::shared_pictures::SharedReader;
use super::tasks::new_folder;
use crate::app::base::EstimateFailure;
use crate::app::transfer::{TransferAction, TransferOrder, TransferWork};
use crate::app::Action;
use std::ops::ControlFlow;
use touchline_calibration::calibrate::{EstimatedBase, estimate_on_paint};
use touchline_calibration::proposals::read_picture;
use touchline_core::solve::base::{BaseOptions, WatchBase};
use touchline_documents::document::{CameraId, DocumentAt, Frame};
use touchline_vision::media::FrameReader;

/// Estimates a camera's base, and its field's size if that is wanted, from clicks and painted lines. `looked_at` is told how many
/// pictures have been looked at.
pub(super) fn base_with_paint(
    document: DocumentAt<'_>,
    (camera, with_size): (&CameraId, bool),
    pictures: SharedPictures,
    watch: WatchBase<'_>,
    looked_at: &dyn Fn(usize) -> ControlFlow<()>,
) -> Result<Box<EstimatedBase>, EstimateFailure> {
    let mut reader = SharedReader::new(Box::new(FrameReader::new()), pictures);
    let mut count = 0;
    let mut pictures = |frame: &Frame| {
        count += 1;
        // Without further pictures it ends soon.
        looked_at(count).is_continue().then(|| read_picture(&mut reader, frame, document.folder).ok()).flatten()
    };
    let found = estimate_on_paint(document, camera, &BaseOptions::default(), with_size, &mut pictures, watch)?;
    Ok(Box::new(found.with_pulled_frames(document, &mut pictures)?))
}

/// Exports or imports; `watch` is told how far it has come.
pub(super) fn transferred(
    mut order: TransferOrder,
    pictures: SharedPictures,
    watch: &mut dyn FnMut(Action) -> ControlFlow<()>,
) -> Action {
    match &mut order.work {
        TransferWork::WriteExport { format, to, .. } if format.is_folder() => {
            *to = new_folder(std::mem::take(to), format.name());
        }
        TransferWork::WriteDataset { to, .. } => *to = new_folder(std::mem::take(to), "dataset"),
        _ => {}
    }
    let ticket = order.ticket;
    let mut reader = SharedReader::new(Box::new(FrameReader::new()), pictures);
    Action::Transfer(
        order.carry_out(&mut reader, &mut |done, of| {
            watch(Action::Transfer(TransferAction::Progress { ticket, done, of }))
        }),
    )
}
