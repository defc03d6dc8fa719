//! The pictures of the open document as somebody who looks at it needs them: the shown one, its
//! neighbours, thumbnails.

use super::{
    Decoder, DecoderOptions, DecoderReport, FrameState, SharedPictures, ThumbnailReport,
    Thumbnails, Wake,
};
use crate::app::session::Level;
use crate::app::{Action, App, OpenProject, ViewAction};
use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use touchline_vision::media::{FrameRef, Picture, PrefetchOptions, StepDirection, prefetch_plan};

/// The shown frame's picture.
#[derive(Clone, Debug)]
pub enum PictureState {
    /// There is no frame.
    None,
    /// It is being decoded.
    Loading,
    /// It is here; the number tells pictures apart (for upload caches).
    Ready(u64, Picture),
    /// It cannot be shown, and why.
    Failed(String),
}

/// What has happened to the pictures.
#[derive(Debug, Default)]
pub struct PictureNews {
    /// What the application has to be told.
    pub actions: Vec<Action>,
    /// Thumbnails that have been made.
    pub thumbnails: Vec<(FrameRef, Picture)>,
    /// Another document was opened: pictures of the one before are of no use.
    pub forget: bool,
}

/// The pictures of the open document.
pub struct Pictures {
    thumbnails: Thumbnails,
    decoder: Decoder,
    document: Option<PathBuf>,
    shown: Option<usize>,
    direction: StepDirection,
    state: PictureState,
    keys: BTreeMap<FrameRef, u64>,
    /// Where the frames that were asked for stand in the document, as long as they are kept.
    places: BTreeMap<FrameRef, usize>,
    next_key: u64,
}

impl Pictures {
    /// Starts the decoder and the maker of thumbnails; `wake` is called when there is something to
    /// take in.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn start(wake: Wake) -> io::Result<Self> {
        let decoder = Decoder::spawn(DecoderOptions::default(), wake.clone())?;
        Ok(Self {
            thumbnails: Thumbnails::spawn(&decoder, wake)?,
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

    /// The decoded frames, for others who need some of them.
    #[must_use]
    pub fn shared(&self) -> SharedPictures {
        self.decoder.pictures()
    }

    /// The shown frame's picture.
    #[must_use]
    pub fn current(&self) -> PictureState {
        self.state.clone()
    }

    /// The places of the frames that are decoded, in no order.
    #[must_use]
    pub fn decoded(&self) -> Vec<usize> {
        let kept = self.decoder.pictures();
        self.places
            .iter()
            .filter(|(frame, _)| kept.contains(frame))
            .map(|(_, place)| *place)
            .collect()
    }

    /// The decoded picture of the frame that stands nearest to a place, to be shown until the
    /// frame's own is there, and the number that tells pictures apart.
    pub fn nearest(&mut self, place: usize) -> Option<(u64, Picture)> {
        let kept = self.decoder.pictures();
        let decoded = self.places.iter().filter(|(frame, _)| kept.contains(frame));
        let frame = decoded
            .min_by_key(|(_, other)| other.abs_diff(place))
            .map(|(frame, _)| frame.clone())?;
        Some((self.key(&frame), kept.get(&frame)?))
    }

    /// Whether a frame's thumbnail cannot be had.
    #[must_use]
    pub fn has_no_thumbnail(&self, frame: &FrameRef) -> bool {
        self.thumbnails.has_failed(frame)
    }

    /// Asks for the thumbnails of these frames in this order, instead of those asked for before.
    pub fn request_thumbnails(&mut self, frames: &[FrameRef]) {
        self.thumbnails.request(frames);
    }

    /// Asks for what is about to be shown and takes in what has arrived.
    pub fn update(&mut self, app: &App) -> PictureNews {
        let mut news = PictureNews::default();
        for report in self.decoder.poll() {
            match report {
                DecoderReport::Notice(notice) => {
                    news.actions.push(Action::View(ViewAction::Notify(
                        Level::Warning,
                        notice.to_string(),
                    )));
                }
                DecoderReport::Panicked { frame, message } => {
                    let text = format!("{frame}: internal error (please report it): {message}");
                    news.actions
                        .push(Action::View(ViewAction::Notify(Level::Error, text)));
                }
                DecoderReport::Broken { message } => {
                    news.actions.push(broke_down("frames", &message));
                }
                DecoderReport::Ready { .. }
                | DecoderReport::Failed { .. }
                | DecoderReport::Counting(_) => {}
            }
        }
        for report in self.thumbnails.poll() {
            match report {
                ThumbnailReport::Ready { frame, picture } => news.thumbnails.push((frame, picture)),
                ThumbnailReport::Broken { message } => {
                    news.actions.push(broke_down("thumbnails", &message));
                }
                // The reason is said when somebody comes to the frame.
                ThumbnailReport::Failed { .. } | ThumbnailReport::Panicked { .. } => {}
            }
        }
        self.decoder
            .pictures()
            .set_budget((app.settings.picture_memory_mib as usize) << 20);
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

    /// Forgets the pictures of another document than the open one; true if there was one.
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

    fn ask(&mut self, open: Option<&OpenProject>, index: usize) {
        let Some((open, frame)) = open.and_then(|open| Some((open, picture_source(open, index)?)))
        else {
            self.shown = None;
            self.state = PictureState::None;
            return;
        };
        if let Some(before) = self.shown
            && before != index
        {
            self.direction = StepDirection::of_step(before, index);
        }
        self.shown = Some(index);
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
        let kept = self.decoder.pictures();
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

    fn key(&mut self, frame: &FrameRef) -> u64 {
        if let Some(key) = self.keys.get(frame) {
            return *key;
        }
        self.next_key += 1;
        self.keys.insert(frame.clone(), self.next_key);
        self.next_key
    }
}

/// What the user is told when no more pictures of a kind can be had.
fn broke_down(what: &str, message: &str) -> Action {
    let text = format!("There are no further {what}: internal error (please report it): {message}");
    Action::View(ViewAction::Notify(Level::Error, text))
}

/// Where a frame's pixels come from.
#[must_use]
pub fn picture_source(open: &OpenProject, index: usize) -> Option<FrameRef> {
    open.frame(index)?.picture_source(&open.folder)
}
