//! Mending cameras that another program gave, frame by frame, for a video.
//!
//! # Problem
//!
//! A program with trained weights gives a camera for each frame. Most are right within a few
//! pixels, some are tens of pixels off over a stretch, some are absurd (a focal length of three
//! million pixels, a camera under the pitch, a mirrored field), and each has a position of its own.
//! Wanted: one camera that stands still, and for each frame pan, tilt and focal length on the
//! painted lines, or no camera.
//!
//! # Method
//!
//! 1. **Plausibility** (`given.rs`). Implausible cameras are set aside and named.
//! 2. **Places** (`places.rs`). The position, the rotation of the head and the lens that the
//!    cameras of a shot have in common ([`shared_places`]). A shot with no common place (a close-up
//!    whose cameras were invented) is left alone.
//! 3. **Common errors** (`hypotheses.rs`). If few of a sample of frames can be aligned to their
//!    paint, the cameras may be wrong alike: without their lens, mirrored, or meant for the frames
//!    before or after. Each hypothesis is tested on the same sample.
//! 4. **Base on paint.** Each camera is turned and zoomed on the common place so that its ground
//!    stays where it was in the picture, and aligned to the painted lines; base, lens and (where it
//!    is only assumed) the size of the field are estimated from the paint of all frames
//!    ([`estimate_on_paint`]), and the frames are aligned again.
//! 5. **Tracking.** Frames that could not be aligned lose their camera and get one from their
//!    neighbours ([`track_clip`](crate::calibrate::track_clip)), which compares every frame with
//!    its paint; frames that were tracked or are then in doubt are compared with the cameras that
//!    came out of the last adjustment.
//!
//! Without pictures only the numbers can be compared (`numbers_only.rs`).
//!
//! # Robustness
//!
//! Robust against absurd cameras, stretches that are wrong alike, positions that scatter, a lens
//! that the program ignored. Every frame keeps the camera that it came with in
//! `solution.imported`. Not robust against a shot in which most cameras are wrong by more than
//! 50 px in different ways.
//!
//! # Figures
//!
//! `tests/benches/mend.md`.

mod by_frame;
mod clips_in_time;
mod common_error;
mod given;
mod hypotheses;
mod kept;
mod mended;
mod numbers_only;
mod places;
mod survey;
mod tails;

pub use common_error::CommonError;
pub use given::{GivenCamera, GivenFault};
pub use kept::{MENDED, NO_PLACE};
pub use mended::{Mended, MendedFrame, NotAligned, Outcome, Tally};
pub use numbers_only::{LeftFrame, MendedNumbers, mend_numbers};
pub use survey::{CameraSurvey, ImpossibleCamera, survey_cameras};

use super::track_clips::{TrackingEvent, TrackingOptions, track_clips};
use crate::calibrate::{
    AT_ONCE, BaseOnPaintError, check_frame, clips, estimate_on_paint, record_line_check, withdraw,
};
use crate::proposals::{FramePicture, PictureStream, read_picture};
use given::given_cameras;
use hypotheses::{Corrected, Sample, Test};
use mended::compare_frames;
use places::Shots;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;
use thiserror::Error;
use touchline_core::field::FieldError;
use touchline_core::markings::LineVerdict;
use touchline_core::progress::{Progress, Share};
use touchline_core::solve::base::{BaseOptions, SharedPlace};
use touchline_documents::document::{Camera, CameraId, Document, FieldSize, Fields, Frame};
use touchline_vision::media::ReadFrames;
use touchline_vision::paint::LineCheck;
use touchline_vision::track::find_cuts;

/// The least 1-σ of the place of given cameras, m. Paint of both halves of a field determines a
/// position to 0.1 m, that of one end through a long lens to 1 m or worse. There the given cameras
/// know better, but all of them may be wrong alike.
const PLACE_SIGMA_M: f64 = 0.5;

/// Options of mending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MendOptions {
    /// By how many frames the given cameras may be shifted against the video, the likeliest first.
    /// The painted lines decide. Only 0 by default.
    pub shifts: Vec<i64>,
}

