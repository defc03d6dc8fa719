//! Acceptance of a frame whose camera is probably wrong: the program asks once, and offers a
//! remedy.

use crate::app::App;
use crate::app::review::percent;
use crate::app::window_state::session::{Level, PendingAcceptance};
use crate::app::{Command, sentence};
use touchline_core::solve::{IdentityKind, Verdict, Warning, WarningCode};

impl App {
    /// The reason why the shown frame is probably wrong, as a sentence. None if nothing contradicts
    /// it.
    pub fn doubt(&self) -> Option<String> {
        self.doubt_of_clicks().or_else(|| self.doubt_of_camera())
    }

    /// A reason apart from the clicks: the low confidence of the proposal, or the paint.
    fn doubt_of_camera(&self) -> Option<String> {
        if let Some(confidence) = self.frame()?.unlikely() {
            return Some(format!(
                "This proposal is right with a probability of only {}.",
                percent(confidence)
            ));
        }
        let contradicted = self.frame()?.ptz.is_some() && self.paint_forbids(self.session.frame);
        contradicted.then(|| {
            "The paint contradicts this camera: its lines lie elsewhere in the picture.".to_owned()
        })
    }

    /// A reason from the clicks: they contradict each other.
    fn doubt_of_clicks(&self) -> Option<String> {
        let judgement = self
            .current
            .judgement
            .as_ref()
            .filter(|judgement| judgement.verdict == Verdict::Wrong)?;
        Some(match self.farthest_click() {
            Some((click, px)) => format!("Point {} is {px:.0} px off.", click + 1),
            None => sentence(&judgement.reason),
        })
    }

    /// The click with the largest residual, in units of its σ, and its distance from the
    /// projection, px. None if the residual is within the usual scatter.
    fn farthest_click(&self) -> Option<(usize, f64)> {
        /// The same limit as in the list of points, which marks larger residuals.
        const SIGMAS: f64 = 3.0;
        let solved = self.current.click_solution()?;
        let used = solved.residuals.iter().filter_map(|residual| {
            let px = residual.distance_px()?;
            Some((residual.click, px, px / residual.sigma_px))
        });
        // If two points contradict each other, either may be wrong.
        if solved.residuals.len() + solved.checks.len() <= 2 {
            return None;
        }
        let held_out = solved
            .checks
            .iter()
            .filter_map(|check| Some((check.click, check.error_px?, check.z_score?)));
        let (click, px, sigmas) = used.chain(held_out).max_by(|a, b| a.2.total_cmp(&b.2))?;
        (sigmas > SIGMAS).then_some((click, px))
    }

    /// The warning that caused the verdict on the shown frame.
    pub fn cause(&self) -> Option<&Warning> {
        let reason = &self.current.judgement.as_ref()?.reason;
        self.current
            .click_solution()?
            .warnings
            .iter()
            .find(|warning| warning.message == *reason)
    }

    /// The command that corrects the shown frame, if there is one, and the label of its button.
    pub fn mend(&self) -> Option<(Command, &'static str)> {
        let solved = self.current.click_solution()?;
        if let Some(found) = self.current.other_names() {
            let word = match found.kind {
                IdentityKind::Swapped => "Swap",
                IdentityKind::Mirrored(_) => "Mirror names",
                IdentityKind::WrongName | IdentityKind::OtherPart { .. } => "Rename",
            };
            return Some((Command::MendNames, word));
        }
        let two_roots = solved
            .warnings
            .iter()
            .any(|warning| warning.code == WarningCode::TwoRoots);
        (two_roots && self.current.other_root().is_some())
            .then_some((Command::SwitchRoot, "Switch"))
    }

    /// Asks whether to accept the shown frame although it looks wrong. Returns false if nothing
    /// contradicts it, or the question has been shown since the frame's last change. `stay` is
    /// stored for the answer.
    pub(super) fn asks_about_doubt(&mut self, stay: bool) -> bool {
        let (Some(doubt), Some(open)) = (self.doubt(), &self.open) else {
            return false;
        };
        let Some(frame) = open.frame(self.session.frame) else {
            return false;
        };
        let doubted = PendingAcceptance {
            frame: frame.id.clone(),
            version: open.document.version(),
            stay,
        };
        let again = self.session.doubted.as_ref().is_some_and(|before| {
            (&before.frame, before.version) == (&doubted.frame, doubted.version)
        });
        if again {
            return false;
        }
        // Suggest a correction; without one, the renaming of the worst click.
        let farthest = self.farthest_click().map(|(click, _)| click);
        let mut offers: Vec<_> = self
            .mend()
            .map(|(command, word)| (word, command))
            .into_iter()
            .collect();
        if offers.is_empty() && farthest.is_some() {
            self.session.points.selected = farthest;
            offers.push(("Rename", Command::RenameClick));
        }
        offers.push(("Accept anyway", Command::AcceptAnyway));
        self.session.retract(Command::AcceptAnyway);
        self.session.notify_with(Level::Question, doubt, offers);
        self.session.doubted = Some(doubted);
        true
    }

    /// Accepts a frame that looks wrong: marks the question as answered, and accepts.
    pub(in crate::app::update) fn accept_anyway(&mut self) {
        let Some(open) = &self.open else { return };
        let Some(frame) = open.frame(self.session.frame) else {
            return;
        };
        let stay = self
            .session
            .doubted
            .take()
            .is_some_and(|doubted| doubted.frame == frame.id && doubted.stay);
        self.session.doubted = Some(PendingAcceptance {
            frame: frame.id.clone(),
            version: open.document.version(),
            stay,
        });
        self.accept(stay);
    }
}
