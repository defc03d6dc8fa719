//! The colours of the window in the dark and the light theme, and how drawing code finds them.

use egui::{Color32, Context, Painter, Theme, Ui};
use touchline_core::solve::Verdict;
use touchline_documents::document::FrameStatus;

/// The colours of one theme.
///
/// There is one accent colour. A status or a verdict is never shown by colour alone: each has a
/// letter or a word and, on the filmstrip, its own pattern. The hues are those of Okabe and Ito,
/// which colour-blind users can distinguish, lighter on dark and darker on light grounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Ground of the picture and of plots.
    pub backdrop: Color32,
    /// Ground of panels.
    pub panel: Color32,
    /// Ground of what is on a panel: cards, fields.
    pub raised: Color32,
    /// Ground of windows and menus.
    pub window: Color32,
    /// Border of windows.
    pub window_line: Color32,
    /// Ground of a control.
    pub control: Color32,
    /// Ground of a control under the pointer.
    pub hovered: Color32,
    /// Border of a control under the pointer.
    pub hovered_line: Color32,
    /// Lines that separate.
    pub line: Color32,
    /// Ordinary text.
    pub text: Color32,
    /// Titles and values.
    pub strong: Color32,
    /// Secondary text. Its contrast is at least 4.5 to 1 on every ground.
    pub weak: Color32,
    /// The accent: what is selected, and the main action.
    pub accent: Color32,
    /// The accent under the pointer.
    pub accent_hovered: Color32,
    pub accent_ground: Color32,
    /// Letters on the accent and on the colours of verdicts.
    pub on_accent: Color32,
    /// A good verdict.
    pub good: Color32,
    /// A verdict that calls for a review.
    pub caution: Color32,
    /// A wrong result.
    pub bad: Color32,
    /// On maps: directions of the field that no frame sees.
    pub missing: Color32,
    /// On maps: directions outside the field that no frame sees.
    pub outside: Color32,
    /// Frames without any work.
    new: Color32,
    /// Frames with points.
    draft: Color32,
    /// Frames that cannot be calibrated.
    rejected: Color32,
}

/// Light text on dark grounds.
pub const DARK: Palette = Palette {
    backdrop: Color32::from_rgb(13, 15, 17),
    panel: Color32::from_rgb(24, 26, 29),
    raised: Color32::from_rgb(33, 36, 40),
    window: Color32::from_rgb(29, 32, 36),
    window_line: Color32::from_rgb(62, 67, 75),
    control: Color32::from_rgb(43, 47, 53),
    hovered: Color32::from_rgb(55, 60, 68),
    hovered_line: Color32::from_rgb(84, 91, 101),
    line: Color32::from_rgb(48, 52, 58),
    text: Color32::from_rgb(208, 213, 219),
    strong: Color32::from_rgb(242, 244, 247),
    weak: Color32::from_rgb(162, 170, 180),
    accent: Color32::from_rgb(64, 146, 255),
    accent_hovered: Color32::from_rgb(92, 164, 255),
    accent_ground: Color32::from_rgb(31, 56, 90),
    on_accent: Color32::from_rgb(13, 15, 17),
    good: Color32::from_rgb(44, 196, 150),
    caution: Color32::from_rgb(242, 183, 64),
    bad: Color32::from_rgb(255, 112, 84),
    missing: Color32::from_rgb(96, 46, 40),
    outside: Color32::from_rgb(20, 22, 25),
    new: Color32::from_rgb(140, 147, 158),
    draft: Color32::from_rgb(98, 184, 240),
    rejected: Color32::from_rgb(214, 134, 178),
};

