//! The shots of a video: found in the background, changed cut by cut.

use super::App;
use crate::app::effect::Effect;
use crate::app::session::Level;
use crate::app::shot_search::{FoundShots, ShotFailure, ShotProgress, ShotSearch, file_of, without_shots};
use crate::app::video::{RunningSearch, VideoAction};
use touchline_documents::document::{Document, EditKind, Frame, FrameStatus, ShotKind, ShotsError, Step, VideoShots};
use touchline_vision::media::MediaError;

impl App {
    pub(super) fn video(&mut self, action: VideoAction) {
        match action {
            VideoAction::ShotProgress { ticket, progress } => {
                if let Some(search) = self.session.video.search.as_mut().filter(|search| search.ticket == ticket) {
                    search.progress = progress;
                }
            }
            VideoAction::ShotsFound { ticket, found } => self.shots_found(ticket, found),
            VideoAction::MoveCut { cut, to } => self.change_shots("Move cut", |shots, _, _| shots.move_cut(cut, to)),
            VideoAction::SetSpeed(speed) => self.session.video.speed = speed,
            VideoAction::Pause => self.session.video.playing = false,
            VideoAction::GoToPlace(place) => self.go_to_place(place),
            VideoAction::PictureAwaited(awaited) => self.session.video.picture_awaited = awaited,
        }
    }

    /// Looks for the cuts of a video that has just been imported: nobody has done anything in the document yet.
    pub(super) fn find_shots_of_new(&mut self) {
        let Some(open) = self.open.as_ref().filter(|open| open.read_only.is_none()) else { return };
        let is_new = |status| matches!(status, FrameStatus::New | FrameStatus::Suggested);
        if !open.document.shots.is_empty() || !open.document.frames.iter().all(|frame| is_new(frame.status)) {
            return;
        }
        if let Some((video, path)) = without_shots(&open.document, &open.folder).into_iter().next() {
            self.begin_shot_search(video, path);
        }
    }

    /// Looks for the cuts of the shown frame's video, again if need be.
    pub(super) fn find_shots(&mut self) {
        let Some((open, frame)) = self.open.as_ref().zip(self.frame()) else { return };
        let video = frame.video.as_ref().map(|video| video.path.clone());
        if let Some((video, path)) = video.zip(file_of(frame, &open.folder)) {
            self.begin_shot_search(video, path);
        }
    }

    fn begin_shot_search(&mut self, video: String, path: std::path::PathBuf) {
        if cfg!(not(feature = "opencv")) {
            return;
        }
        self.shot_tickets += 1;
        let ticket = self.shot_tickets;
        let num_below = self.open.as_ref().map_or(0, |open| open.history.num_done());
        let (video_name, progress) = (video.clone(), ShotProgress::default());
        let search = RunningSearch { ticket, video: video_name, progress, num_below, found: None };
        self.session.video.search = Some(search);
        self.effects.push(Effect::FindShots(Box::new(ShotSearch { ticket, video, path })));
    }

    /// Stops the search for cuts; nothing has changed.
    pub(super) fn stop_shot_search(&mut self) {
        if self.session.video.search.take().is_some() {
            self.effects.push(Effect::CancelShots);
        }
    }

    fn shots_found(&mut self, ticket: u64, found: Result<FoundShots, ShotFailure>) {
        let Some(search) = self.session.video.search.as_mut().filter(|search| search.ticket == ticket) else { return };
        match found {
            Ok(found) => search.found = Some(found),
            Err(failure) => {
                let video = search.video.clone();
                self.session.video.search = None;
                if !matches!(failure, ShotFailure::Media(MediaError::Stopped { .. })) {
                    let text = format!("The search for cuts in {video} failed: {failure}");
                    self.session.notify(Level::Warning, text);
                }
            }
        }
    }

