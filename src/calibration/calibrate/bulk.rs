//! A change after which many frames are solved again: computed on a copy, then joined with the
//! document as edited meanwhile.
//!
//! Solving 100,000 frames takes seconds, and the user continues labelling. The change is therefore
//! made and the frames are solved in a copy of the document; the document itself does not change
//! until that is done. Frames that were edited since the copy was taken keep their edits; only they
//! are processed again when the change is joined.

use super::{AssignError, EstimatedBase, FoundCamera};
use crate::calibrate::base::follow_base::follow_bases;
use crate::calibrate::frames::solve_frames::{is_by_clicks, solve_by_clicks};
use crate::calibrate::frames::which_camera::{add_camera_like, assign_frames, check_assigned};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{CameraId, Document, Fields, FrameId};

/// A change after which many frames are solved again.
#[derive(Clone, Debug, PartialEq)]
pub enum BulkChange {
    /// Cameras, field and click noise become those of this document; its frames are ignored.
    Numbers(Box<Document>),
    /// A camera gets an estimated base.
    Base(Arc<EstimatedBase>),
    /// A camera gets a base from autocalibration, and its frames get their cameras.
    Autocalibrated(Arc<FoundCamera>),
    /// Frames are assigned to a camera.
    Assign(Box<AssignedFrames>),
}

/// Frames that are to be assigned to a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct AssignedFrames {
    /// The ids of the frames.
    pub frames: Vec<FrameId>,
    /// The camera.
    pub camera: CameraId,
    /// How to create the camera; none if the document has it.
    pub new: Option<NewCamera>,
}

/// How to create a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct NewCamera {
    /// The camera whose picture size, masks and field it gets.
    pub like: CameraId,
    /// The camera's base, if known.
    pub base: Option<CameraBase>,
}

/// Why a change was not made; the document has not changed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BulkError {
    /// It was cancelled.
    #[error("it was stopped")]
    Stopped,
    /// A field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Frames cannot be assigned to the camera.
    #[error(transparent)]
    Assign(#[from] AssignError),
}

/// A change that is to be computed.
#[derive(Clone, Debug, PartialEq)]
pub struct BulkSolve {
    /// The document before the change.
    pub document: Document,
    /// The document's folder.
    pub folder: PathBuf,
    /// The change.
    pub change: BulkChange,
}

/// A change that was computed.
#[derive(Clone, Debug, PartialEq)]
pub struct BulkSolved {
    work: BulkSolve,
    after: Document,
    withdrawn: usize,
}

/// A change joined with the current document.
#[derive(Clone, Debug, PartialEq)]
pub struct JoinedChange {
    /// The document with the change.
    pub document: Document,
    /// Proposals that were made with an old base and are withdrawn.
    pub withdrawn: usize,
}

impl BulkSolve {
    /// Number of frames that are solved again.
    pub fn frames(&self) -> usize {
        self.count_frames_to_solve(&self.change.places(&self.document))
    }

    /// Number of these frames that are solved again: those with clicks, and accepted proposals,
    /// whose lines are kept in place.
    fn count_frames_to_solve(&self, places: &[usize]) -> usize {
        places
            .iter()
            .filter(|index| {
                let frame = &self.document.frames[**index];
                is_by_clicks(frame) || frame.is_suggestion()
            })
            .count()
    }

    /// Computes the change. `progress` counts frames.
    ///
    /// # Errors
    /// The change cannot be made, or `progress` cancelled it.
    pub fn run(self, progress: &Progress<'_, Share>) -> Result<BulkSolved, BulkError> {
        let mut after = self.document.clone();
        self.change.make_beside_frames(&mut after)?;
        let places = self.change.places(&self.document);
        // Threads finish frames in any order, so they share one counter.
        let (of, done) = (self.count_frames_to_solve(&places), AtomicUsize::new(0));
        let counting = progress.part(|()| Share::new(done.fetch_add(1, Ordering::Relaxed) + 1, of));
        let withdrawn = self.change.make_in_frames(
            &mut after,
            &self.document,
            &self.folder,
            &places,
            &counting,
        )?;
        // Edits are counted here, so that joining need not visit every frame.
        after.count_edits_since(&self.document);
        Ok(BulkSolved {
            work: self,
            after,
            withdrawn,
        })
    }
}

impl BulkSolved {
    /// The change that was computed.
    pub const fn change(&self) -> &BulkChange {
        &self.work.change
    }

    /// The change, for computing it again from the current document.
    pub fn change_for(&self, now: &Document) -> BulkChange {
        match &self.work.change {
            BulkChange::Numbers(numbers) => {
                BulkChange::Numbers(Box::new(rebase_numbers(numbers, &self.work.document, now)))
            }
            change => change.clone(),
        }
    }

    /// The current document with the change. Frames that were edited meanwhile keep their edits and
    /// are solved again if the change concerns them. None if cameras, field or the order of frames
    /// have changed meanwhile: compute the change again then.
    ///
    /// # Errors
    /// The change cannot be made in the frames that were edited.
    pub fn join(&self, now: &Document) -> Result<Option<JoinedChange>, BulkError> {
        let before = &self.work.document;
        if !now.same_beside_frames(before) {
            return Ok(None);
        }
        // Frames correspond by index, so their order must be the same.
        let Some(edited) = now.frames.changes_in_place(&before.frames) else {
            return Ok(None);
        };
        // Three-way merge by frame: start from the computed copy, put in the frames edited since,
        // and make the change again in those.
        let mut document = self.after.clone();
        for &index in &edited {
            document.frames[index] = now.frames[index].clone();
        }
        let concerned = self.work.change.places(now);
        let again: Vec<usize> = edited
            .into_iter()
            .filter(|index| concerned.binary_search(index).is_ok())
            .collect();
        let (change, folder) = (&self.work.change, &self.work.folder);
        let withdrawn =
            change.make_in_frames(&mut document, now, folder, &again, &Progress::default())?;
        Ok(Some(JoinedChange {
            document,
            withdrawn: self.withdrawn + withdrawn,
        }))
    }
}

