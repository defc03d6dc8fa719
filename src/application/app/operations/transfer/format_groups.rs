//! The list of formats as people look for them: in four groups, by the name of the program or data
//! set.

use touchline_documents::exchange::Format;

/// What formats are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::EnumIter)]
pub enum FormatGroup {
    /// This program's own file, and tables.
    Own,
    /// Programs for annotating pictures, and what detectors are trained with.
    Annotation,
    /// Film and broadcast: tracked cameras for graphics and effects.
    Production,
    /// Data sets and programs of research.
    Research,
}

impl FormatGroup {
    /// The title above the group.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Own => "Touchline and tables",
            Self::Annotation => "Annotation and training",
            Self::Production => "Film and broadcast",
            Self::Research => "Data sets and research",
        }
    }
}

/// The group of a format, and its name for people.
pub fn group_and_name(format: Format) -> (FormatGroup, &'static str) {
    use FormatGroup as G;
    match format {
        Format::Json => (G::Own, "Touchline document"),
        Format::Csv => (G::Own, "Table of cameras (CSV)"),
        Format::Points => (G::Own, "Table of points (CSV)"),
        Format::Cvat => (G::Annotation, "CVAT"),
        Format::LabelStudio => (G::Annotation, "Label Studio"),
        Format::Labelme => (G::Annotation, "labelme"),
        Format::Coco => (G::Annotation, "COCO keypoints"),
        Format::YoloPose => (G::Annotation, "YOLO pose (Ultralytics)"),
        Format::FreeD => (G::Production, "FreeD packets"),
        Format::FreeDCsv => (G::Production, "FreeD as a table"),
        Format::OpenTrackIo => (G::Production, "OpenTrackIO"),
        Format::Usda => (G::Production, "USD camera"),
        Format::Chan => (G::Production, "Nuke camera (chan)"),
        Format::Lens => (G::Production, "Focal lengths of a recorder (table)"),
        Format::Cdf => (G::Production, "Common Data Format"),
        Format::SoccerNet => (G::Research, "SoccerNet cameras"),
        Format::SoccerNetLines => (G::Research, "SoccerNet lines"),
        Format::PnlCalib => (G::Research, "PnLCalib, NBJW, TVCalib"),
        Format::BroadTrack => (G::Research, "BroadTrack"),
        Format::Wc14 => (G::Research, "World Cup 2014"),
        Format::TsWorldCup => (G::Research, "TS-WorldCup"),
        Format::Homography => (G::Research, "Homographies (JSON lines)"),
        Format::Homographies => (G::Research, "Homographies of other programs (table)"),
        Format::DeepSport => (G::Research, "DeepSport"),
        Format::Fifa => (G::Research, "FIFA Skeletal Tracking"),
        Format::Colmap => (G::Research, "COLMAP"),
        Format::OpenCv => (G::Research, "OpenCV YAML"),
        Format::AuthorsMat => (G::Research, "Two-point method (MATLAB)"),
        other => (G::Research, other.name()),
    }
}

/// The formats of a group that are found by what was typed, for a list of exports or imports
/// (`goes`). What was typed is found in the name, the name on the command line and the description.
pub fn formats_in(group: FormatGroup, typed: &str, goes: fn(Format) -> bool) -> Vec<Format> {
    let typed = typed.trim().to_lowercase();
    let is_found = |format: Format, name: &str| {
        let about = format.about();
        [name, about.name, about.title, about.users]
            .into_iter()
            .any(|text| text.to_lowercase().contains(&typed))
    };
    Format::all()
        .filter(|format| goes(*format))
        .filter(|format| {
            let (of, name) = group_and_name(*format);
            of == group && is_found(*format, name)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::IntoEnumIterator as _;

    #[test]
    fn every_format_is_in_one_group_with_a_name_for_people() {
        let of_group = |group| formats_in(group, "", |_| true);
        let mut listed: Vec<Format> = FormatGroup::iter().flat_map(of_group).collect();
        listed.sort_unstable();
        let mut all: Vec<Format> = Format::all().collect();
        all.sort_unstable();
        assert_eq!(listed, all);
        for format in all {
            let name = group_and_name(format).1;
            assert!(name != format.name() || format == Format::Labelme, "{name}");
        }
    }

    #[test]
    fn a_format_is_found_by_a_word_about_it() {
        let found = |typed| -> Vec<Format> {
            let groups = FormatGroup::iter();
            groups
                .flat_map(|group| formats_in(group, typed, Format::exports))
                .collect()
        };
        assert_eq!(found("nuke"), [Format::Chan]);
        assert!(found("soccernet").contains(&Format::SoccerNetLines));
        assert_eq!(found("no such program"), []);
    }
}
