//! From a season to its plan.

use super::file::{LabelShard, Plan, PlannedFile, PlannedMatch};
use crate::season_file::{Match, Season};
use crate::source::{SourceError, SourceState, examine_source, place_of_source};
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::folder_of;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Document, WriteError, document_to_string, generator, path_between, resolve_path,
};
use touchline_documents::store::{self, Location, StoreError};
use touchline_vision::media::{MediaError, sha256_of_bytes, sha256_of_file};

/// Why a season has no plan.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MakePlanError {
    /// A match cannot be planned.
    #[error("{name}: {source}")]
    Match {
        name: String,
        /// Why.
        source: MatchError,
    },
    /// `progress` cancelled it.
    #[error("stopped; no plan was made")]
    Stopped,
}

/// Why a match cannot be planned.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MatchError {
    /// Its frames cannot be used.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// Its project cannot be used.
    #[error(transparent)]
    Project(#[from] Box<StoreError>),
    /// Its forest cannot be read.
    #[error(transparent)]
    Forest(#[from] MediaError),
    /// Its project has no camera that could be used.
    #[error(
        "{} has no camera with a base; estimate it there, or name no project",
        project.display()
    )]
    NoBase { project: PathBuf },
    /// Its project cannot be hashed.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Plans a season: hashes what is named in it and divides its matches. The plan is for a file at
/// `plan`, to which its paths are relative, and for machines of `processor` class. Each match that
/// is done is reported.
///
/// # Errors
/// A video, project or forest cannot be used, or `progress` cancelled it.
pub fn make_plan(
    season: &Season,
    plan: &Path,
    processor: &str,
    progress: &Progress<'_, ()>,
) -> Result<Plan, MakePlanError> {
    let folder = resolve_path(folder_of(plan));
    let mut made = Plan::new(generator(), processor.to_owned());
    for of_season in &season.matches {
        let planned = plan_match(of_season, &folder);
        let mut planned = planned.map_err(|source| MakePlanError::Match {
            name: of_season.name.clone(),
            source,
        })?;
        // Ids come last, because they are hashes of everything else.
        made.name_shards(&mut planned);
        made.matches.push(planned);
        if progress.report(()).is_break() {
            return Err(MakePlanError::Stopped);
        }
    }
    Ok(made)
}

/// Everything of a match but the ids of its shards.
fn plan_match(of_season: &Match, folder: &Path) -> Result<PlannedMatch, MatchError> {
    let state = examine_source(&of_season.frames)?;
    let (_, frames_name) = place_of_source(&of_season.frames)?;
    let project = of_season.project.as_deref();
    let project = project.map(|path| plan_project(path, folder));
    let forest = of_season.forest.as_deref();
    let forest = forest.map(|path| plan_forest(path, folder));
    Ok(PlannedMatch {
        name: of_season.name.clone(),
        frames: path_for(&of_season.frames, folder),
        frames_name,
        num_frames: state.num_frames,
        field: of_season.field.clone(),
        project: project.transpose()?,
        forest: forest.transpose()?,
        look_at: of_season.options.look_at,
        find: String::new(),
        labels: windows(&state, of_season),
        frames_sha256: state.sha256,
    })
}

/// Divides all frames into windows of equal length; the last one takes what is left.
fn windows(state: &SourceState, of_season: &Match) -> Vec<LabelShard> {
    let options = &of_season.options;
    // A damaged file may state any rate. Too large a number of frames becomes the largest there is,
    // none at all becomes one frame, so that every frame is in some window.
    let length = state.fps.map_or(options.images, |fps| {
        let frames = (options.window_s * fps).round();
        if frames.is_finite() {
            frames as usize
        } else {
            1
        }
    });
    let length = length.max(1);
    (0..state.num_frames)
        .step_by(length)
        .map(|first| LabelShard {
            shard: String::new(),
            first,
            last: first.saturating_add(length).min(state.num_frames) - 1,
        })
        .collect()
}

fn plan_project(path: &Path, folder: &Path) -> Result<PlannedFile, MatchError> {
    let (location, document, _) = store::read(path).map_err(Box::new)?;
    let mut cameras = document.cameras.iter();
    if cameras.all(|camera| camera.base().is_none()) {
        let project = path.to_path_buf();
        return Err(MatchError::NoBase { project });
    }
    Ok(PlannedFile {
        path: path_for(path, folder),
        sha256: hash_of_project(&location, &document)?,
    })
}

fn plan_forest(path: &Path, folder: &Path) -> Result<PlannedFile, MatchError> {
    Ok(PlannedFile {
        path: path_for(path, folder),
        sha256: sha256_of_file(path)?,
    })
}

/// The SHA-256 of a project: of the document with the edits of its journal, as it would be written,
/// and of the field templates of its own.
///
/// # Errors
/// The document cannot be written.
pub fn hash_of_project(location: &Location, document: &Document) -> Result<String, WriteError> {
    let mut text = document_to_string(document)?;
    for field in document.fields().filter(|field| field.is_file()) {
        // A template that cannot be read stops the shards, which say why.
        let hash = sha256_of_file(&location.folder().join(&field.template));
        text.push_str(&hash.unwrap_or_default());
    }
    Ok(sha256_of_bytes(text.as_bytes()))
}

/// A path as the plan names it: relative to the plan's folder if it was given relative, so that
/// plan and frames may move together.
fn path_for(path: &Path, folder: &Path) -> String {
    if path.is_absolute() {
        return path.to_string_lossy().into_owned();
    }
    path_between(folder, &resolve_path(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::season_file::ShardOptions;
    use touchline_documents::document::FieldSpec;

    /// First and last frame of each window.
    fn windows_of(num_frames: usize, fps: Option<f64>, options: ShardOptions) -> Vec<[usize; 2]> {
        let state = SourceState {
            sha256: String::new(),
            num_frames,
            fps,
        };
        let of_season = Match {
            name: "a".to_owned(),
            line: 1,
            frames: "a.mp4".into(),
            field: FieldSpec::new("soccer"),
            project: None,
            forest: None,
            options,
        };
        let ends = |label: &LabelShard| [label.first, label.last];
        windows(&state, &of_season).iter().map(ends).collect()
    }

    #[test]
    fn windows_are_of_equal_length_and_cover_every_frame_once() {
        let options = ShardOptions::default();
        let minutes = windows_of(3700, Some(25.0), options);
        assert_eq!(minutes, [[0, 1499], [1500, 2999], [3000, 3699]]);
        assert_eq!(windows_of(1500, Some(25.0), options), [[0, 1499]]);
        assert_eq!(
            windows_of(801, None, options),
            [[0, 399], [400, 799], [800, 800]]
        );
        assert_eq!(windows_of(2, Some(1e300), options), [[0, 1]]);
        // Rates that a damaged file may state.
        for fps in [0.0, f64::NAN, f64::INFINITY, 1e-9] {
            assert_eq!(windows_of(2, Some(fps), options), [[0, 0], [1, 1]], "{fps}");
        }
    }
}
