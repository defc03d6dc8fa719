//! Import of foreign cameras as a document.

use super::imported::Imported;
use super::pictures::{image_of, refuse_shared_pictures};
use crate::document::path_between;
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Unreadable};
use crate::exchange::cameras::into_document::{View, camera_of};
use crate::exchange::cameras::picture_size::{FittedSizes, SizeSource, fit_to_picture};
use crate::exchange::cameras::unreadable::{add_unsolved, note_unreadable};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, no_files};
use crate::exchange::format::Format;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::values::shorten;
use std::collections::BTreeSet;
use std::path::Path;
use touchline_core::geometry::{ImageSize, pluralise};

/// Reads a file or folder of cameras as a document of solved frames. Frames whose camera cannot be
/// read are in it without one.
///
/// # Errors
/// It cannot be read, no frame has a camera, or the size of a picture is not known.
pub fn import_cameras(
    path: &Path,
    folder: &Path,
    format: Format,
    camera_format: &dyn CameraFormat,
    options: &ImportOptions,
) -> Result<Imported, ExchangeError> {
    let files = Files::read_some(
        path,
        &|name| camera_format.is_wanted(name),
        camera_format.about().files,
    )?;
    // Formats that state no size read pixels with that of the options, or of the video to which the
    // frames may be attached; which one a frame gets at last is decided below.
    // A format that needs the size of the field reads a template of the user's own, which lies where
    // the new document does.
    let reading = options.with_any_size().with_template_in(folder);
    let mut frames = camera_format.read(&files, &reading)?;
    if frames.is_empty() {
        return Err(no_files(path, "frame"));
    }
    refuse_repeated(&frames, path)?;
    let images = options.images_folder(folder);
    let mut reader = ViewReader {
        path,
        format,
        source: camera_format.size_source(),
        options,
        sizes_by: SizesBy::default(),
        fitted_sizes: FittedSizes::default(),
        fitted: 0,
    };
    let mut views = Vec::with_capacity(frames.len());
    let mut sizes = Vec::with_capacity(frames.len());
    let mut first_error = None;
    // Each frame gets a path that leads from the document's folder to its picture, whether or not
    // the picture exists, the size of that picture, and a camera in its pixels.
    for frame in &mut frames {
        let (file, known) = image_of(frame.image.as_deref().unwrap_or(&frame.name), &images);
        // A frame with a number and no image is of a video only; the name of a file would be an
        // invention.
        if frame.image.is_some() || frame.frame_index.is_none() {
            frame.image = Some(path_between(folder, &images.join(file)));
        }
        frame.video = frame
            .video
            .as_ref()
            .map(|video| path_between(folder, &images.join(video)));
        sizes.push(known.or(options.size).or(options.video_size));
        // Its size is noted above all the same: such a frame is in the document without a camera.
        if frame.unreadable.is_some() {
            continue;
        }
        // One frame that fits no camera costs that frame alone, like a damaged file. A size that is
        // not known or has other proportions is an error of the whole import, because it would
        // concern every frame.
        match reader.view(frame, known)? {
            Ok(view) => views.push(view),
            Err(error) => {
                first_error.get_or_insert(error);
            }
        }
    }
    // The reason of the first frame tells the user more than that all failed.
    if let Some(error) = first_error.filter(|_| views.is_empty()) {
        return Err(error);
    }
    let mut notes = reader.notes();
    notes.extend(note_unreadable(&frames));
    notes.extend(camera_format.unread(&files));
    let mut document = camera_format.document(options.field.clone(), &views);
    if views.len() < frames.len() {
        add_unsolved(&mut document, &frames, &sizes);
    }
    refuse_shared_pictures(&document, path)?;
    Ok(Imported {
        document,
        folder: folder.to_path_buf(),
        format,
        notes,
    })
}

impl ImportOptions {
    /// The options with the whole path of a template of the user's own, whose relative path starts
    /// from a folder.
    #[must_use]
    pub fn with_template_in(mut self, folder: &Path) -> Self {
        if self.field.is_file() {
            let template = folder.join(&self.field.template);
            self.field.template = template.to_string_lossy().into_owned();
        }
        self
    }
}

/// Refuses two frames of one name.
fn refuse_repeated(frames: &[FrameCamera], path: &Path) -> Result<(), ExchangeError> {
    let mut names = BTreeSet::new();
    match frames.iter().find(|frame| !names.insert(&frame.name)) {
        Some(frame) => Err(ExchangeError::SameFrame {
            path: path.to_path_buf(),
            name: shorten(&frame.name),
        }),
        None => Ok(()),
    }
}

/// Makes frames into views of pictures of known size, and counts what a user should know.
struct ViewReader<'a> {
    path: &'a Path,
    format: Format,
    source: SizeSource,
    options: &'a ImportOptions,
    sizes_by: SizesBy,
    fitted_sizes: FittedSizes,
    /// The cameras that were fitted to homographies.
    fitted: usize,
}

