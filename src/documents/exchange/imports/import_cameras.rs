//! Import of foreign cameras as a document.

use super::imported::Imported;
use super::pictures::{image_of, name_tracks, refuse_shared_pictures};
use super::places::names_video;
use crate::document::{Camera, CameraId, Document, FrameStatus, path_between};
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::cameras::common_base::find_common_bases;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole, Unreadable};
use crate::exchange::cameras::ground_fit::misfit_px;
use crate::exchange::cameras::into_document::{View, camera_of};
use crate::exchange::cameras::one_place::put_on_one_place;
use crate::exchange::cameras::picture_size::{FittedSizes, SizeSource, fit_to_picture};
use crate::exchange::cameras::unreadable::{add_unsolved, describe_unreadable_frames};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, no_files};
use crate::exchange::format::Format;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::values::shorten;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, pluralise};

/// A camera that was fitted to a homography may show the field this far from where that does, px.
const MOST_MISFIT_PX: f64 = 2.0;

/// A camera lower than this stands under the ground; one on the touchline may be a little below the
/// middle of a crowned field.
const UNDER_GROUND_M: f64 = -0.5;

/// A difference of cameras that is worth a note, px.
const SEEN_PX: f64 = 1e-2;

/// The distance at which cameras are compared, m.
const FAR_M: f64 = 100.0;

