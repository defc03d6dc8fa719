//! Import of foreign cameras as a document.

use super::camera_format::CameraFormat;
use super::error::ExchangeError;
use super::files::Files;
use super::format::Format;
use super::frame_camera::Shown;
use super::imported::Imported;
use super::into_document::camera_of;
use super::options::ImportOptions;
use super::picture_size::{FittedSizes, SizeSource, fit_to_picture};
use super::pictures::image_of;
use super::values::clipped;
use crate::document::{path_between, resolved};
use std::collections::BTreeSet;
use std::path::Path;
use touchline_core::geometry::ImageSize;

/// Reads a file or folder of cameras as a document of solved frames.
///
/// # Errors
/// It cannot be read, is damaged, or the size of a picture is not known.
pub fn import_cameras(
    path: &Path,
    folder: &Path,
    format: Format,
    camera_format: &dyn CameraFormat,
    options: &ImportOptions,
) -> Result<Imported, ExchangeError> {
    let files = Files::read(path, &|name| camera_format.is_wanted(name))?;
    if files.is_empty() {
        return Err(ExchangeError::NoFiles {
            path: path.to_path_buf(),
            wanted: camera_format.wanted(),
        });
    }
    let mut frames = camera_format.read(&files, options)?;
    if frames.is_empty() {
        return Err(ExchangeError::NoFiles {
            path: path.to_path_buf(),
            wanted: "frame",
        });
    }
    let images = options
        .images
        .as_ref()
        .map_or_else(|| folder.to_path_buf(), |images| resolved(images));
    let mut names = BTreeSet::new();
    let mut sizes_by = SizesBy::default();
    let mut views = Vec::with_capacity(frames.len());
    let mut fitted = 0_usize;
    let mut fitted_sizes = FittedSizes::default();
    for frame in &mut frames {
        if !names.insert(frame.name.clone()) {
            return Err(ExchangeError::SameFrame {
                path: path.to_path_buf(),
                name: clipped(&frame.name),
            });
        }
        let (file, known) = image_of(frame.image.as_deref().unwrap_or(&frame.name), &images);
        let size = sizes_by.choose(known, options.size, frame.size, camera_format.size_source());
        let size = size.ok_or(ExchangeError::OptionNeeded {
            format,
            what: "the size of its pictures",
            option: "--size WIDTHxHEIGHT or --images FOLDER",
        })?;
        let (fit, factor) =
            fit_to_picture(frame, size, camera_format.size_source()).ok_or_else(|| {
                let stated = frame.size.unwrap_or(size);
                ExchangeError::OtherProportions {
                    frame: clipped(&frame.name),
                    stated,
                    picture: size,
                }
            })?;
        if let Some(stated) = frame.size.filter(|_| factor != 1.0) {
            fitted_sizes.count(stated, size);
        }
        *frame = fit;
        if frame.image.is_some() || frame.frame_index.is_none() {
            frame.image = Some(path_between(folder, &images.join(file)));
        }
        frame.video = frame
            .video
            .as_ref()
            .map(|video| path_between(folder, &images.join(video)));
        fitted += usize::from(matches!(frame.shown, Shown::Ground(_)));
        let view = camera_of(frame, size).map_err(|source| ExchangeError::NoCamera {
            path: path.to_path_buf(),
            frame: clipped(&frame.name),
            source,
        })?;
        let view = view
            .checked("the camera")
            .map_err(|problem| problem.within(&clipped(&frame.name)))?;
        views.push((frame.clone(), size, view));
    }
    let mut notes = sizes_by.notes();
    notes.extend(fitted_sizes.note());
    notes.extend(camera_format.unread(&files));
    if fitted > 0 {
        notes.push(format!(
            "{fitted} cameras were fitted to homographies, with the principal point in the middle and no distortion"
        ));
    }
    let document = camera_format.document(options.field.clone(), &views);
    Ok(Imported {
        document,
        folder: folder.to_path_buf(),
        notes,
    })
}

/// Counts the sources of the picture sizes.
#[derive(Default)]
struct SizesBy {
    option: usize,
    format: usize,
    assumed: usize,
    /// The first assumed size.
    assumed_size: Option<ImageSize>,
}

impl SizesBy {
    /// The image's own size, else the given one, else the one stated by the format.
    fn choose(
        &mut self,
        image: Option<ImageSize>,
        given: Option<ImageSize>,
        format: Option<ImageSize>,
        source: SizeSource,
    ) -> Option<ImageSize> {
        if image.is_some() {
            return image;
        }
        if given.is_some() {
            self.option += 1;
            return given;
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
            (self.format, "what the files say (their images are missing)"),
            (self.assumed, &assumed),
        ];
        let said = said.into_iter().filter(|(count, _)| *count > 0);
        said.map(|(count, by)| format!("the picture size of {count} frames is {by}"))
            .collect()
    }
}
