//! Sources of frames: folders of images, and videos.
//!
//! | what | where |
//! |---|---|
//! | [`Picture`] | decoded pixels, cheap to clone |
//! | [`load_image`], [`image_size`], [`list_images`] | image files: PNG, JPEG, TIFF, BMP, WebP; EXIF orientation applied |
//! | [`Video`], [`VideoInfo`] | frames of a video by their index among the frames that decode (through `ffmpeg`, or OpenCV if built in) |
//! | `VideoWriter` | a video, written frame by frame (through `ffmpeg`) |
//! | [`FrameSource`], [`FrameRef`], [`FrameReader`] | a folder or a video; one of its frames; reading of frames |
//! | [`FrameStream`] | a list of frames, read in order |
//! | [`CachedReader`] | reading of frames several times that decodes them once, within a byte budget |
//! | `FrameCache`, [`prefetch_plan`] | decoded frames within a byte budget; which neighbours to decode next |
//! | [`letterbox`] | thumbnails |
//! | [`Notice`] | remarks for the user about a usable source |
//!
//! Nothing here starts a background thread; background work is in `jobs`.
//!
//! Pixel coordinates of pictures follow [`touchline_core::conventions`].

mod cached_reader;
mod digest;
mod error;
mod grey;
mod image_file;
mod jpeg_end;
mod notice;
mod picture;
mod prefetch;
mod reader;
mod source;
mod stream;
mod thumbnail;
mod video;

pub use error::MediaError;
pub(crate) use error::one_line;
pub(crate) use grey::{GreyPicture, grey_reduced};
pub use notice::Notice;
pub use picture::Picture;
pub use reader::{FrameReader, ReadFrames};
pub use source::FrameRef;
pub use video::{CountProgress, FrameClock, Video, VideoBackend, VideoInfo};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    cached_reader::{CachedReader, FrameCache, KEPT_BYTES},
    digest::{sha256_of_bytes, sha256_of_file, video_file_id},
    image_file::{ImageLimits, image_size, load_image, load_image_within},
    prefetch::{PrefetchOptions, StepDirection, prefetch_plan},
    source::{FolderListing, FrameSource, has_image_extension, list_images},
    stream::{FrameStream, StreamedFrame},
    thumbnail::{THUMBNAIL_SIZE, letterbox},
    video::VideoWriter,
};
