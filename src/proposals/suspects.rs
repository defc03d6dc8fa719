//! References whose labels contradict others.

use super::Lesson;
use crate::project::Document;
use crate::relocalize::{ContradictionOptions, Reference, contradictions, suspects};
use std::ops::ControlFlow;

/// So many references, next to each other by pan, are compared at a time.
const TOGETHER: usize = 100;

/// A reference to look at: without it no label would contradict another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspect {
    /// Its place in the document.
    pub frame: usize,
    /// How many references contradict it.
    pub contradicted_by: usize,
    /// By how much its overlay lies off from where they say it is, at most, px at 1920 px width.
    pub disagreement_px: f64,
}

/// The references to look at, the most contradicted first. `progress` is called now and then and may end it: none then.
pub fn find_suspects(
    document: &Document,
    lessons: &[Lesson],
    progress: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Suspect>> {
    let mut found = Vec::new();
    for camera in &document.cameras {
        let mut lessons: Vec<&Lesson> = lessons.iter().filter(|lesson| lesson.camera == camera.id).collect();
        lessons.sort_by(|a, b| a.ptz.pan.radians().total_cmp(&b.ptz.pan.radians()).then(a.frame.cmp(&b.frame)));
        for lessons in lessons.chunks(TOGETHER) {
            progress().continue_value()?;
            found.extend(suspects_among(document, lessons));
        }
    }
    found.sort_by(|a, b| b.contradicted_by.cmp(&a.contradicted_by).then(a.frame.cmp(&b.frame)));
    Some(found)
}

fn suspects_among(document: &Document, lessons: &[&Lesson]) -> Vec<Suspect> {
    let pointed = lessons.iter().filter_map(|lesson| {
        let camera = document.pointed(document.frames.get(lesson.frame)?)?;
        Some((lesson.frame, Reference { features: &lesson.features, camera }))
    });
    let (frames, references): (Vec<usize>, Vec<Reference>) = pointed.unzip();
    let found = contradictions(&references, &ContradictionOptions::default());
    let suspect = |index: usize| {
        let mut against = found.iter().filter(|contradiction| contradiction.references.contains(&index)).peekable();
        let disagreement_px = against.peek().map_or(0.0, |greatest| greatest.disagreement_px);
        Suspect { frame: frames[index], contradicted_by: against.count(), disagreement_px }
    };
    suspects(&found).into_iter().map(suspect).collect()
}
