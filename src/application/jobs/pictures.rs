//! The pictures of the open document for a viewer: the shown frame, its neighbours, thumbnails.

use super::{Decoder, DecoderReport, FrameState, SharedPictures, Wake};
use crate::app::session::Level;
use crate::app::{Action, App, OpenProject, ViewAction};
use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use touchline_vision::media::{FrameRef, Picture, PrefetchOptions, StepDirection, prefetch_plan};

/// The picture of the shown frame.
#[derive(Clone, Debug)]
pub enum PictureState {
    /// No frame is shown.
    None,
    /// It is being decoded.
    Loading,
    /// The picture, and a number that identifies it (for upload caches).
    Ready(u64, Picture),
    /// It cannot be shown, for this reason.
    Failed(String),
}

/// What has changed since the last update.
#[derive(Debug, Default)]
pub struct PictureNews {
    /// For the application.
    pub actions: Vec<Action>,
    /// New thumbnails.
    pub thumbnails: Vec<(FrameRef, Picture)>,
    /// Another document was opened: drop the pictures of the one before.
    pub forget: bool,
}

/// The pictures of the open document.
pub struct Pictures {
    thumbnails: Decoder,
    decoder: Decoder,
    /// The file of the open document.
    document: Option<PathBuf>,
    /// The index of the shown frame.
    shown: Option<usize>,
    direction: StepDirection,
    state: PictureState,
    /// The number that identifies each picture.
    keys: BTreeMap<FrameRef, u64>,
    /// Index in the document of each requested frame that is still in memory.
    places: BTreeMap<FrameRef, usize>,
    next_key: u64,
}

