//! Changes of the shots of a video, one cut at a time.

use crate::app::App;
use touchline_documents::document::{
    Document, ShotContent, ShotKind, ShotsError, VideoShots, shots_of_frames,
};

impl App {
    /// Moves a cut of the shown frame's video. `cut` and `to` are frame numbers of the video.
    pub(in crate::app::update) fn move_cut(&mut self, cut: u64, to: u64) {
        self.change_shots("Move cut", |shots, _, _| shots.move_cut(cut, to));
    }

    /// Starts a shot at the shown frame.
    pub(in crate::app::update) fn add_cut(&mut self) {
        self.change_shots("Cut before this frame", VideoShots::add);
    }

    /// Joins the shown frame's shot with the one before it.
    pub(in crate::app::update) fn remove_cut(&mut self) {
        self.change_shots("Join with previous shot", |shots, _, here| {
            let start = shots.start_of(here);
            shots.remove(start)
        });
    }

    /// The shown frame's shot, by its place in the document's list; none where no shots are marked,
    /// and for a transition.
    pub(in crate::app::update) fn shown_shot(&self) -> Option<usize> {
        let document = &self.open.as_ref()?.document;
        let shot = *shots_of_frames(document).get(self.session.frame)?;
        shot.filter(|shot| document.shots[*shot].kind != ShotKind::Transition)
    }

    /// Corrects whether the shown frame's shot shows a field.
    pub(in crate::app::update) fn change_shot_content(&mut self) {
        let (Some(shot), Some(open)) = (self.shown_shot(), &self.open) else {
            return;
        };
        let shows = match open.document.shots[shot].content {
            Some(ShotContent::NoField) => ShotContent::Field,
            Some(ShotContent::Field) | None => ShotContent::NoField,
        };
        let step = match shows {
            ShotContent::Field => "Shot shows a field",
            ShotContent::NoField => "Shot shows no field",
        };
        if !self.begin(step) {
            return;
        }
        if let Some(open) = &mut self.open {
            open.document.shots[shot].content = Some(shows);
        }
        self.commit();
        self.session.note(format!("{step}."));
    }

    /// The shots of the shown frame's video. None for a still image, or a video without shots.
    pub fn shots(&self) -> Option<VideoShots> {
        VideoShots::from_document(
            &self.open.as_ref()?.document,
            &self.frame()?.video.as_ref()?.path,
        )
    }

    /// Shows the first frame of the next shot. Backwards: the first frame of this shot, or of the
    /// one before if this is shown already.
    pub(in crate::app::update) fn go_to_shot(&mut self, forward: bool) {
        let (Some(shots), Some(open)) = (self.shots(), &self.open) else {
            return;
        };
        let here = open.frame_number(self.session.frame);
        let of_video = open.frame_numbers_in_video(self.session.frame);
        let of_video: Vec<(usize, u64)> = of_video.collect();
        // The document may have every n-th frame of the video only. Backwards the shot of the last
        // frame before this one counts; of a shot the first frame that there is is shown.
        let start = if forward {
            let mut starts = shots.starts().map(|(from, _)| from);
            starts.find(|from| *from > here)
        } else {
            let numbers = of_video.iter().map(|(_, number)| *number);
            let last_before = numbers.filter(|number| *number < here).max();
            last_before.map(|number| shots.start_of(number))
        };
        let Some(start) = start else { return };
        let from_start = of_video.iter().filter(|(_, number)| *number >= start);
        if let Some((position, _)) = from_start.min_by_key(|(_, number)| *number) {
            self.go_to(*position);
        }
    }

    /// Moves the cut that is nearest to the shown frame there.
    pub(in crate::app::update) fn move_cut_here(&mut self) {
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
            self.session.note(crate::app::sentence(&error.to_string()));
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