    /// Marks the shots that were found, once nothing else is under way: a drag is not cut in two.
    pub(super) fn finish_shot_search(&mut self) {
        if self.open.as_ref().is_none_or(|open| open.history.is_open()) {
            return;
        }
        let Some(search) = self.session.video.search.take_if(|search| search.found.is_some()) else { return };
        let Some(found) = search.found else { return };
        let count = found.cuts.len() + 1;
        let fades = found.cuts.iter().filter(|(_, kind)| *kind == ShotKind::Fade).count();
        let name = if count == 1 { "Mark the shot".to_owned() } else { format!("Mark {count} shots") };
        if self.refuses_changes() {
            return;
        }
        let Some(open) = &mut self.open else { return };
        let shots = VideoShots::found(&open.document, &search.video, found.last, &found.cuts);
        let step = Step::on_document(name.clone());
        if open.mark_shots(shots, step, search.num_below) {
            self.journal(&name, EditKind::NoStep);
            self.journal_whole();
        } else {
            self.journal(&name, EditKind::Step { frame: None });
        }
        if count > 1 {
            let unsure = match fades {
                0 => String::new(),
                1 => " One is a fade; its position is uncertain.".to_owned(),
                fades => format!(" {fades} are fades; their positions are uncertain."),
            };
            self.session.notify(Level::Info, format!("{count} shots found.{unsure}"));
        }
    }

    /// A shot begins at the shown frame.
    pub(super) fn add_cut(&mut self) {
        self.change_shots("Cut before this frame", VideoShots::add);
    }

    /// The shown frame's shot becomes part of the one before it.
    pub(super) fn remove_cut(&mut self) {
        self.change_shots("Join with previous shot", |shots, _, here| {
            let start = shots.start_of(here);
            shots.remove(start)
        });
    }

    /// The shots of the shown frame's video; none where it is of none.
    #[must_use]
    pub fn shots(&self) -> Option<VideoShots> {
        VideoShots::of(&self.open.as_ref()?.document, &self.frame()?.video.as_ref()?.path)
    }

    /// The first frame of the next shot, or of the shot before, is shown; the first press backwards goes to the start of this one.
    pub(super) fn go_to_shot(&mut self, forward: bool) {
        let (Some(shots), Some(open), Some(frame)) = (self.shots(), &self.open, self.frame()) else { return };
        let Some(here) = &frame.video else { return };
        let mut starts: Vec<u64> = shots.starts().map(|(from, _)| from).collect();
        let to = if forward {
            starts.into_iter().find(|from| *from > here.frame_index)
        } else {
            starts.reverse();
            starts.into_iter().find(|from| *from < here.frame_index)
        };
        let Some(to) = to else { return };
        let of_video = |other: &Frame| {
            other.video.as_ref().filter(|video| video.path == here.path).is_some_and(|video| video.frame_index >= to)
        };
        if let Some(position) = open.document.frames.iter().position(|frame| of_video(frame)) {
            self.go_to(position);
        }
    }

    /// The cut that is nearest to the shown frame goes there.
    pub(super) fn move_cut_here(&mut self) {
        self.change_shots("Move the cut here", |shots, _, here| {
            let cuts = shots.starts().skip(1).map(|(from, _)| from);
            let nearest = cuts.min_by_key(|from| from.abs_diff(here)).ok_or(ShotsError::NoCut { frame: here })?;
            shots.move_cut(nearest, here)
        });
    }

    /// Changes the shots of the shown frame's video: one step of undo. A video without any has one to begin with.
    fn change_shots(
        &mut self,
        step: &str,
        change: impl FnOnce(&mut VideoShots, &Document, u64) -> Result<(), ShotsError>,
    ) {
        let (Some(open), Some(frame)) = (&self.open, self.frame()) else { return };
        let Some(video) = frame.video.clone() else { return };
        let last = || {
            let of_video = open.document.frames.iter().filter_map(|frame| frame.video.as_ref());
            of_video.filter(|other| other.path == video.path).map(|video| video.frame_index).max().unwrap_or(0)
        };
        let mut shots = VideoShots::of(&open.document, &video.path)
            .unwrap_or_else(|| VideoShots::found(&open.document, &video.path, last(), &[]));
        if let Err(error) = change(&mut shots, &open.document, video.frame_index) {
            self.session.notify(Level::Info, crate::app::sentence(&error.to_string()));
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