/// Dark text on light grounds.
pub const LIGHT: Palette = Palette {
    backdrop: Color32::from_rgb(250, 251, 252),
    panel: Color32::from_rgb(240, 242, 244),
    raised: Color32::from_rgb(252, 253, 254),
    window: Color32::from_rgb(247, 248, 250),
    window_line: Color32::from_rgb(176, 183, 192),
    control: Color32::from_rgb(225, 229, 234),
    hovered: Color32::from_rgb(211, 217, 224),
    hovered_line: Color32::from_rgb(150, 158, 168),
    line: Color32::from_rgb(205, 211, 218),
    text: Color32::from_rgb(45, 50, 57),
    strong: Color32::from_rgb(12, 15, 19),
    weak: Color32::from_rgb(76, 83, 92),
    accent: Color32::from_rgb(0, 92, 200),
    accent_hovered: Color32::from_rgb(0, 78, 172),
    accent_ground: Color32::from_rgb(198, 219, 246),
    on_accent: Color32::from_rgb(255, 255, 255),
    good: Color32::from_rgb(0, 106, 76),
    caution: Color32::from_rgb(133, 84, 0),
    bad: Color32::from_rgb(176, 42, 18),
    missing: Color32::from_rgb(236, 190, 180),
    outside: Color32::from_rgb(229, 232, 236),
    new: Color32::from_rgb(95, 102, 112),
    draft: Color32::from_rgb(0, 99, 158),
    rejected: Color32::from_rgb(147, 52, 106),
};

/// The colours over a picture. Texts there are on dark plates in both themes.
pub const ON_PICTURE: &Palette = &DARK;

impl Palette {
    /// The colours of a theme.
    pub const fn from_theme(theme: Theme) -> &'static Self {
        match theme {
            Theme::Dark => &DARK,
            Theme::Light => &LIGHT,
        }
    }

    /// The colour of a status. Show the status's letter with it.
    pub const fn status(&self, status: FrameStatus) -> Color32 {
        match status {
            FrameStatus::New => self.new,
            FrameStatus::Draft => self.draft,
            FrameStatus::Suggested => self.caution,
            FrameStatus::Reference => self.good,
            FrameStatus::Rejected => self.rejected,
        }
    }

    /// The colour of a verdict. Show the verdict's word with it.
    pub const fn verdict(&self, verdict: Verdict) -> Color32 {
        match verdict {
            Verdict::Good => self.good,
            Verdict::Check => self.caution,
            Verdict::Wrong => self.bad,
        }
    }
}

/// What draws, and therefore knows its theme.
pub trait Themed {
    /// The colours of that theme.
    fn palette(&self) -> &'static Palette;
}

impl Themed for Ui {
    fn palette(&self) -> &'static Palette {
        if self.visuals().dark_mode {
            &DARK
        } else {
            &LIGHT
        }
    }
}

impl Themed for Context {
    fn palette(&self) -> &'static Palette {
        Palette::from_theme(self.theme())
    }
}

impl Themed for Painter {
    fn palette(&self) -> &'static Palette {
        self.ctx().palette()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast ratio of WCAG 2.2, from 1 to 21.
    fn contrast(one: Color32, other: Color32) -> f64 {
        let luminance = |colour: Color32| {
            let linear = |value: u8| {
                let value = f64::from(value) / 255.0;
                if value <= 0.04045 {
                    value / 12.92
                } else {
                    ((value + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
        };
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn text_is_readable_on_every_ground_that_it_stands_on() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        for (name, theme) in [("dark", DARK), ("light", LIGHT)] {
            let grounds = [theme.backdrop, theme.panel, theme.raised, theme.window];
            let controls = [theme.control, theme.hovered, theme.accent_ground];
            let mut pairs = Vec::new();
            for text in [theme.text, theme.strong, theme.weak] {
                pairs.extend(
                    grounds
                        .into_iter()
                        .chain(controls)
                        .map(|ground| (text, ground)),
                );
            }
            let statuses = [
                FrameStatus::New,
                FrameStatus::Draft,
                FrameStatus::Suggested,
                FrameStatus::Rejected,
            ];
            let statuses = statuses.map(|status| theme.status(status));
            for text in [theme.accent, theme.good, theme.caution, theme.bad]
                .into_iter()
                .chain(statuses)
            {
                pairs.extend(grounds.map(|ground| (text, ground)));
            }
            pairs.extend(
                [theme.accent, theme.accent_hovered, theme.caution, theme.bad]
                    .map(|ground| (theme.on_accent, ground)),
            );
            for (text, ground) in pairs {
                let found = contrast(text, ground);
                assert!(found >= 4.5, "{name}: {text:?} on {ground:?}: {found:.2}");
            }
        }
    }
}
