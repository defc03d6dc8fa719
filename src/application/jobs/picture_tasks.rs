//! What is done in the background with pictures of the open document.

use super::SharedPictures;
use super::shared_pictures::SharedReader;
use super::tasks::new_folder;
use crate::app::transfer::{TransferAction, TransferOrder, TransferWork};
use crate::app::Action;
use std::ops::ControlFlow;
use touchline_vision::media::FrameReader;

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
