//! Pictures of frames for the window: the shown one, and thumbnails as textures on the graphics
//! card.
//!
//! Decoding runs in the background ([`jobs::Pictures`]). In each frame of the window,
//! [`Pictures::update`] receives what has arrived, the panels ask for thumbnails, and
//! [`Pictures::finish`] requests those that are missing.

use egui::{Color32, CornerRadius, Painter, Pos2, Rect, TextureHandle, pos2};
use lru::LruCache;
use std::collections::BTreeSet;
use std::io;
use std::num::NonZeroUsize;
use touchline_application::app::{Action, App, OpenProject};
use touchline_application::jobs::{self, PictureState, SharedPictures, Wake, picture_source};
use touchline_vision::media::{FrameRef, Picture};

/// The texture coordinates of a whole texture.
pub const WHOLE: Rect = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));

/// Number of thumbnails that stay on the graphics card. A filmstrip shows about thirty.
const TEXTURES: NonZeroUsize = NonZeroUsize::MIN.saturating_add(599);

/// Pictures and thumbnails of the open document's frames.
pub struct Pictures {
    decoded: jobs::Pictures,
    textures: LruCache<FrameRef, egui::TextureHandle>,
    wanted: Vec<FrameRef>,
    in_view: ThumbnailProgress,
}

/// How many of the thumbnails in view are available.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThumbnailProgress {
    /// Number of those that are available or cannot be made.
    pub done: usize,
    /// Number of all in view.
    pub wanted: usize,
}

impl Pictures {
    /// Starts the decoder and the thumbnail job. `wake` requests a repaint when something has
    /// arrived.
    ///
    /// # Errors
    /// The operating system provides no thread.
    pub fn start(wake: Wake) -> io::Result<Self> {
        Ok(Self {
            decoded: jobs::Pictures::start(wake)?,
            textures: LruCache::new(TEXTURES),
            wanted: Vec::new(),
            in_view: ThumbnailProgress::default(),
        })
    }

    /// The decoded frames, for background work that needs them.
    pub fn shared_pictures(&self) -> SharedPictures {
        self.decoded.shared_pictures()
    }

    /// The picture of the shown frame, or its state.
    pub fn current(&self) -> PictureState {
        self.decoded.current()
    }

    /// The positions in the document of the frames that are decoded, in no order.
    pub fn decoded_frames(&self) -> Vec<usize> {
        self.decoded.decoded_frames()
    }

    /// The decoded picture of the frame nearest to a position in the document; see
    /// [`jobs::Pictures::nearest`].
    pub fn nearest(&mut self, place: usize) -> Option<(u64, Picture)> {
        self.decoded.nearest(place)
    }

    /// The thumbnail of a frame. If it is missing, it is requested at the end of this frame of the
    /// window.
    pub fn thumbnail(&mut self, open: &OpenProject, frame: usize) -> Option<egui::TextureHandle> {
        self.thumbnail_of(picture_source(open, frame)?)
    }

    pub fn thumbnail_of(&mut self, picture: FrameRef) -> Option<egui::TextureHandle> {
        // Available ones are counted as wanted, too, for the progress. To get one marks it as used
        // last, so that thumbnails in view are the last to be dropped.
        let texture = self.textures.get(&picture).cloned();
        self.wanted.push(picture);
        texture
    }

    /// Whether the thumbnail of a frame cannot be made.
    pub fn has_no_thumbnail(&self, open: &OpenProject, frame: usize) -> bool {
        picture_source(open, frame).is_some_and(|frame| self.decoded.has_no_thumbnail(&frame))
    }

    /// How many of the thumbnails in view were available in the last frame of the window.
    pub const fn thumbnails_in_view(&self) -> ThumbnailProgress {
        self.in_view
    }

    /// Requests the pictures that the window is about to show and receives what has arrived. Call
    /// it before the panels are drawn.
    pub fn update(&mut self, app: &App, ctx: &egui::Context) -> Vec<Action> {
        let news = self.decoded.update(app);
        // Another document was opened: the textures of the previous one are of no use.
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

    /// Requests the thumbnails that the panels want. Call it after the panels are drawn.
    pub fn finish(&mut self) {
        // Two lists may show the same picture, which is requested and counted once.
        let mut seen = BTreeSet::new();
        let mut wanted = std::mem::take(&mut self.wanted);
        wanted.retain(|frame| seen.insert(frame.clone()));
        let num_wanted = wanted.len();
        let missing: Vec<_> = wanted
            .into_iter()
            .filter(|frame| !self.textures.contains(frame))
            .collect();
        // A thumbnail that cannot be made does not count as missing.
        let waiting = missing
            .iter()
            .filter(|frame| !self.decoded.has_no_thumbnail(frame))
            .count();
        self.in_view = ThumbnailProgress {
            done: num_wanted - waiting,
            wanted: num_wanted,
        };
        self.decoded.request_thumbnails(&missing);
    }
}

/// The texture of an encoded picture that the program carries; none if it cannot be decoded.
pub fn decode_texture(
    ctx: &egui::Context,
    name: &str,
    bytes: &[u8],
) -> Option<egui::TextureHandle> {
    let picture = image::load_from_memory(bytes).ok()?.into_rgb8();
    let size = [picture.width() as usize, picture.height() as usize];
    let pixels = egui::ColorImage::from_rgb(size, picture.as_raw());
    Some(ctx.load_texture(name, pixels, egui::TextureOptions::LINEAR))
}

/// Draws a thumbnail so that it fills a box; what is longer than the box is cut. Without a
/// thumbnail the box is empty.
pub fn paint_filling(
    painter: &Painter,
    picture: Option<TextureHandle>,
    place: Rect,
    ground: Color32,
) {
    painter.rect_filled(place, CornerRadius::same(2), ground);
    let Some(picture) = picture else { return };
    let shape = picture.size_vec2();
    // `cut` is the scale at which the shorter side fills the box, `shown` the part of the picture
    // that is then within the box, in texture coordinates.
    let cut = (place.size() / shape).max_elem();
    let shown = place.size() / (shape * cut);
    let seen = Rect::from_center_size(pos2(0.5, 0.5), shown);
    painter.image(picture.id(), place, seen, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::sync::Arc;

    #[test]
    fn a_thumbnail_in_two_lists_counts_once() {
        let mut pictures = Pictures::start(Arc::new(|| ())).unwrap();
        for name in ["a.png", "b.png", "a.png"] {
            let picture = FrameRef::image(Path::new(name));
            assert!(pictures.thumbnail_of(picture).is_none());
        }
        pictures.finish();
        let expected = ThumbnailProgress { done: 0, wanted: 2 };
        assert_eq!(pictures.thumbnails_in_view(), expected);
    }
}