impl Pictures {
    /// Starts the decoder and the thumbnails. `wake` is called when there is something to take in.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn start(wake: Wake) -> io::Result<Self> {
        // The memory follows the settings with the first update.
        let decoder = Decoder::spawn(0, wake.clone())?;
        Ok(Self {
            thumbnails: decoder.spawn_thumbnails(wake)?,
            decoder,
            document: None,
            shown: None,
            direction: StepDirection::Unknown,
            state: PictureState::None,
            keys: BTreeMap::new(),
            places: BTreeMap::new(),
            next_key: 0,
        })
    }

    /// The decoded frames, for other readers.
    pub fn shared_pictures(&self) -> SharedPictures {
        self.decoder.pictures()
    }

    /// The picture of the shown frame.
    pub fn current(&self) -> PictureState {
        self.state.clone()
    }

    /// The indices of the decoded frames, unordered.
    pub fn decoded_frames(&self) -> Vec<usize> {
        let kept = self.decoder.pictures();
        self.places
            .iter()
            .filter(|(frame, _)| kept.contains(frame))
            .map(|(_, place)| *place)
            .collect()
    }

    /// The decoded picture whose frame is nearest to `place` in the document, and its number. It is
    /// shown until the frame's own picture has been decoded.
    pub fn nearest(&mut self, place: usize) -> Option<(u64, Picture)> {
        let kept = self.decoder.pictures();
        let decoded = self.places.iter().filter(|(frame, _)| kept.contains(frame));
        let frame = decoded
            .min_by_key(|(_, other)| other.abs_diff(place))
            .map(|(frame, _)| frame.clone())?;
        Some((self.key(&frame), kept.get(&frame)?))
    }

    /// Whether a frame has no thumbnail because it cannot be read.
    pub fn has_no_thumbnail(&self, frame: &FrameRef) -> bool {
        self.thumbnails.has_failed(frame)
    }

    /// Requests the thumbnails of these frames in this order, in place of earlier requests.
    pub fn request_thumbnails(&mut self, frames: &[FrameRef]) {
        self.thumbnails.request_all(frames);
    }

    /// Requests the pictures that are about to be shown, and takes in those that have arrived.
    pub fn update(&mut self, app: &App) -> PictureNews {
        let mut news = PictureNews::default();
        // The window reads the state of the current frame, so that only messages are passed on.
        for report in self.decoder.poll() {
            match report {
                DecoderReport::Notice(notice) => {
                    news.actions.push(Action::View(ViewAction::Notify(
                        Level::Warning,
                        notice.to_string(),
                    )));
                }
                DecoderReport::Panicked(frame, message) => {
                    let text = format!("{frame}: internal error (please report it): {message}");
                    news.actions
                        .push(Action::View(ViewAction::Notify(Level::Error, text)));
                }
                DecoderReport::Broken(message) => {
                    news.actions.push(broke_down("frames", &message));
                }
                DecoderReport::Frame(..) | DecoderReport::Counting(_) => {}
            }
        }
        for report in self.thumbnails.poll() {
            match report {
                DecoderReport::Frame(frame, Ok(picture)) => news.thumbnails.push((frame, picture)),
                DecoderReport::Broken(message) => {
                    news.actions.push(broke_down("thumbnails", &message));
                }
                // The decoder reports the rest when the user comes to the frame.
                _ => {}
            }
        }
        self.decoder
            .pictures()
            .set_budget((app.settings.picture_memory_mib as usize) << 20);
        // Thumbnails that have just arrived are of the document before.
        news.forget = self.follow(app.open());
        if news.forget {
            news.thumbnails.clear();
        }
        self.ask(app.open(), app.session.frame);
        let awaited = matches!(self.state, PictureState::Loading);
        if awaited != app.session.video.picture_awaited {
            news.actions.push(Action::PictureAwaited(awaited));
        }
        news
    }

    /// Drops the pictures if another document has been opened; returns whether it has.
    fn follow(&mut self, open: Option<&OpenProject>) -> bool {
        let document = open.map(|open| &open.file);
        let other = document != self.document.as_ref();
        if other {
            self.document = document.cloned();
            self.decoder.clear();
            self.keys.clear();
            self.places.clear();
            self.shown = None;
        }
        other
    }

    /// Requests the shown frame and its neighbours, and updates the state of the shown one.
    fn ask(&mut self, open: Option<&OpenProject>, index: usize) {
        let Some((open, frame)) = open.and_then(|open| Some((open, picture_source(open, index)?)))
        else {
            self.shown = None;
            self.state = PictureState::None;
            return;
        };
        // The direction of the last step says which neighbours come next.
        if let Some(before) = self.shown
            && before != index
        {
            self.direction = StepDirection::from_step(before, index);
        }
        self.shown = Some(index);
        // The neighbours that a user is likely to visit next, as many as fit into memory with 4
        // bytes a pixel. Those of a video are read in blocks, because it is decoded forward only.
        let in_blocks = matches!(frame, FrameRef::Video { .. });
        let picture_bytes = open.frame(index).map_or(0, |frame| {
            4 * frame.image_size.width as usize * frame.image_size.height as usize
        });
        let options = PrefetchOptions {
            in_blocks,
            ..PrefetchOptions::default()
        }
        .within(self.decoder.cache_bytes(), picture_bytes);
        let plan = prefetch_plan(index, open.document.frames.len(), self.direction, options);
        // Remember where the requested frames are in the document, for `decoded_frames` and
        // `nearest`.
        let kept = self.decoder.pictures();
        // Forget frames that are neither decoded nor requested, so that the list stays short.
        self.places.retain(|frame, _| kept.contains(frame));
        self.places.insert(frame.clone(), index);
        let mut neighbours = Vec::with_capacity(plan.len());
        for (place, neighbour) in plan
            .into_iter()
            .filter_map(|place| Some((place, picture_source(open, place)?)))
        {
            self.places.insert(neighbour.clone(), place);
            neighbours.push(neighbour);
        }
        self.decoder.request(&frame, &neighbours);
        self.state = match self.decoder.state(&frame) {
            FrameState::Ready(picture) => PictureState::Ready(self.key(&frame), picture),
            FrameState::Failed(error) => PictureState::Failed(error.to_string()),
            FrameState::Pending | FrameState::Absent => PictureState::Loading,
        };
        self.decoder
            .pictures()
            .set_awaited(matches!(self.state, PictureState::Loading));
    }

    /// The number of a frame's picture, new at the first call.
    fn key(&mut self, frame: &FrameRef) -> u64 {
        if let Some(key) = self.keys.get(frame) {
            return *key;
        }
        self.next_key += 1;
        self.keys.insert(frame.clone(), self.next_key);
        self.next_key
    }
}

/// The message for pictures of a kind that cannot be made any more.
fn broke_down(what: &str, message: &str) -> Action {
    let text = format!("There are no further {what}: internal error (please report it): {message}");
    Action::View(ViewAction::Notify(Level::Error, text))
}

/// The file, or the video and its frame, from which a frame's pixels are read.
pub fn picture_source(open: &OpenProject, index: usize) -> Option<FrameRef> {
    open.frame(index)?.picture_source(&open.folder)
}