impl Default for MendOptions {
    fn default() -> Self {
        Self { shifts: vec![0] }
    }
}

/// Events while cameras are mended.
#[derive(Debug)]
pub enum MendEvent {
    /// Pictures are compared with their predecessors to find cuts.
    Cuts(Share),
    /// The places that the cameras share were found; empty if they share none.
    Places(Vec<SharedPlace>),
    /// Hypotheses about common errors are tested: pictures done.
    Sampling(Share),
    /// Base, lens and frames are being aligned to the painted lines: pictures done.
    Aligning(CameraId, Share),
    /// Frames are being tracked.
    Tracking(TrackingEvent),
    /// Frames that were tracked or are in doubt are compared with their paint: pictures done.
    Checking(Share),
}

/// Why cameras could not be mended.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MendError {
    /// No frame has a camera.
    #[error("no frame has a camera to mend; import the cameras first")]
    NoCamera,
    /// All given cameras are implausible.
    #[error(
        "none of the {cameras} cameras is possible (the first: {first}); check the format and the units"
    )]
    NonePossible {
        /// Number of given cameras.
        cameras: usize,
        /// What is wrong with the first of them.
        first: GivenFault,
    },
    /// The plausible cameras have no position in common.
    #[error(
        "the {cameras} possible cameras do not agree on a place where a camera stands; \
         label some frames by hand, or search the camera without clicks"
    )]
    NoPlace {
        /// Number of plausible cameras.
        cameras: usize,
    },
    /// The field of a camera is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Cancelled; the document is unchanged.
    #[error("stopped")]
    Stopped,
}

/// Mends the cameras of a document's frames, which another program gave. Frames that people decided
/// on keep their cameras. `folder` is where the document's relative paths start.
///
/// # Errors
/// There is nothing to mend, the field of a camera is not valid, or `progress` cancelled it; the
/// document is then unchanged.
pub fn mend(
    document: &mut Document,
    folder: &Path,
    reader: &mut dyn ReadFrames,
    options: &MendOptions,
    progress: &Progress<'_, MendEvent>,
) -> Result<Mended, MendError> {
    let before = document.clone();
    let fields = Fields::from_document(before.at(folder))?;
    let given = given_cameras(&before, &fields);
    // Step 1 has set the implausible cameras aside; one has to be left.
    let usable = count_usable(&given)?;
    let mut mending = Mending {
        folder,
        reader,
        progress,
    };
    // Steps 2 and 3: where cameras stand, and whether all of them are wrong alike.
    let cuts = mending.find_cuts(&before)?;
    let shots = Shots::new(&before, cuts, &given).ok_or(MendError::NoPlace { cameras: usable })?;
    let _ = progress.report(MendEvent::Places(shots.places.clone()));
    let sample = Sample::read(
        &before,
        folder,
        &shots,
        &given,
        &mut *mending.reader,
        progress,
    )?;
    let test = Test {
        document: &before,
        fields: &fields,
        shots: &shots,
        given: &given,
        sample: &sample,
    };
    let (mut common, corrected) = test.likeliest(&options.shifts);
    let Corrected { given, shots, lens } = corrected;
    let shots = shots.ok_or(MendError::NoPlace { cameras: usable })?;
    // Steps 4 and 5 on a copy: a cancelled run leaves the document unchanged.
    let mut mended = before.clone();
    let cameras = shots.place_cameras(&mut mended, &given, lens);
    let mut not_aligned = Vec::new();
    for (camera, place) in &cameras {
        match mending.align(&mut mended, camera, place)? {
            Ok(errors) => common.extend(errors),
            // A camera that cannot be aligned does not end the work on the others: a close-up shows
            // too few lines.
            Err(reason) => not_aligned.push(NotAligned {
                camera: camera.clone(),
                reason,
            }),
        }
    }
    // Before tracking, so that wrong cameras do not constrain their neighbours.
    let aligned = drop_unaligned(&mut mended, &shots);
    mending.track(&mut mended)?;
    mending.check_again(&mut mended)?;
    let result = Mended {
        places: shots.places,
        common,
        not_aligned,
        frames: compare_frames(&before, &mended, &given, &aligned),
    };
    result.record_imported(&before, &mut mended);
    *document = mended;
    Ok(result)
}

