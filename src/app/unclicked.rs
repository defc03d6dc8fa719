//! Finding a camera without a click: the order, what is under way, and what came of it in words.

use crate::calibrate::{
    Abstention, DecidingLandmark, Doubt, FoundCamera, UnclickedAnswer, UnclickedCamera, UnclickedError,
    UnclickedProgress, WatchUnclicked, camera_from_few_clicks, camera_without_clicks,
};
use crate::document::{CameraId, Click, Document, FrameId, Target};
use crate::field::LandmarkId;
use crate::geometry::ImagePoint;
use crate::media::ReadFrames;
use crate::proposals::read_picture;
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;

/// Frames that are looked at, spread over all of the camera.
const LOOKED_AT: usize = 40;

/// Fewer frames hardly show what is painted on the ground and what moves over it.
pub(super) const FEWEST: usize = 3;

/// A camera is to be found from its frames' pictures alone.
#[derive(Clone, Debug, PartialEq)]
pub struct UnclickedOrder {
    /// Which order: the reports say it again.
    pub ticket: u64,
    /// The document.
    pub document: Document,
    /// Where its relative paths start.
    pub folder: PathBuf,
    /// Which camera.
    pub camera: CameraId,
}

/// Why no camera was looked for to the end.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnclickedFailure {
    /// Something that the search needs is missing.
    #[error("{message}")]
    Impossible {
        /// What, in words.
        message: String,
    },
    /// An internal error of this program.
    #[error("internal error (please report it): {message}")]
    Panicked {
        /// The words of the panic.
        message: String,
    },
}

impl From<UnclickedError> for UnclickedFailure {
    fn from(error: UnclickedError) -> Self {
        Self::Impossible { message: error.to_string() }
    }
}

impl UnclickedOrder {
    /// Searches; `watch` is told how far it has come and may end it.
    ///
    /// # Errors
    /// The search was stopped, or something that it needs is missing.
    pub fn carry_out(
        &self,
        reader: &mut dyn ReadFrames,
        watch: WatchUnclicked<'_>,
    ) -> Result<UnclickedAnswer, UnclickedFailure> {
        let mut picture = |index: usize| read_picture(reader, &self.document.frames[index], &self.folder).ok();
        let at = self.document.at(&self.folder);
        // Two clicks save the search; with fewer nothing is looked at here.
        let by_clicks = camera_from_few_clicks(at, &self.camera, LOOKED_AT, &mut picture, watch)?;
        if !matches!(by_clicks, UnclickedAnswer::Abstained(_)) {
            return Ok(by_clicks);
        }
        Ok(camera_without_clicks(at, &self.camera, LOOKED_AT, &mut picture, watch)?)
    }

    /// A camera that was found, with its frames by their ids.
    pub(super) fn named(&self, found: UnclickedCamera) -> Arc<FoundCamera> {
        Arc::new(FoundCamera::of(&self.document, &self.camera, found))
    }
}

/// What is being done about a camera without a click.
#[derive(Debug, Default)]
pub enum UnclickedWork {
    /// Nothing.
    #[default]
    Idle,
    /// It is being searched for.
    Searching(Box<Searching>),
    /// It was found, and waits for the end of what the person is doing.
    Found(Arc<FoundCamera>),
    /// Two places explain the paint: a person decides.
    Two(Box<TwoCameras>),
    /// No answer was certain.
    Abstained {
        /// Of which camera.
        camera: CameraId,
        /// Why, and what helps.
        why: String,
    },
}

/// A search under way.
#[derive(Debug)]
pub struct Searching {
    /// What was ordered.
    pub(super) order: UnclickedOrder,
    /// How far it has come; none before it says so.
    pub progress: Option<UnclickedProgress>,
}

/// Two cameras that explain the paint alike.
#[derive(Debug)]
pub struct TwoCameras {
    /// The one that explains more, and the other.
    pub cameras: [Arc<FoundCamera>; 2],
    /// The click that decides.
    pub deciding: Option<DecidingClick>,
}

/// The click that decides between two cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct DecidingClick {
    /// Its frame.
    pub frame: FrameId,
    /// What is to be clicked there.
    pub landmark: LandmarkId,
    /// Where the one camera and the other have it, px.
    image: [ImagePoint; 2],
    /// Both in words.
    says: String,
}

/// A click decides if it is at least so many times nearer to where one camera has it than to where the other has.
const NEARER: f64 = 2.0;

impl DecidingClick {
    /// Which of the two cameras a document's click speaks for; none without the click, or where it lies between them.
    pub(super) fn decided(&self, document: &Document) -> Option<usize> {
        let frame = &document.frames[document.frames.position_of(&self.frame)?];
        let is_it = |click: &&Click| click.target == Some(Target::Landmark(self.landmark.clone()));
        let click = frame.clicks.iter().find(is_it)?;
        let [here, there] = self.image.map(|image| image.distance_px(click.image));
        if NEARER * here < there {
            Some(0)
        } else if NEARER * there < here {
            Some(1)
        } else {
            None
        }
    }
}

