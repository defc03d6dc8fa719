//! A change after which many frames are solved again: worked out beside the document, then joined
//! with what it has become.
//!
//! Solving 100,000 frames takes seconds, and a person goes on labelling meanwhile. The change and
//! the solved frames are therefore made in a copy of the document; nothing has changed before it is
//! done. Frames that were edited since the copy was taken stay as they are then, but for what the
//! change means for each of them.

use super::follow_base::follow_bases;
use super::solve_frames::{is_by_clicks, solve_by_clicks};
use super::which_camera::{add_camera_like, assign_frames, check_assigned};
use super::{AssignError, EstimatedBase, FoundCamera};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{CameraId, Document, Fields, Frame, FrameId};

/// A change after which many frames are solved again.
#[derive(Clone, Debug, PartialEq)]
pub enum BulkChange {
    /// Cameras, field and click noise become those of this document; its frames do not matter.
    Numbers(Box<Document>),
    /// A camera gets the base that was estimated.
    Base(Arc<EstimatedBase>),
    /// A camera gets the base that was found without a click, and its frames what was found with
    /// it.
    Autocalibrated(Arc<FoundCamera>),
    /// Frames are assigned to a camera.
    Assign(Box<AssignedFrames>),
}

/// Frames that are assigned to a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct AssignedFrames {
    /// Which.
    pub frames: Vec<FrameId>,
    /// The camera.
    pub camera: CameraId,
    /// What the camera is made from; none where the document has it.
    pub new: Option<NewCamera>,
}

/// What a new camera is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct NewCamera {
    /// It takes pictures like those of this camera.
    pub like: CameraId,
    /// Its base, if known.
    pub base: Option<CameraBase>,
}

/// Why a change was not made; the document is as it was.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BulkError {
    /// Somebody stopped it.
    #[error("it was stopped")]
    Stopped,
    /// A field is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Frames cannot be assigned to the camera.
    #[error(transparent)]
    Assign(#[from] AssignError),
}

/// A change that is to be worked out.
#[derive(Clone, Debug, PartialEq)]
pub struct BulkSolve {
    /// The document.
    pub document: Document,
    /// Its folder.
    pub folder: PathBuf,
    /// What changes.
    pub change: BulkChange,
}

/// A change that was worked out.
#[derive(Clone, Debug, PartialEq)]
pub struct BulkSolved {
    work: BulkSolve,
    after: Document,
    withdrawn: usize,
}

/// A change that was joined with the document as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// The document with the change.
    pub document: Document,
    /// Proposals that were made for an old base and are withdrawn.
    pub withdrawn: usize,
}

impl BulkSolve {
    /// How many frames are solved again.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.solved_again(&self.change.places(&self.document))
    }

    /// How many of some frames are solved again: those that have clicks, and accepted proposals,
    /// whose lines are held.
    fn solved_again(&self, places: &[usize]) -> usize {
        let is_one = |frame: &Frame| is_by_clicks(frame) || frame.is_suggestion();
        places
            .iter()
            .filter(|index| is_one(&self.document.frames[**index]))
            .count()
    }

    /// Works the change out. A step of `progress` counts frames.
    ///
    /// # Errors
    /// The change cannot be made, or `progress` cancelled it.
    pub fn run(self, progress: &Progress<'_, Share>) -> Result<BulkSolved, BulkError> {
        let mut after = self.document.clone();
        self.change.make_beside_frames(&mut after)?;
        let places = self.change.places(&self.document);
        let (of, done) = (self.solved_again(&places), AtomicUsize::new(0));
        let counting = progress.part(|()| Share {
            done: done.fetch_add(1, Ordering::Relaxed) + 1,
            of,
        });
        let withdrawn = self.change.make_in_frames(
            &mut after,
            &self.document,
            &self.folder,
            &places,
            &counting,
        )?;
        // Counted here, so that joining need not touch every frame.
        after.count_edits_since(&self.document);
        Ok(BulkSolved {
            work: self,
            after,
            withdrawn,
        })
    }
}

impl BulkSolved {
    /// What was changed.
    #[must_use]
    pub const fn change(&self) -> &BulkChange {
        &self.work.change
    }

    /// The change, to be worked out again in the document as it is now.
    #[must_use]
    pub fn change_for(&self, now: &Document) -> BulkChange {
        match &self.work.change {
            BulkChange::Numbers(numbers) => {
                BulkChange::Numbers(Box::new(rebase_numbers(numbers, &self.work.document, now)))
            }
            change => change.clone(),
        }
    }

    /// The change in the document as it is now: frames that were edited meanwhile keep their edits,
    /// and are solved again if the change means it. None where cameras, field or the order of the
    /// frames have changed meanwhile: it has to be worked out again then.
    ///
    /// # Errors
    /// The change cannot be made in the frames that were edited.
    pub fn join(&self, now: &Document) -> Result<Option<Joined>, BulkError> {
        let before = &self.work.document;
        if !now.same_beside_frames(before) {
            return Ok(None);
        }
        let Some(edited) = now.frames.changed_in_place(&before.frames) else {
            return Ok(None);
        };
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
        Ok(Some(Joined {
            document,
            withdrawn: self.withdrawn + withdrawn,
        }))
    }
}

/// The numbers that a change sets, on what has become of the others since `before`: of a camera
/// that the change leaves alone all of it, of the others the masks that were drawn meanwhile.
fn rebase_numbers(numbers: &Document, before: &Document, now: &Document) -> Document {
    let mut rebased = now.clone();
    for camera in &mut rebased.cameras {
        let (Some(set), Some(known)) = (numbers.camera(&camera.id), before.camera(&camera.id))
        else {
            continue;
        };
        if set == known {
            continue;
        }
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
    /// Makes the part of the change that lies beside the frames.
    fn make_beside_frames(&self, document: &mut Document) -> Result<(), BulkError> {
        match self {
            Self::Numbers(numbers) => {
                document.cameras.clone_from(&numbers.cameras);
                document.field.clone_from(&numbers.field);
                document.click_noise.clone_from(&numbers.click_noise);
            }
            Self::Base(found) => found.write_camera(document),
            // Its frames are those that nobody has clicked in: no edit of them is lost.
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

    /// The places of the frames that it may change, ascending.
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

    /// Makes the part of the change that lies in these frames, and says how many proposals it
    /// withdrew. `before` is the document without the change.
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
                solve_by_clicks(document, folder, places, progress)?
            }
            Self::Base(found) => found.write_frames(document, before, folder, places, progress)?,
            Self::Assign(given) => {
                let fields = Fields::of(document.at(folder))?;
                check_assigned(document, places, &given.camera)?;
                assign_frames(document, places, &given.camera, &fields, progress);
            }
        }
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
    use touchline_core::geometry::{ImageSize, PixelBox};
    use touchline_documents::document::{Camera, FieldSpec};

    #[test]
    fn what_was_changed_beside_the_numbers_meanwhile_stays() {
        let (size, mut before) = (
            ImageSize::new(64, 48),
            Document::new(FieldSpec::new("soccer")),
        );
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
        let mask = PixelBox {
            x: 1.0,
            y: 2.0,
            width: 30.0,
            height: 8.0,
        };
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
