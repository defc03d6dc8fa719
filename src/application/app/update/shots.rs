//! Changes of the shots of a video, one cut at a time.

use super::App;
use crate::app::session::Level;
use touchline_documents::document::{Document, ShotsError, VideoShots};

impl App {
    /// Moves a cut of the shown frame's video. `cut` and `to` are frame numbers of the video.
    pub(super) fn move_cut(&mut self, cut: u64, to: u64) {
        self.change_shots("Move cut", |shots, _, _| shots.move_cut(cut, to));
    }

    /// Starts a shot at the shown frame.
    pub(super) fn add_cut(&mut self) {
        self.change_shots("Cut before this frame", VideoShots::add);
    }

    /// Joins the shown frame's shot with the one before it.
    pub(super) fn remove_cut(&mut self) {
        self.change_shots("Join with previous shot", |shots, _, here| {
            let start = shots.start_of(here);
            shots.remove(start)
        });
    }

    /// The shots of the shown frame's video. None for a still image, or a video without shots.
    #[must_use]
    pub fn shots(&self) -> Option<VideoShots> {
        VideoShots::from_document(
            &self.open.as_ref()?.document,
            &self.frame()?.video.as_ref()?.path,
        )
    }

    /// Shows the first frame of the next shot. Backwards: the first frame of this shot, or of the
    /// one before if this is shown already.
    pub(super) fn go_to_shot(&mut self, forward: bool) {
        let (Some(shots), Some(open), Some(frame)) = (self.shots(), &self.open, self.frame())
        else {
            return;
        };
        let Some(here) = &frame.video else { return };
        // The document may lack the first frame of a shot: show the first one from there on.
        let mut starts: Vec<u64> = shots.starts().map(|(from, _)| from).collect();
        let to = if forward {
            starts.into_iter().find(|from| *from > here.frame_index)
        } else {
            starts.reverse();
            starts.into_iter().find(|from| *from < here.frame_index)
        };
        let Some(to) = to else { return };
        let position = open.document.frames.iter().position(|other| {
            let video = other.video.as_ref();
            video.is_some_and(|video| video.path == here.path && video.frame_index >= to)
        });
        if let Some(position) = position {
            self.go_to(position);
        }
    }

    /// Moves the cut that is nearest to the shown frame there.
    pub(super) fn move_cut_here(&mut self) {
        self.change_shots("Move the cut here", |shots, _, here| {
            let cuts = shots.starts().skip(1).map(|(from, _)| from);
            let nearest = cuts
                .min_by_key(|from| from.abs_diff(here))
                .ok_or(ShotsError::NoCut { frame: here })?;
            shots.move_cut(nearest, here)
        });
    }

    /// Changes the shots of the shown frame's video; one step of undo. A video without shots is
    /// treated as one shot.
    fn change_shots(
        &mut self,
        step: &str,
        change: impl FnOnce(&mut VideoShots, &Document, u64) -> Result<(), ShotsError>,
    ) {
        let (Some(open), Some(frame)) = (&self.open, self.frame()) else {
            return;
        };
        let Some(video) = frame.video.clone() else {
            return;
        };
        // A video without shots starts as one shot up to its last frame in the document.
        let mut shots =
            VideoShots::from_document(&open.document, &video.path).unwrap_or_else(|| {
                let last = last_frame_index(&open.document, &video.path);
                VideoShots::from_cuts(&open.document, &video.path, last, &[])
            });
        if let Err(error) = change(&mut shots, &open.document, video.frame_index) {
            self.session
                .notify(Level::Info, crate::app::sentence(&error.to_string()));
            return;
        }
        if !self.begin(step) {
            return;
        }
        if let Some(open) = &mut self.open {
            shots.write(&mut open.document);
        }
        self.commit();
    }
}

/// The index in a video of its last frame that the document has; 0 if it has none.
fn last_frame_index(document: &Document, path: &str) -> u64 {
    let videos = document
        .frames
        .iter()
        .filter_map(|frame| frame.video.as_ref());
    videos
        .filter(|video| video.path == path)
        .map(|video| video.frame_index)
        .max()
        .unwrap_or(0)
}
