//! Acceptance of a frame whose camera is probably wrong: the program asks once, and offers a
//! remedy.

use crate::app::review::percent;
use crate::app::window_state::session::{Level, PendingAcceptance};
use crate::app::{App, Command, LineOffset, sentence};
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{CHECK_MISFIT, IdentityKind, Judgement, Verdict, Warning, WarningCode};
use touchline_documents::document::FrameStatus;

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

impl App {
    /// The verdict on the shown frame. A good one becomes *check* if the painted lines or the
    /// neighbouring frames contradict it. Neighbours also count for a reference without a verdict
    /// of its own.
    pub fn judgement(&self) -> Option<Judgement> {
        // If the clicks contradict each other, that reason is the one to read. Numbers that were
        // set by hand have no clicks that could.
        let judgement = self.current.judgement.clone();
        let is_uncertain = self.is_only_uncertain();
        if let Some(judgement) = &judgement
            && judgement.verdict != Verdict::Good
            && !is_uncertain
            && !self.current.by_hand
        {
            return Some(judgement.clone());
        }
        // Then the paint: it sees what two clicks cannot, and it is the number that row, timeline
        // and review state, too.
        let frame = self.session.frame;
        if let Some(beside) = self.line_beside_paint(frame) {
            let LineOffset {
                line, offset_px, ..
            } = beside;
            let px = offset_px.abs();
            return Some(check(format!("{line}: {px:.0} px beside its paint")));
        }
        let says = self.paint_says(frame).filter(|_| judgement.is_some());
        match says {
            Some(says) if says.verdict == LineVerdict::Contradicts => {
                return Some(check(says.describe()));
            }
            // Clicks close together leave the corners open; paint that is found there does not.
            Some(says) if says.verdict == LineVerdict::Supports && is_uncertain => {
                return Some(Judgement {
                    verdict: Verdict::Good,
                    reason: says.describe(),
                });
            }
            _ => {}
        }
        // The panel shows a proposal's disagreement with its neighbours elsewhere.
        let is_reference = self
            .frame()
            .is_some_and(|frame| frame.status == FrameStatus::Reference);
        if let Some(off) = self.current.off_neighbours
            && (judgement.is_some() || is_reference)
        {
            return Some(check(format!(
                "{:.0} px off the way between the frames before and after it",
                off.apart_px
            )));
        }
        judgement
    }

    /// Whether the clicks are in doubt only because they leave the corners of the picture
    /// uncertain, and nothing contradicts them.
    fn is_only_uncertain(&self) -> bool {
        let Some(solved) = self.current.click_solution() else {
            return false;
        };
        let is_uncertainty = |warning: &Warning| {
            matches!(
                warning.code,
                WarningCode::Separation | WarningCode::Extrapolation
            )
        };
        let is_check = |judgement: &Judgement| judgement.verdict == Verdict::Check;
        self.current.judgement.as_ref().is_some_and(is_check)
            && solved.warnings.iter().all(is_uncertainty)
            && solved.misfit().is_none_or(|misfit| misfit <= CHECK_MISFIT)
    }
}

/// The verdict *check* with a reason.
fn check(reason: String) -> Judgement {
    Judgement {
        verdict: Verdict::Check,
        reason,
    }
}