/// The number of given cameras that can be used; at least one.
fn count_usable(given: &[GivenCamera]) -> Result<usize, MendError> {
    let usable = given
        .iter()
        .filter(|given| given.usable().is_some())
        .count();
    if usable > 0 {
        return Ok(usable);
    }
    let faults: Vec<&GivenFault> = given.iter().filter_map(GivenCamera::fault).collect();
    Err(match faults.first() {
        Some(first) => MendError::NonePossible {
            cameras: faults.len(),
            first: (*first).clone(),
        },
        None => MendError::NoCamera,
    })
}

/// The state while cameras are mended.
struct Mending<'a> {
    folder: &'a Path,
    reader: &'a mut dyn ReadFrames,
    progress: &'a Progress<'a, MendEvent>,
}

impl Mending<'_> {
    /// The frames with which a shot begins, by their indices in the document.
    fn find_cuts(&mut self, document: &Document) -> Result<Vec<usize>, MendError> {
        let stream = PictureStream::new(document.at(self.folder), 0..document.frames.len())
            .with_reader(&mut *self.reader)
            .with_progress(self.progress.part(MendEvent::Cuts));
        let cuts = find_cuts(stream.map(|frame| frame.picture.ok()));
        self.stop_if_cancelled()?;
        // A transition is a part of its own: its frames stand at the place of neither shot.
        let mut starts: Vec<usize> = cuts
            .into_iter()
            .flat_map(|cut| [cut.transition.start, cut.frame])
            .collect();
        starts.dedup();
        Ok(starts)
    }

    /// Estimates the base of a camera from the paint of its frames and aligns the frames to it.
    /// Where too little paint is seen, the base stays where the given cameras place it. Returns the
    /// lens and the sizes of the field in which the paint contradicts them; or why base and lens
    /// could not be estimated, and stay those of the given cameras.
    fn align(
        &mut self,
        document: &mut Document,
        camera: &CameraId,
        place: &SharedPlace,
    ) -> Result<Result<Vec<CommonError>, BaseOnPaintError>, MendError> {
        let of_camera = document
            .frames
            .iter()
            .filter(|frame| frame.camera == *camera);
        let is_size_open = *document.field_of_camera(camera).size() == FieldSize::Assumed;
        // The pictures of all frames are read twice at most for the base, once more for the size of
        // the field, and once for the alignment.
        let readings = 3 + usize::from(is_size_open);
        // At most: pictures are subsampled for the base, so the work may end before its announced
        // number.
        let of = readings * of_camera.filter(|frame| frame.ptz.is_some()).count();
        let (folder, progress) = (self.folder, self.progress);
        let mut done = 0;
        let reader = &mut *self.reader;
        let mut picture = |frame: &Frame| {
            let share = Share { done, of };
            done += 1;
            let event = MendEvent::Aligning(camera.clone(), share);
            // The estimation takes no progress of its own here. Once cancelled, no picture is read
            // any more, and it ends for lack of paint.
            let goes_on = progress.report(event).is_continue();
            goes_on.then(|| read_picture(reader, frame, folder).ok())?
        };
        let before = document.clone();
        let found = estimate_on_paint(
            before.at(folder),
            camera,
            &near_place(place),
            is_size_open,
            &mut picture,
            &Progress::default(),
        );
        if progress.is_cancelled() {
            return Err(MendError::Stopped);
        }
        let found = match found {
            Ok(found) => found,
            Err(reason) => return Ok(Err(reason)),
        };
        // Where the given base is as near to the paint, it stays: what the paint of one end of a
        // field leaves open would be replaced by another guess.
        let given = before.camera(camera).and_then(Camera::base);
        let found = match given.filter(|_| !found.is_worthwhile()) {
            Some(given) => found.with_base(given, before.field_of_camera(camera).crown_m()),
            None => found,
        };
        let mut common: Vec<CommonError> =
            CommonError::from_field_sizes(&found.estimated.sizes).collect();
        let base = &found.estimated.estimate.base;
        common.extend(CommonError::from_lens_difference(
            &before,
            camera,
            &place.base,
            base,
        ));
        // The frames follow in `write_frames` from their paint, and not from clicks, which given
        // cameras do not have.
        found.estimated.write_camera(document);
        let field = document
            .at(folder)
            .model_of(document.field_of_camera(camera))?;
        found.write_frames(document, &before, &field, &mut picture);
        self.stop_if_cancelled()?;
        Ok(Ok(common))
    }

    /// Tracks the cameras that are there to the frames without one.
    fn track(&mut self, document: &mut Document) -> Result<(), MendError> {
        let clips = clips(document.at(self.folder), None);
        track_clips(
            document,
            self.folder,
            &clips,
            &mut *self.reader,
            &TrackingOptions::default(),
            &mut Vec::new(),
            &self.progress.part(MendEvent::Tracking),
        )?;
        self.stop_if_cancelled()
    }

    /// Compares the frames that were tracked, and those left in doubt, with their paint. What
    /// tracking saw before its last adjustment does not apply to the cameras that came out of it.
    fn check_again(&mut self, document: &mut Document) -> Result<(), MendError> {
        let fields = Fields::from_document(document.at(self.folder))?;
        let unchecked: Vec<usize> = (0..document.frames.len())
            .filter(|index| mended::wants_check(&document.frames[*index]))
            .collect();
        let mut checks: Vec<(usize, LineCheck)> = Vec::new();
        {
            let document = &*document;
            let mut stream = PictureStream::new(document.at(self.folder), unchecked)
                .with_reader(&mut *self.reader)
                .with_progress(self.progress.part(MendEvent::Checking));
            // A few pictures are in memory at the same time.
            loop {
                let some: Vec<FramePicture<'_>> = stream.by_ref().take(AT_ONCE).collect();
                if some.is_empty() {
                    break;
                }
                checks.par_extend(some.par_iter().filter_map(|read| {
                    let field = fields.for_frame(document, read.frame);
                    let picture = read.picture.as_ref().ok()?;
                    let check = check_frame(document, read.frame, field, picture)?;
                    Some((read.index, check))
                }));
            }
        }
        for (index, check) in checks {
            let frame = &mut document.frames[index];
            // Read before the check is recorded, which may itself add the warning that makes a
            // frame doubted. Paint that supports a camera settles the doubt of tracking.
            let was_doubted = mended::is_doubted(frame);
            record_line_check(frame, &check);
            if was_doubted
                && check.verdict() == LineVerdict::Supports
                && let Some(solution) = &mut frame.solution
            {
                solution.confidence = Some(check.score);
            }
        }
        self.stop_if_cancelled()
    }

    fn stop_if_cancelled(&self) -> Result<(), MendError> {
        if self.progress.is_cancelled() {
            Err(MendError::Stopped)
        } else {
            Ok(())
        }
    }
}

/// Removes the cameras of open frames that could not be aligned to their paint, in shots where
/// others could: their neighbours know better. Returns the indices of the aligned frames.
fn drop_unaligned(document: &mut Document, shots: &Shots) -> BTreeSet<usize> {
    let aligned: BTreeSet<usize> = (0..document.frames.len())
        .filter(|index| document.frames[*index].is_snapped())
        .collect();
    for shot in &shots.ranges {
        // Without any aligned frame there is nothing to track from: the given cameras on their
        // common place are then the best that there is.
        if aligned.range(shot.clone()).next().is_none() {
            continue;
        }
        for index in shot.clone() {
            let frame = &document.frames[index];
            if frame.is_open() && !aligned.contains(&index) {
                withdraw(&mut document.frames[index]);
            }
        }
    }
    aligned
}

/// Options of the estimation of a base that stands near the place that the given cameras share.
fn near_place(place: &SharedPlace) -> BaseOptions {
    // A scatter smaller than the least σ shows only that the given cameras agree, not that they are
    // right.
    let sigma_m = place.scatter_m.map(|sigma| sigma.max(PLACE_SIGMA_M));
    let mut options = BaseOptions::default();
    options.adjust.priors.position_m = Some((place.base.position_m, sigma_m));
    options
}
