//! Giving a click its name.

use super::App;
use crate::app::Command;
use crate::app::current::rank_names;
use crate::app::naming::unambiguous;
use crate::app::session::{Level, Mode, Naming, OFFERED, PictureView};
use touchline_documents::document::{BetterName, Frame, Target};

impl App {
    /// The label of a landmark or line; its id where the field lacks it.
    #[must_use]
    pub fn label(&self, target: &Target) -> String {
        let label = self
            .current
            .field()
            .and_then(|field| target.element(field)?.label(field));
        label.unwrap_or_else(|| target.as_str()).to_owned()
    }

    /// The names for a click of the shown frame, the likeliest first.
    fn ranked_names(&mut self, click: usize, lines: bool) -> Option<Naming> {
        let frame = self.session.frame;
        let contradicted = self.is_contradicted(frame);
        rank_names(self.open.as_mut()?, frame, click, lines, contradicted)
    }

    /// Asks for the name of a click, with candidates at the cursor.
    pub(super) fn open_naming(&mut self, click: usize) {
        let lines = self.session.points.next_on_line
            || self
                .frame()
                .and_then(|frame| frame.clicks.get(click))
                .and_then(|click| click.target.as_ref()?.line())
                .is_some();
        if let Some(naming) = self.ranked_names(click, lines) {
            self.session.points.selected = Some(click);
            self.session.mode = Mode::Naming(naming);
        }
    }

    /// Asks for the name of the first click that has none, in the middle of the picture where that
    /// is zoomed.
    pub(super) fn name_next(&mut self) {
        let Some(click) = self.frame().and_then(Frame::unnamed_click) else {
            return;
        };
        let at = self
            .frame()
            .and_then(|frame| frame.clicks.get(click))
            .map(|click| click.image);
        if let (PictureView::Zoomed { centre, .. }, Some(at)) = (&mut self.session.picture.view, at)
        {
            *centre = at;
        }
        self.open_naming(click);
    }

    /// Names a click that is being placed while there is just one plausible name; the name follows
    /// the pointer.
    pub(super) fn name_if_certain(&mut self, click: usize) {
        let Some(naming) = self.ranked_names(click, self.session.points.next_on_line) else {
            return;
        };
        let target = unambiguous(&naming.candidates).map(|candidate| candidate.target.clone());
        if let Some(click) = self
            .frame_mut()
            .and_then(|frame| frame.clicks.get_mut(click))
        {
            click.target = target;
        }
    }

    /// Leaves the list of names; a click without a name stays and says so.
    pub(super) fn leave_naming(&mut self) {
        self.session.mode = Mode::Idle;
    }

    pub(super) fn type_name(&mut self, typed: String) {
        if let Mode::Naming(naming) = &mut self.session.mode {
            naming.typed = typed;
            naming.highlighted = 0;
        }
    }

    /// Offers other names for the click that was just named by itself. Until one is taken it keeps
    /// its name.
    pub(super) fn refine_name(&mut self, typed: String) {
        let Some(click) = self
            .session
            .points
            .named_unasked
            .filter(|_| self.session.mode == Mode::Idle)
        else {
            return;
        };
        self.session.forget_placed();
        self.open_naming(click);
        if let Mode::Naming(naming) = &mut self.session.mode {
            naming.refines = true;
        }
        self.type_name(typed);
    }

    pub(super) fn highlight_name(&mut self, index: usize) {
        if let Mode::Naming(naming) = &mut self.session.mode {
            naming.highlighted = index.min(naming.offered().len().saturating_sub(1));
        }
    }

    pub(super) fn take_name(&mut self, index: usize) {
        let Mode::Naming(naming) = &self.session.mode else {
            return;
        };
        let Some(target) = naming
            .offered()
            .get(index.min(OFFERED))
            .map(|candidate| candidate.target.clone())
        else {
            return;
        };
        let click = naming.click;
        self.name_click(click, target);
    }

    pub(super) fn offer_lines(&mut self, lines: bool) {
        if let Mode::Naming(naming) = &self.session.mode {
            let (click, refines, typed) = (naming.click, naming.refines, naming.typed.clone());
            if let Some(mut naming) = self.ranked_names(click, lines) {
                (naming.refines, naming.typed) = (refines, typed);
                self.session.mode = Mode::Naming(naming);
            }
        } else {
            self.session.points.next_on_line = lines;
        }
    }

