//! What belongs to the user changes, and is kept.

use super::App;
use crate::app::action::Action;
use crate::app::effect::Effect;
use crate::app::settings::{PICTURE_MEMORY_MIB, text_size_within_limits};
use crate::scene::OverlayStyle;

impl App {
    /// How the lines are drawn over the shown frame.
    #[must_use]
    pub fn overlay_style(&self) -> OverlayStyle {
        let template = self.shown_field_spec().map(|spec| spec.template.as_str()).unwrap_or_default();
        self.settings.overlay_of(template)
    }

    /// Changes one of the user's settings; other actions change nothing.
    pub(super) fn set_setting(&mut self, action: &Action) {
        let settings = &mut self.settings;
        match *action {
            Action::SetOverlayStyle(style) => settings.overlay = style,
            Action::SetTheme(theme) => settings.theme = theme,
            Action::SetLineColour(sport, colour) => settings.set_line_colour(sport, colour),
            Action::SetLoupe(loupe) => settings.loupe = loupe.within_limits(),
            Action::SetPictureMemory(mib) => {
                settings.picture_memory_mib = mib.clamp(*PICTURE_MEMORY_MIB.start(), *PICTURE_MEMORY_MIB.end());
            }
            Action::SetPictureLook(look) => settings.picture = look.within_limits(),
            Action::SetTextSize(size) => settings.text_size = text_size_within_limits(size),
            Action::SetPanelSizes { side, filmstrip } => {
                settings.side_width = side;
                settings.filmstrip_height = filmstrip;
            }
            _ => return,
        }
        self.effects.push(Effect::SaveSettings);
    }
}