impl Searching {
    /// What is being done, in one sentence.
    #[must_use]
    pub fn describe(&self) -> String {
        let far = self.progress.map(|progress| format!(": {progress}")).unwrap_or_default();
        format!("Finding the camera{far}…")
    }
}

impl UnclickedWork {
    /// What is being searched for.
    #[must_use]
    pub const fn searching(&self) -> Option<&Searching> {
        if let Self::Searching(searching) = self { Some(searching) } else { None }
    }
}

impl TwoCameras {
    pub(super) fn of(
        order: &UnclickedOrder,
        cameras: [UnclickedCamera; 2],
        deciding: Option<DecidingLandmark>,
        label: impl Fn(&DecidingLandmark) -> String,
    ) -> Self {
        let deciding = deciding.map(|deciding| {
            let [here, there] = deciding.image.map(|image| format!("({:.0}, {:.0})", image.x, image.y));
            let says = format!("{} is at {here} px with the first and at {there} px with the other", label(&deciding));
            let frame = order.document.frames[deciding.frame].id.clone();
            DecidingClick { frame, landmark: deciding.landmark, image: deciding.image, says }
        });
        Self { cameras: cameras.map(|found| order.named(found)), deciding }
    }

    /// What the person is to decide, and by what.
    #[must_use]
    pub fn describe(&self) -> String {
        let [best, other] = [0, 1].map(|which| place(&self.cameras[which].found));
        let by = self.deciding.as_ref().map_or_else(
            || "Try each and look at the lines.".to_owned(),
            |deciding| format!("One click decides: {}.", deciding.says),
        );
        format!("Two positions of the camera explain the painted lines: {best}, and {other}. {by}")
    }
}

/// What was found, in one sentence.
pub(super) fn describe_found(found: &UnclickedCamera) -> String {
    let sigma = found.base.sigma.position_m;
    let (snapped, frames) = (found.snapped_count(), found.frames.len());
    format!(
        "Camera found: {}, known to ±{:.1} m. {snapped} of {frames} frames agree with their own painted \
         lines; look at some before you accept them.",
        place(found),
        sigma.norm()
    )
}

/// Where a camera stands, as a person says it.
fn place(found: &UnclickedCamera) -> String {
    let at = found.base.position_m;
    format!("{:.1} m high, {:.1} m from the middle of the field", at.z, at.x.hypot(at.y))
}

/// Why there is no answer and what helps, in plain words.
pub(super) fn describe_abstention(why: &Abstention) -> String {
    format!("No camera was found: {}. {}", why_not(why), what_helps(why))
}

fn why_not(why: &Abstention) -> String {
    match why {
        Abstention::Uncertain { doubts, .. } => {
            let doubts: Vec<String> = doubts.iter().map(Doubt::to_string).collect();
            format!("the best answer is not certain ({})", doubts.join("; "))
        }
        Abstention::NotTied { frames, tied } => {
            format!("only {tied} of {frames} frames overlap with each other")
        }
        Abstention::LittlePaint { places } => format!("only {places} places of paint agree between the frames"),
        other => other.to_string(),
    }
}

/// Which view is missing, and the way that leads out.
fn what_helps(why: &Abstention) -> String {
    let missing = match why {
        Abstention::NotTied { .. } => {
            "Add frames in which the camera turns from one view to the next, all of one camera that does not move"
                .to_owned()
        }
        Abstention::LittlePaint { .. } => "Add wide frames: the centre circle and both penalty areas".to_owned(),
        Abstention::Uncertain { doubts, .. } => view_missing(doubts),
        _ => "Check that the field's sport is the one in the pictures".to_owned(),
    };
    let clicks = match why {
        Abstention::NotTied { .. } | Abstention::NotTurning(_) => "click 4 landmarks on 2 wide frames",
        _ => "click 2 landmarks far from each other and look again",
    };
    format!("{missing}, or {clicks}.")
}

/// Which view would settle doubts.
fn view_missing(doubts: &[Doubt]) -> String {
    let lines = doubts.iter().find_map(|doubt| match doubt {
        Doubt::LinesMissing { lines } => Some(lines.join(", ")),
        _ => None,
    });
    if let Some(lines) = lines {
        return format!("A view of {lines} is missing: add frames that show it");
    }
    let is_of_field = |doubt: &Doubt| matches!(doubt, Doubt::Unexplained { .. } | Doubt::OffLines { .. });
    if doubts.iter().any(is_of_field) {
        return "Check the field's size and sport, and whether other lines are painted there; add wide frames"
            .to_owned();
    }
    "Wide views of both ends and of the middle are missing: add such frames".to_owned()
}
