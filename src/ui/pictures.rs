//! Pictures of frames as the window needs them: the shown one, its neighbours, and thumbnails.

use crate::app::session::Level;
use crate::app::{Action, App, OpenProject};
use crate::jobs::{Decoder, DecoderOptions, DecoderReport, FrameState, ThumbnailReport, Thumbnails, Wake};
use crate::media::{FrameRef, Picture, PrefetchOptions, StepDirection, prefetch_plan};
use lru::LruCache;
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Thumbnails that stay on the GPU; a filmstrip shows some thirty.
const TEXTURES: NonZeroUsize = NonZeroUsize::MIN.saturating_add(599);

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

/// Pictures and thumbnails of the open document's frames.
pub struct Pictures {
    thumbnails: Thumbnails,
    decoder: Decoder,
    document: Option<PathBuf>,
    shown: Option<(usize, FrameRef)>,
    direction: StepDirection,
    state: PictureState,
    keys: BTreeMap<FrameRef, u64>,
    next_key: u64,
    textures: LruCache<FrameRef, egui::TextureHandle>,
    wanted: Vec<FrameRef>,
    in_view: ThumbnailProgress,
}

/// How many of the thumbnails in view are there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThumbnailProgress {
    /// These are there, or cannot be had.
    pub done: usize,
    /// Of so many.
    pub wanted: usize,
}

impl Pictures {
    /// Starts the decoder and the maker of thumbnails; `wake` asks for a repaint.
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
            next_key: 0,
            textures: LruCache::new(TEXTURES),
            wanted: Vec::new(),
            in_view: ThumbnailProgress::default(),
        })
    }

    /// The shown frame's picture.
    #[must_use]
    pub fn current(&self) -> PictureState {
        self.state.clone()
    }

    /// A frame's thumbnail; if it is not there yet it is made in the background.
    pub fn thumbnail(&mut self, open: &OpenProject, frame: usize) -> Option<egui::TextureHandle> {
        let frame = frame_ref(open, frame)?;
        self.wanted.push(frame.clone());
        self.textures.get(&frame).cloned()
    }

    /// Whether a frame's thumbnail cannot be had.
    #[must_use]
    pub fn has_no_thumbnail(&self, open: &OpenProject, frame: usize) -> bool {
        frame_ref(open, frame).is_some_and(|frame| self.thumbnails.has_failed(&frame))
    }

    /// How many of the thumbnails in view are there.
    #[must_use]
    pub const fn thumbnails_in_view(&self) -> ThumbnailProgress {
        self.in_view
    }

    /// Asks for what the window is about to show and takes in what has arrived. To be called before the panels.
    pub fn update(&mut self, app: &App, ctx: &egui::Context) -> Vec<Action> {
        let mut actions = Vec::new();
        for report in self.decoder.poll() {
            match report {
                DecoderReport::Notice(notice) => actions.push(Action::Notify(Level::Warning, notice.to_string())),
                DecoderReport::Panicked { frame, message } => {
                    actions.push(Action::Notify(
                        Level::Error,
                        format!("{frame}: internal error (please report it): {message}"),
                    ));
                }
                DecoderReport::Ready { .. } | DecoderReport::Failed { .. } | DecoderReport::Counting(_) => {}
            }
        }
        for report in self.thumbnails.poll() {
            if let ThumbnailReport::Ready { frame, picture } = report {
                let size = [picture.size().width as usize, picture.size().height as usize];
                let image = egui::ColorImage::from_rgba_unmultiplied(size, picture.rgba());
                let texture = ctx.load_texture(frame.to_string(), image, egui::TextureOptions::LINEAR);
                self.textures.put(frame, texture);
            }
        }
        self.ask(app.open(), app.session.frame);
        actions
    }

    /// Hands the wishes of this repaint to the maker of thumbnails. To be called after the panels.
    pub fn finish(&mut self) {
        let wanted = std::mem::take(&mut self.wanted);
        let asked = wanted.len();
        let missing: Vec<_> = wanted.into_iter().filter(|frame| !self.textures.contains(frame)).collect();
        let waiting = missing.iter().filter(|frame| !self.thumbnails.has_failed(frame)).count();
        self.in_view = ThumbnailProgress { done: asked - waiting, wanted: asked };
        self.thumbnails.request(&missing);
    }

    fn ask(&mut self, open: Option<&OpenProject>, index: usize) {
        let document = open.map(|open| &open.file);
        if document != self.document.as_ref() {
            self.document = document.cloned();
            self.decoder.clear();
            self.keys.clear();
            self.textures.clear();
            self.shown = None;
        }
        let Some((open, frame)) = open.and_then(|open| Some((open, frame_ref(open, index)?))) else {
            self.shown = None;
            self.state = PictureState::None;
            return;
        };
        if let Some((before, _)) = &self.shown
            && *before != index
        {
            self.direction = StepDirection::of_step(*before, index);
        }
        self.shown = Some((index, frame.clone()));
        let in_blocks = matches!(frame, FrameRef::Video { .. });
        let picture_bytes =
            open.frame(index).map_or(0, |frame| 4 * frame.image_size.width as usize * frame.image_size.height as usize);
        let options = PrefetchOptions { in_blocks, ..PrefetchOptions::default() }
            .within(self.decoder.cache_bytes(), picture_bytes);
        let plan = prefetch_plan(index, open.document.frames.len(), self.direction, options);
        let neighbours: Vec<_> = plan.into_iter().filter_map(|index| frame_ref(open, index)).collect();
        self.decoder.request(&frame, &neighbours);
        self.state = match self.decoder.state(&frame) {
            FrameState::Ready(picture) => PictureState::Ready(self.key(&frame), picture),
            FrameState::Failed(error) => PictureState::Failed(error.to_string()),
            FrameState::Pending | FrameState::Absent => PictureState::Loading,
        };
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

/// Where a frame's pixels come from.
fn frame_ref(open: &OpenProject, index: usize) -> Option<FrameRef> {
    open.frame(index)?.picture_source(&open.folder)
}