    /// A name picked elsewhere: it goes to the click that waits for one, else to the selected click
    /// that has none, else to the next click in the picture.
    pub(super) fn pick(&mut self, target: Target) {
        let waiting = match &self.session.mode {
            Mode::Naming(naming) => Some(naming.click),
            _ => self.session.points.selected.filter(|selected| {
                let click = self.frame().and_then(|frame| frame.clicks.get(*selected));
                click.is_some_and(|click| click.target.is_none())
            }),
        };
        if let Some(click) = waiting {
            self.name_click(click, target);
            return;
        }
        let Some(frame) = self.frame() else { return };
        let known = frame
            .clicks
            .iter()
            .position(|click| click.target.as_ref() == Some(&target));
        match known.filter(|_| matches!(target, Target::Landmark(_))) {
            Some(click) => self.session.points.selected = Some(click),
            None => self.session.mode = Mode::Placing(target),
        }
    }

    /// Gives the clicks the names that fit: one step of undo.
    pub(super) fn mend_names(&mut self) {
        let Some(found) = self.current.other_names() else {
            return;
        };
        let (step, renames): (String, Vec<BetterName>) =
            (found.step(), BetterName::all(found).collect());
        self.session.mode = Mode::Idle;
        self.session.forget_placed();
        self.session.picture.held.compare = false;
        if self.begin(step) {
            if let Some(frame) = self.frame_mut() {
                for BetterName { click, target } in renames {
                    if let Some(click) = frame.clicks.get_mut(click) {
                        click.target = Some(target);
                    }
                }
            }
            self.clicks_changed();
            self.commit();
        }
    }

    /// Warns of a name that nothing painted marks while no base is known: people click where the
    /// curve looks widest.
    pub(super) fn warn_of_unmarked(&mut self, target: &Target) {
        let (Target::Landmark(id), Some(field), None) =
            (target, self.current.field(), self.current.base)
        else {
            return;
        };
        let Some(landmark) = field
            .landmark(id.as_str())
            .filter(|landmark| landmark.is_unmarked)
        else {
            return;
        };
        let text = format!(
            "{} is not where the curve looks widest or nearest in the picture: clicks there are 7 to 9 px off. Better choose a \
             corner or crossing until the camera's base is known.",
            landmark.label
        );
        self.session.notify(Level::Warning, text);
    }

    /// Two clicks get each other's names: one step of undo.
    fn swap_names(&mut self, clicks: [usize; 2], names: [Target; 2]) {
        self.session.mode = Mode::Idle;
        self.session.points.next_on_line = false;
        self.session.forget_placed();
        let numbers = clicks.map(|click| click + 1);
        if self.begin(format!(
            "Swap the names of points {} and {}",
            numbers[0], numbers[1]
        )) {
            if let Some(frame) = self.frame_mut() {
                for (click, name) in clicks.into_iter().zip(names) {
                    if let Some(click) = frame.clicks.get_mut(click) {
                        click.target = Some(name);
                    }
                }
            }
            self.session.points.selected = Some(clicks[0]);
            self.clicks_changed();
            self.commit();
            let text = format!(
                "Points {} and {} have swapped their names.",
                numbers[0], numbers[1]
            );
            self.session
                .notify_with(Level::Info, text, [("Undo", Command::Undo)]);
        }
    }

    pub(super) fn name_click(&mut self, click: usize, target: Target) {
        let Some(frame) = self.frame() else { return };
        if click >= frame.clicks.len() {
            return;
        }
        let own = frame.clicks[click].target.clone();
        let twin = frame.clicks.iter().enumerate().position(|(index, other)| {
            index != click
                && matches!(target, Target::Landmark(_))
                && other.target.as_ref() == Some(&target)
        });
        let label = self.label(&target);
        if let (Some(twin), Some(own)) = (twin, own) {
            self.swap_names([click, twin], [target, own]);
            return;
        }
        if let Some(twin) = twin {
            let text = format!(
                "{label} is already point {} of this frame. Delete or rename that one first.",
                twin + 1
            );
            self.session.notify(Level::Warning, text);
            return;
        }
        self.session.mode = Mode::Idle;
        self.session.points.next_on_line = false;
        self.session.forget_placed();
        if self.begin(format!("Name {label}")) {
            if let Some(click) = self
                .frame_mut()
                .and_then(|frame| frame.clicks.get_mut(click))
            {
                click.target = Some(target.clone());
            }
            self.session.points.selected = Some(click);
            self.clicks_changed();
            self.commit();
            self.warn_of_unmarked(&target);
            self.snap_named(click);
        }
    }
}
