//! Names of clicks: the list of candidates, automatic names, and changes of names.

use crate::app::panel_values::current::rank_names;
use crate::app::window_state::corner_looks::CornerLooks;
use crate::app::window_state::naming::unambiguous;
use crate::app::window_state::session::{Level, Mode, Naming, PictureView};
use crate::app::{App, Command};
use touchline_documents::document::{BetterName, Frame, Target};

impl App {
    /// The label of a landmark or line; its id if the field lacks it.
    pub fn label(&self, target: &Target) -> String {
        let label = self
            .current
            .field()
            .and_then(|field| target.element(field)?.label(field));
        label.unwrap_or_else(|| target.as_str()).to_owned()
    }

    /// The candidates for a click of the shown frame, best first.
    fn ranked_names(&mut self, click: usize, lines: bool) -> Option<Naming> {
        self.names_by_looks(click, lines, None)
    }

    /// The same, by how the clicked spot looks as well.
    fn names_by_looks(
        &mut self,
        click: usize,
        lines: bool,
        looks: Option<CornerLooks>,
    ) -> Option<Naming> {
        let frame = self.session.frame;
        let contradicted = self.is_contradicted(frame);
        rank_names(
            self.open.as_mut()?,
            frame,
            click,
            lines,
            contradicted,
            looks,
        )
    }

    /// Ranks the listed names anew, now that the picture was looked at. The list stays as it is
    /// once the user has chosen in it.
    pub(in crate::app::update) fn look_at_click(&mut self, looks: CornerLooks) {
        let Mode::Naming(naming) = &self.session.mode else {
            return;
        };
        let (click, lines, refines) = (naming.click, naming.lines, naming.refines);
        let is_fresh = naming.typed.is_empty() && naming.highlighted == 0;
        let ranked = self.names_by_looks(click, lines, Some(looks.clone()));
        if let Mode::Naming(naming) = &mut self.session.mode {
            match ranked.filter(|_| is_fresh) {
                Some(ranked) => *naming = Naming { refines, ..ranked },
                None => naming.looks = Some(looks),
            }
        }
    }

    /// Shows the candidates for a click at the cursor. Lists lines if the next click is to be on a
    /// line, or the click is on one already.
    pub(in crate::app::update) fn open_naming(&mut self, click: usize) {
        let lines = self.session.is_next_on_line()
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

    /// Shows the candidates for the first click without a name. If the picture is magnified,
    /// centres it on the click.
    pub(in crate::app::update) fn name_next(&mut self) {
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

    /// While a click is being placed: names it if exactly one name is plausible, and removes the
    /// name otherwise. Called for every movement, so the name follows the pointer.
    pub(super) fn name_if_certain(&mut self, click: usize) {
        let Some(naming) = self.ranked_names(click, self.session.is_next_on_line()) else {
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

    /// Closes the list of names.
    pub(in crate::app::update) fn leave_naming(&mut self) {
        self.session.mode = Mode::Idle;
    }

    /// Filters the list by the text that the user typed.
    pub(in crate::app::update) fn type_name(&mut self, typed: String) {
        if let Mode::Naming(naming) = &mut self.session.mode {
            naming.typed = typed;
            naming.highlighted = 0;
        }
    }

    /// Shows other names for the click that was just named automatically. It keeps its name until
    /// the user chooses another one.
    pub(in crate::app::update) fn refine_name(&mut self, typed: String) {
        let Some(click) = self
            .session
            .points
            .named_automatically
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

    /// Highlights a candidate in the list.
    pub(in crate::app::update) fn highlight_name(&mut self, index: usize) {
        if let Mode::Naming(naming) = &mut self.session.mode {
            naming.highlighted = index.min(naming.listed_candidates().len().saturating_sub(1));
        }
    }

    /// Gives the click the candidate at an index in the list.
    pub(in crate::app::update) fn take_name(&mut self, index: usize) {
        let Mode::Naming(naming) = &self.session.mode else {
            return;
        };
        let Some(target) = naming
            .listed_candidates()
            .get(index)
            .map(|candidate| candidate.target.clone())
        else {
            return;
        };
        let click = naming.click;
        self.name_click(click, target);
    }

    /// Lists lines or landmarks; without an open list, sets what the next click is.
    pub(in crate::app::update) fn list_lines(&mut self, lines: bool) {
        if let Mode::Naming(naming) = &self.session.mode {
            let (click, refines, typed) = (naming.click, naming.refines, naming.typed.clone());
            let looks = naming.looks.clone();
            if let Some(mut naming) = self.names_by_looks(click, lines, looks) {
                (naming.refines, naming.typed) = (refines, typed);
                self.session.mode = Mode::Naming(naming);
            }
        } else {
            self.session.points.next_on_line = lines;
        }
    }

    /// Uses a name that the user chose elsewhere (on the map or in a panel). It goes to the click
    /// that waits for a name, otherwise to the selected click if that has none, otherwise to the
    /// next click in the picture. A landmark that is clicked already is selected.
    pub(in crate::app::update) fn pick(&mut self, target: Target) {
        // A point that lacks a name comes first: the choice is most likely meant for it.
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

    /// Renames the clicks to the names that fit; one step of undo.
    pub(in crate::app::update) fn mend_names(&mut self) {
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
                        click.take_over();
                        click.target = Some(target);
                    }
                }
            }
            self.clicks_changed();
            self.commit();
        }
    }

    /// Warns if a landmark is not marked by paint and the camera has no base yet: users then click
    /// where a curve looks widest, which is a different point.
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
        self.session.warn(text);
    }

    /// Exchanges the names of two clicks; one step of undo.
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
                        click.take_over();
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

    /// Gives a click a name; one step of undo. If another click has that landmark already, the two
    /// exchange their names, or the name is refused if this click has none to give.
    pub(in crate::app::update) fn name_click(&mut self, click: usize, target: Target) {
        let Some(frame) = self.frame() else { return };
        if click >= frame.clicks.len() {
            return;
        }
        let own = frame.clicks[click].target.clone();
        // Several clicks may be on one line, but a landmark is only one point.
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
            self.session.warn(text);
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
                click.take_over();
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