/// The numbers that a change sets, applied to the current document, where `before` is the document
/// that the change was made for. Cameras that the change does not touch stay as they are now. The
/// others get its numbers but keep masks drawn meanwhile.
fn rebase_numbers(numbers: &Document, before: &Document, now: &Document) -> Document {
    let mut rebased = now.clone();
    // A three-way merge by camera. One that only one of the documents has stays as it is now.
    for camera in &mut rebased.cameras {
        let (Some(set), Some(known)) = (numbers.camera(&camera.id), before.camera(&camera.id))
        else {
            continue;
        };
        if set == known {
            continue;
        }
        // The camera as the change sets it, with the masks of now unless the change itself set
        // masks.
        let mut with_numbers = set.clone();
        if set.masks == known.masks {
            with_numbers.masks.clone_from(&camera.masks);
        }
        if set.ranged_masks == known.ranged_masks {
            with_numbers.ranged_masks.clone_from(&camera.ranged_masks);
        }
        *camera = with_numbers.into();
    }
    if numbers.field != before.field {
        rebased.field.clone_from(&numbers.field);
    }
    if numbers.click_noise != before.click_noise {
        rebased.click_noise.clone_from(&numbers.click_noise);
    }
    rebased
}

impl BulkChange {
    /// Makes the part of the change outside the frames.
    fn make_beside_frames(&self, document: &mut Document) -> Result<(), BulkError> {
        match self {
            Self::Numbers(numbers) => {
                document.cameras.clone_from(&numbers.cameras);
                document.field.clone_from(&numbers.field);
                document.click_noise.clone_from(&numbers.click_noise);
            }
            Self::Base(found) => found.write_camera(document),
            // It writes only into frames that no person has clicked in, so that no edit of them is
            // lost.
            Self::Autocalibrated(found) => found.write(document),
            Self::Assign(given) => {
                let Some(new) = &given.new else { return Ok(()) };
                add_camera_like(document, &given.camera, &new.like)?;
                if let (Some(camera), Some(base)) = (document.camera_mut(&given.camera), &new.base)
                {
                    camera.set_base(base);
                }
            }
        }
        Ok(())
    }

    /// The indices of the frames that it may change, ascending.
    fn places(&self, document: &Document) -> Vec<usize> {
        match self {
            Self::Numbers(_) | Self::Base(_) | Self::Autocalibrated(_) => {
                (0..document.frames.len()).collect()
            }
            Self::Assign(given) => {
                let mut places: Vec<usize> = given
                    .frames
                    .iter()
                    .filter_map(|id| document.frames.position_of(id))
                    .collect();
                places.sort_unstable();
                places.dedup();
                places
            }
        }
    }

    /// Makes the part of the change in these frames and returns the number of withdrawn proposals.
    /// `before` is the document without the change.
    fn make_in_frames(
        &self,
        document: &mut Document,
        before: &Document,
        folder: &Path,
        places: &[usize],
        progress: &Progress<'_, ()>,
    ) -> Result<usize, BulkError> {
        if places.is_empty() {
            return Ok(0);
        }
        match self {
            Self::Numbers(_) | Self::Autocalibrated(_) => {
                solve_by_clicks(document, folder, places, progress)?;
            }
            Self::Base(found) => found.write_frames(document, before, folder, places, progress)?,
            Self::Assign(given) => {
                let fields = Fields::from_document(document.at(folder))?;
                check_assigned(document, places, &given.camera)?;
                assign_frames(document, places, &given.camera, &fields, progress);
            }
        }
        // Frames without clicks follow the new bases after the clicked ones are solved.
        let withdrawn = follow_bases(document, before, places, progress);
        if progress.is_cancelled() {
            Err(BulkError::Stopped)
        } else {
            Ok(withdrawn)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::soccer_document;

    #[test]
    fn what_was_changed_beside_the_numbers_meanwhile_stays() {
        let (size, mut before) = (ImageSize::new(64, 48), soccer_document());
        before
            .cameras
            .extend(["main", "other"].map(|name| Camera::new(name.into(), size).into()));
        let mut numbers = before.clone();
        numbers.cameras[0].click_noise_px = Some(2.0);
        let change = BulkChange::Numbers(Box::new(numbers));
        let solve = |document: &Document, change| BulkSolve {
            document: document.clone(),
            folder: PathBuf::new(),
            change,
        };
        let solved = solve(&before, change).run(&Progress::default()).unwrap();
        let mut now = before.clone();
        let mask = pixel_box(1.0, 2.0, 30.0, 8.0);
        now.cameras
            .iter_mut()
            .for_each(|camera| camera.masks.push(mask));
        now.field.template = "futsal".to_owned();
        now.cameras.push(Camera::new("new".into(), size).into());
        assert_eq!(
            solved.join(&now).unwrap(),
            None,
            "it has to be worked out again"
        );
        let again = solve(&now, solved.change_for(&now))
            .run(&Progress::default())
            .unwrap();
        let document = again.join(&now).unwrap().unwrap().document;
        assert_eq!(
            (document.cameras[0].click_noise_px, document.cameras.len()),
            (Some(2.0), 3)
        );
        assert!(
            document.cameras[..2]
                .iter()
                .all(|camera| camera.masks == [mask])
        );
        assert_eq!(document.field.template, "futsal");
    }
}
