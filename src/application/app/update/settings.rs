//! Changes of the user's settings; each is written to disk.

use super::{App, Settings};
use crate::app::action::SettingsAction;
use crate::app::effect::Effect;
use crate::app::settings::{PICTURE_MEMORY_MIB, text_size_within_limits};
use crate::scene::OverlayStyle;

impl App {
    /// The style of the lines over the shown frame.
    pub fn overlay_style(&self) -> OverlayStyle {
        let template = self
            .shown_field_spec()
            .map(|spec| spec.template.as_str())
            .unwrap_or_default();
        self.settings.overlay_of(template)
    }

    /// Switches a setting on or off.
    pub(super) fn toggle_setting(&mut self, switch_of: fn(&mut Settings) -> &mut bool) {
        let switch = switch_of(&mut self.settings);
        *switch = !*switch;
        self.effects.push(Effect::SaveSettings);
    }

    /// Changes a setting. Values outside their range are clamped.
    pub(super) fn set_setting(&mut self, action: SettingsAction) {
        let settings = &mut self.settings;
        match action {
            SettingsAction::OverlayStyle(style) => settings.overlay = style,
            SettingsAction::Theme(theme) => settings.theme = theme,
            SettingsAction::LineColour(sport, colour) => settings.set_line_colour(sport, colour),
            SettingsAction::Loupe(loupe) => settings.loupe = loupe.within_limits(),
            SettingsAction::PictureMemory(mib) => {
                settings.picture_memory_mib =
                    mib.clamp(*PICTURE_MEMORY_MIB.start(), *PICTURE_MEMORY_MIB.end());
            }
            SettingsAction::PictureLook(look) => settings.picture = look.within_limits(),
            SettingsAction::TextSize(size) => settings.text_size = text_size_within_limits(size),
            SettingsAction::PanelSizes { side, filmstrip } => {
                settings.side_width = side;
                settings.filmstrip_height = filmstrip;
            }
            SettingsAction::AssignKey(command, chord) => self.assign_key(command, chord),
            SettingsAction::ResetKeys => settings.keys.reset(),
            SettingsAction::Details(shown) => settings.details = shown,
        }
        self.effects.push(Effect::SaveSettings);
    }
}