impl ViewReader<'_> {
    /// A frame with its camera, for a picture of a known size or that of the options. Where no
    /// camera fits its numbers, the frame gets the reason, and the inner error is it.
    ///
    /// # Errors
    /// The size of the picture is not known, or has other proportions.
    fn view(
        &mut self,
        frame: &mut FrameCamera,
        known: Option<ImageSize>,
    ) -> Result<Result<View, ExchangeError>, ExchangeError> {
        // The camera in px of its picture, which may be of another size than the one that the
        // camera was made for.
        let size = self.size_of(frame, known)?;
        let (fit, factor) = fit_to_picture(frame, size, self.source).ok_or_else(|| {
            ExchangeError::OtherProportions {
                frame: shorten(&frame.name),
                stated: frame.size.unwrap_or(size),
                picture: size,
            }
        })?;
        if let Some(stated) = frame.size.filter(|_| factor != 1.0) {
            self.fitted_sizes.count(stated, size);
        }
        // A homography gives a camera only by a fit, which `validate` must check, too: it may place
        // the camera anywhere.
        let made = camera_of(&fit, size).map_err(|source| ExchangeError::NoCamera {
            path: self.path.to_path_buf(),
            frame: shorten(&frame.name),
            source,
        });
        let checked = made.and_then(|view| {
            view.validate("the camera")
                .map_err(|problem| problem.within(&shorten(&frame.name)))
        });
        Ok(match checked {
            Ok(view) => {
                self.fitted += usize::from(matches!(fit.shown, FrameProjection::Ground(_)));
                Ok((fit, size, view))
            }
            Err(error) => {
                frame.unreadable = Some(Unreadable {
                    file: None,
                    problem: reason_of(&error),
                });
                Err(error)
            }
        })
    }

    /// The size of a frame's picture.
    fn size_of(
        &mut self,
        frame: &FrameCamera,
        known: Option<ImageSize>,
    ) -> Result<ImageSize, ExchangeError> {
        let sizes = KnownSizes {
            image: known,
            given: self.options.size,
            // A video of other proportions is not the one of these cameras; the size that the
            // format states is then the better one.
            video: self
                .options
                .video_size
                .filter(|size| fit_to_picture(frame, *size, self.source).is_some()),
            format: frame.size,
        };
        let size = self.sizes_by.choose(sizes, self.source);
        size.ok_or(ExchangeError::OptionNeeded {
            format: self.format,
            what: "the size of its pictures",
            option: "--size WIDTHxHEIGHT or --images FOLDER",
        })
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.sizes_by.notes();
        notes.extend(self.fitted_sizes.note());
        if self.fitted > 0 {
            notes.push(format!(
                "{} fitted to homographies, with the principal point in the middle and no distortion",
                pluralise(self.fitted, "camera")
            ));
        }
        notes
    }
}

/// Why a frame has no camera, without the file and frame that a note names anyway.
fn reason_of(error: &ExchangeError) -> String {
    match error {
        ExchangeError::NoCamera { source, .. } => source.to_string(),
        ExchangeError::File { problem, .. } => problem.to_string(),
        other => other.to_string(),
    }
}

/// The sizes that a picture may have.
#[derive(Clone, Copy)]
struct KnownSizes {
    /// That of the image itself.
    image: Option<ImageSize>,
    /// That of the user.
    given: Option<ImageSize>,
    /// That of the video to which frames may be attached.
    video: Option<ImageSize>,
    /// That of the format.
    format: Option<ImageSize>,
}

/// Counts the sources of the picture sizes.
#[derive(Default)]
struct SizesBy {
    option: usize,
    video: usize,
    format: usize,
    assumed: usize,
    /// The first assumed size.
    assumed_size: Option<ImageSize>,
}

impl SizesBy {
    /// The image's own size, else the given one, else that of the video, else the one stated by the
    /// format.
    fn choose(&mut self, sizes: KnownSizes, source: SizeSource) -> Option<ImageSize> {
        // The picture itself is the surest source, and needs no note. All others are said, because
        // a wrong size scales every focal length.
        let KnownSizes {
            image,
            given,
            video,
            format,
        } = sizes;
        if image.is_some() {
            return image;
        }
        if given.is_some() {
            self.option += 1;
            return given;
        }
        if video.is_some() {
            self.video += 1;
            return video;
        }
        let count = if source == SizeSource::Assumed {
            &mut self.assumed
        } else {
            &mut self.format
        };
        *count += usize::from(format.is_some());
        self.assumed_size = self.assumed_size.or(format);
        format
    }

    fn notes(&self) -> Vec<String> {
        let ImageSize { width, height } = self.assumed_size.unwrap_or(ImageSize::new(0, 0));
        let assumed = format!(
            "assumed, as that of the set ({width} × {height}); --size WIDTHxHEIGHT gives another"
        );
        let said = [
            (self.option, "given by --size"),
            (self.video, "that of the video"),
            (self.format, "what the files say (their images are missing)"),
            (self.assumed, &assumed),
        ];
        let said = said.into_iter().filter(|(count, _)| *count > 0);
        said.map(|(count, by)| format!("the picture size of {} is {by}", pluralise(count, "frame")))
            .collect()
    }
}
