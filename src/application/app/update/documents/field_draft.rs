//! The field editor: a template that is written in the window, kept in a file beside the project,
//! and used by it.

use crate::app::App;
use crate::app::action::FieldChange;
use crate::app::effect::{Effect, TemplateOrder};
use crate::app::window_state::field_draft::FieldDraft;
use crate::app::window_state::session::Dialog;
use std::path::Path;
use touchline_core::field::Template;
use touchline_core::geometry::pluralise;

impl App {
    /// Opens the field editor: with the draft that there is, else with the template of its own that
    /// the project uses, or with a copy of a built-in template
    /// if one is named; a name that no template has begins with boundary lines alone.
    pub(in crate::app::update) fn edit_field_template(&mut self, copied: Option<&str>) {
        match copied {
            Some(name) => self.session.field_draft = Some(FieldDraft::begin(name)),
            None if self.session.field_draft.is_none() => {
                let (open, spec) = (self.open.as_ref(), self.shown_field_spec());
                if let Some((open, spec)) = open.zip(spec.filter(|spec| spec.is_file())) {
                    // The editor opens when the text is there.
                    return self.effects.push(Effect::Template {
                        of: open.file.clone(),
                        folder: open.folder.clone(),
                        name: spec.template.clone(),
                        order: TemplateOrder::ReadText,
                    });
                }
                self.session.field_draft = Some(FieldDraft::begin(""));
            }
            None => {}
        }
        self.session.dialog = Some(Dialog::FieldEditor);
    }

    /// Opens the field editor with the template that the project uses.
    pub(in crate::app::update) fn field_template_text(
        &mut self,
        of: &Path,
        name: String,
        text: String,
    ) {
        if self.open.as_ref().is_some_and(|open| open.file == of) {
            self.session.field_draft = Some(FieldDraft::from_file(name, text));
            self.session.dialog = Some(Dialog::FieldEditor);
        }
    }

    /// Changes the draft.
    pub(in crate::app::update) fn change_field_draft(&mut self, change: FieldChange) {
        let Some(draft) = &mut self.session.field_draft else {
            return;
        };
        match change {
            FieldChange::Text(text) => draft.set_text(text),
            FieldChange::Draw(line, mirrored) => draft.draw(line, mirrored),
            FieldChange::Undo => draft.undo(),
            FieldChange::AddLandmarks => {
                let added = draft.add_landmarks();
                let text = match added {
                    0 => "Every place where lines meet or end has its landmark.".to_owned(),
                    _ => format!(
                        "{} added where lines meet or end.",
                        pluralise(added, "landmark")
                    ),
                };
                self.session.note(text);
            }
        }
    }

    /// Writes the draft into its file beside the project.
    pub(in crate::app::update) fn save_field_template(&mut self) {
        if self.is_read_only() {
            let text = "The document is read-only.";
            return self.session.warn(text);
        }
        let (Some(open), Some(draft)) = (&self.open, &self.session.field_draft) else {
            return;
        };
        let Some(name) = draft.file_name() else {
            return;
        };
        let order = TemplateOrder::Write {
            text: draft.text().to_owned(),
            replaces: draft.saved_as.as_ref() == Some(&name),
        };
        self.effects.push(Effect::Template {
            of: open.file.clone(),
            folder: open.folder.clone(),
            name,
            order,
        });
    }

    /// The draft is in its file: the project uses it.
    pub(in crate::app::update) fn field_template_written(
        &mut self,
        of: &Path,
        name: &str,
        template: Box<Template>,
    ) {
        let Some(open) = self.open.as_mut().filter(|open| open.file == of) else {
            return;
        };
        let title = template.title.clone();
        open.template_read(name, Ok(template));
        if let Some(draft) = &mut self.session.field_draft {
            draft.saved_as = Some(name.to_owned());
        }
        let text = if self.use_template(name) {
            format!("Field: {title}, kept in {name} beside the project.")
        } else {
            format!("{title} is kept in {name} beside the project.")
        };
        self.session.note(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, DiskReport, EditAction, ViewAction};
    use touchline_documents::testing::document;

    fn app() -> App {
        App::with_document(document(&["1.png"]))
    }

    /// The file that an action writes: its name, its text, and whether it replaces one.
    fn written(effects: &[Effect]) -> Option<(&str, &str, bool)> {
        effects.iter().find_map(|effect| match effect {
            Effect::Template {
                name,
                order: TemplateOrder::Write { text, replaces },
                ..
            } => Some((name.as_str(), text.as_str(), *replaces)),
            _ => None,
        })
    }

    #[test]
    fn a_draft_replaces_no_file_but_its_own() {
        let mut app = app();
        app.update(Action::View(ViewAction::EditFieldTemplate(None)));
        assert_eq!(app.session.dialog, Some(Dialog::FieldEditor));
        let effects = app.update(Action::Edit(EditAction::SaveFieldTemplate));
        let (name, text, replaces) = written(&effects).unwrap();
        assert_eq!((name, replaces), ("my_court.json", false));
        let of = app.open().unwrap().file.clone();
        app.update(Action::Disk(DiskReport::TemplateWritten {
            of: of.clone(),
            name: name.to_owned(),
            template: Box::new(Template::from_json(text, name).unwrap()),
        }));
        let effects = app.update(Action::Edit(EditAction::SaveFieldTemplate));
        assert!(written(&effects).unwrap().2);

        // The file of the project's field in a later session is its own, too.
        app.update(Action::Disk(DiskReport::TemplateText {
            of,
            name: "my_tennis.json".to_owned(),
            text: FieldDraft::begin("tennis").text().to_owned(),
        }));
        let effects = app.update(Action::Edit(EditAction::SaveFieldTemplate));
        let (name, _, replaces) = written(&effects).unwrap();
        assert_eq!((name, replaces), ("my_tennis.json", true));
    }

    #[test]
    fn a_draft_with_a_mistake_is_not_saved_and_stays_when_the_editor_is_closed() {
        let mut app = app();
        app.update(Action::View(ViewAction::EditFieldTemplate(Some(
            "tennis".to_owned(),
        ))));
        let broken = FieldChange::Text("{".to_owned());
        app.update(Action::View(ViewAction::ChangeFieldTemplate(broken)));
        let effects = app.update(Action::Edit(EditAction::SaveFieldTemplate));
        assert_eq!(written(&effects), None);
        app.update(Action::View(ViewAction::CloseDialog));
        app.update(Action::View(ViewAction::EditFieldTemplate(None)));
        assert_eq!(app.session.field_draft.as_ref().unwrap().text(), "{");
    }
}