/// Misfits that are named; of further ones the number is.
const MOST_NAMED_MISFITS: usize = 10;

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
    let in_tracks = name_tracks(&mut frames, path);
    let mut reader = ViewReader {
        path,
        format,
        source: camera_format.size_source(),
        options,
        sizes_by: SizesBy::default(),
        field: reading.field.model(Path::new("")).ok(),
        fitted_sizes: FittedSizes::default(),
        fitted: 0,
        misfits: Vec::new(),
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
        if let Some(video) = frame.video.as_mut().filter(|video| names_video(video)) {
            *video = path_between(folder, &images.join(&*video));
        }
        sizes.push(known.or_else(|| options.picture_size()));
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
    let misfits = reader.describe_misfits();
    notes.extend(nearest_camera_note(&frames));
    notes.extend(under_ground_note(&views));
    notes.extend(remark_notes(&frames));
    notes.extend(camera_format.unread(&files));
    if in_tracks > 0 && options.video_size.is_none() {
        notes.push(format!(
            "{} of a video that the file does not name; --video VIDEO says which",
            pluralise(in_tracks, "frame")
        ));
    }
    let given: Vec<Pinhole> = views.iter().map(|(_, _, view)| *view).collect();
    notes.extend(find_common_bases(&mut views, camera_format.exactness()));
    put_on_one_place(&mut views);
    let mut document = camera_format.document(options.field.clone(), &views);
    notes.extend(moved_note(&document, &given));
    if views.len() < frames.len() {
        add_unsolved(&mut document, &frames, &sizes);
    }
    refuse_shared_pictures(&document, path)?;
    Ok(Imported {
        document,
        folder: folder.to_path_buf(),
        format,
        notes,
        failures: describe_unreadable_frames(&frames)
            .into_iter()
            .chain(misfits)
            .collect(),
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

/// The note about frames that the document shows a little otherwise than the file, because their
/// cameras waver about a place.
fn moved_note(document: &Document, given: &[Pinhole]) -> Option<String> {
    let cameras: BTreeMap<&CameraId, &Camera> = document
        .cameras
        .iter()
        .map(|camera| (&camera.id, &**camera))
        .collect();
    // The document has the cameras that were read in their order.
    let off_px = document
        .frames
        .iter()
        .zip(given)
        .filter_map(|(frame, given)| {
            let made = cameras.get(&frame.camera)?.ptz_camera(frame)?;
            Some(corners_off_px(
                &made,
                &given.ptz_camera()?,
                frame.image_size,
            ))
        });
    let seen: Vec<f64> = off_px.filter(|off_px| *off_px > SEEN_PX).collect();
    let worst_px = seen.iter().copied().reduce(f64::max)?;
    Some(format!(
        "{} waver about their place by a hair, which is left out: at most {worst_px:.3} px",
        pluralise(seen.len(), "camera")
    ))
}

/// How far two cameras show points at the corners of a picture apart at most, px.
fn corners_off_px(a: &PtzCamera, b: &PtzCamera, size: ImageSize) -> f64 {
    let (right, bottom) = (f64::from(size.width), f64::from(size.height));
    let corners = [[0.0, 0.0], [right, 0.0], [0.0, bottom], [right, bottom]];
    let off_px = corners.into_iter().filter_map(|[x, y]| {
        let corner = ImagePoint::new(x, y);
        let point = b.base().position_m + b.world_direction_from_image(corner).ok()? * FAR_M;
        Some(a.image_from_world(point).ok()?.distance_px(corner))
    });
    off_px.fold(0.0, f64::max)
}

/// The notes about how files are taken, with how many frames each is of.
fn remark_notes(frames: &[FrameCamera]) -> Vec<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for remark in frames.iter().filter_map(|frame| frame.remark) {
        *counts.entry(remark).or_default() += 1;
    }
    let counts = counts.into_iter();
    counts
        .map(|(remark, count)| format!("{}: {remark}", pluralise(count, "camera")))
        .collect()
}

/// The note about cameras that stand under the ground: an axis is another way round.
fn under_ground_note(views: &[View]) -> Option<String> {
    let mut below = views
        .iter()
        .filter(|(_, _, view)| view.position_m.z < UNDER_GROUND_M);
    let (frame, _, view) = below.next()?;
    Some(format!(
        "{} under the ground, the first {} at z = {:.1} m: check the direction of the axes, \
         above all of y",
        pluralise(1 + below.count(), "camera"),
        shorten(&frame.name),
        view.position_m.z
    ))
}

/// The note about cameras that are not quite those of the files, by a skew or another law of the
/// lens.
fn nearest_camera_note(frames: &[FrameCamera]) -> Option<String> {
    let off = frames.iter().filter(|frame| frame.off_px > 0.0);
    let farthest = off.clone().max_by(|a, b| a.off_px.total_cmp(&b.off_px))?;
    let off_px = if farthest.off_px < 1e-3 {
        "less than 0.001".to_owned()
    } else {
        format!("{:.3}", farthest.off_px)
    };
    Some(format!(
        "the skew or the lens of {} is not quite that of a document: the nearest camera is \
         taken, at most {off_px} px off, in {}",
        pluralise(off.count(), "camera"),
        shorten(&farthest.name)
    ))
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
    /// The field that the frames show.
    field: Option<FieldModel>,
    /// The cameras that were fitted to homographies.
    fitted: usize,
    /// Those of them that show the field elsewhere than their homographies do, with how far, px.
    misfits: Vec<(String, f64)>,
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
                what: "the camera",
                frame: shorten(&frame.name),
                stated: frame.size.unwrap_or(size),
                picture: size,
            }
        })?;
        if let Some(stated) = frame.size.filter(|_| factor != 1.0) {
            self.fitted_sizes.count(stated, size);
        }
        let (fit, size) = match known {
            None => self.fit_to_video(fit, size),
            Some(_) => (fit, size),
        };
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
                let mut fit = fit;
                if let FrameProjection::Ground(ground) = fit.shown {
                    self.fitted += 1;
                    let off_px = self.misfit_px(&ground, &view, size);
                    if off_px > MOST_MISFIT_PX {
                        // A person has to look at it before it counts.
                        fit.record.status = FrameStatus::Draft;
                        self.misfits.push((frame.name.clone(), off_px));
                    }
                }
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

    /// A camera for pictures of a size, in those of the video if it has the same proportions.
    fn fit_to_video(&mut self, fit: FrameCamera, size: ImageSize) -> (FrameCamera, ImageSize) {
        let stated = FrameCamera {
            size: Some(size),
            ..fit
        };
        let video = self.options.video_to_fit(size);
        let in_video = video.and_then(|video| {
            let (in_video, _) = fit_to_picture(&stated, video, SizeSource::Stated)?;
            Some((in_video, video))
        });
        let Some((in_video, video)) = in_video else {
            return (stated, size);
        };
        self.fitted_sizes.count(size, video);
        (in_video, video)
    }

    /// How far a camera shows the field from where its homography does at most, px.
    fn misfit_px(&self, ground: &Mat3, view: &Pinhole, size: ImageSize) -> f64 {
        let field = self.field.as_ref();
        field
            .and_then(|field| misfit_px(ground, view, size, field))
            .unwrap_or(0.0)
    }

    /// What is said of cameras that do not fit their homographies, frame by frame.
    fn describe_misfits(&self) -> Vec<String> {
        let mut said: Vec<String> = self
            .misfits
            .iter()
            .take(MOST_NAMED_MISFITS)
            .map(|(name, off_px)| {
                format!(
                    "{}: no camera with the principal point in the middle shows this homography; \
                     the nearest is {off_px:.0} px off \
                     over the visible field, and the frame is a draft: check direction, unit and the picture's size (--size)",
                    shorten(name)
                )
            })
            .collect();
        let others = self.misfits.len().saturating_sub(MOST_NAMED_MISFITS);
        if others > 0 {
            said.push(format!("and {} more like that", pluralise(others, "frame")));
        }
        said
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
        notes.extend(self.fitted_sizes.note("camera"));
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
