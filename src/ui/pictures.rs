//! Pictures of frames as the window draws them: the shown one, and thumbnails on the graphics card.

use lru::LruCache;
use std::io;
use std::num::NonZeroUsize;
use touchline_application::app::{Action, App, OpenProject};
use touchline_application::jobs::{self, PictureState, SharedPictures, Wake, picture_source};
use touchline_vision::media::{FrameRef, Picture};

/// How many thumbnails stay on the GPU; a filmstrip shows about thirty.
const TEXTURES: NonZeroUsize = NonZeroUsize::MIN.saturating_add(599);

/// Pictures and thumbnails of the open document's frames.
pub struct Pictures {
    decoded: jobs::Pictures,
    textures: LruCache<FrameRef, egui::TextureHandle>,
    wanted: Vec<FrameRef>,
    in_view: ThumbnailProgress,
}

/// How many of the visible thumbnails are available.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThumbnailProgress {
    /// Available, or known to fail.
    pub done: usize,
    /// All that are visible.
    pub wanted: usize,
}

impl Pictures {
    /// Starts the decoder and the maker of thumbnails; `wake` asks for a repaint.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn start(wake: Wake) -> io::Result<Self> {
        Ok(Self {
            decoded: jobs::Pictures::start(wake)?,
            textures: LruCache::new(TEXTURES),
            wanted: Vec::new(),
            in_view: ThumbnailProgress::default(),
        })
    }

    /// The decoded frames, for the jobs that need some of them.
    #[must_use]
    pub fn shared(&self) -> SharedPictures {
        self.decoded.shared()
    }

    /// The shown frame's picture.
    #[must_use]
    pub fn current(&self) -> PictureState {
        self.decoded.current()
    }

    /// The places of the frames that are decoded, in no order.
    #[must_use]
    pub fn decoded(&self) -> Vec<usize> {
        self.decoded.decoded()
    }

    /// The decoded picture nearest to a place: see [`jobs::Pictures::nearest`].
    pub fn nearest(&mut self, place: usize) -> Option<(u64, Picture)> {
        self.decoded.nearest(place)
    }

    /// A frame's thumbnail; if it is not there yet it is made in the background.
    pub fn thumbnail(&mut self, open: &OpenProject, frame: usize) -> Option<egui::TextureHandle> {
        let frame = picture_source(open, frame)?;
        self.wanted.push(frame.clone());
        self.textures.get(&frame).cloned()
    }

    /// Whether a frame's thumbnail cannot be made.
    #[must_use]
    pub fn has_no_thumbnail(&self, open: &OpenProject, frame: usize) -> bool {
        picture_source(open, frame).is_some_and(|frame| self.decoded.has_no_thumbnail(&frame))
    }

    /// How many of the visible thumbnails are available.
    #[must_use]
    pub const fn thumbnails_in_view(&self) -> ThumbnailProgress {
        self.in_view
    }

    /// Requests what the window is about to show and receives what has arrived. To be called before
    /// the panels.
    pub fn update(&mut self, app: &App, ctx: &egui::Context) -> Vec<Action> {
        let news = self.decoded.update(app);
        if news.forget {
            self.textures.clear();
        }
        for (frame, picture) in news.thumbnails {
            let size = [
                picture.size().width as usize,
                picture.size().height as usize,
            ];
            let image = egui::ColorImage::from_rgba_unmultiplied(size, picture.rgba());
            let texture = ctx.load_texture(frame.to_string(), image, egui::TextureOptions::LINEAR);
            self.textures.put(frame, texture);
        }
        news.actions
    }

    /// Sends this repaint's requests to the thumbnail job. To be called after the panels.
    pub fn finish(&mut self) {
        let wanted = std::mem::take(&mut self.wanted);
        let asked = wanted.len();
        let missing: Vec<_> = wanted
            .into_iter()
            .filter(|frame| !self.textures.contains(frame))
            .collect();
        let waiting = missing
            .iter()
            .filter(|frame| !self.decoded.has_no_thumbnail(frame))
            .count();
        self.in_view = ThumbnailProgress {
            done: asked - waiting,
            wanted: asked,
        };
        self.decoded.request_thumbnails(&missing);
    }
}
