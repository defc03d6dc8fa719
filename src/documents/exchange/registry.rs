//! Every format with its reader and writer, and what the rest of the program asks of a format.

use super::authors_mat;
use super::camera_formats::{
    broadtrack, cdf, chan, colmap, csv_table, deepsport, fifa, freed, homography_files, lens_table,
    opencv_yaml, opentrackio, soccernet, usda,
};
use super::cameras::camera_format::CameraFormat;
use super::click_formats::clicked_frame::ClickFormat;
use super::click_formats::{
    coco, cvat, label_studio, labelme, points_table, soccernet_lines, yolo_pose,
};
use super::error::ExchangeError;
use super::format::{About, Format};
use super::format_options::{Direction, FormatOption};
use Codec::{Cameras, Clicks, Documents};
use std::fmt;

/// What reads and writes a format.
#[derive(Clone, Copy)]
pub enum Codec {
    /// Cameras or homographies of frames.
    Cameras(&'static dyn CameraFormat),
    /// Points of pictures.
    Clicks(&'static dyn ClickFormat),
    /// Whole documents, which no other format can hold.
    Documents(About),
}

/// The document itself.
const DATASET: About = About {
    name: "json",
    title: "touchline's own format: everything in one JSON file",
    conventions: "world: origin at the field's centre, x right, y away, z up, m; degrees; pixels from the corner",
    users: "this program, touchline_dataset.py (numpy)",
    loses: Some("nothing"),
    file: Some("dataset.json"),
    files: "dataset (.json)",
    endings: &["json"],
    export_options: &[],
    import_options: &[FormatOption::EachOwnCamera],
};

/// Every format, in the order of the help.
static FORMATS: [(Format, Codec); 28] = [
    (Format::Json, Documents(DATASET)),
    (Format::SoccerNet, Cameras(&soccernet::SoccerNet)),
    (
        Format::SoccerNetLines,
        Clicks(&soccernet_lines::SoccerNetLines),
    ),
    (Format::Csv, Cameras(&csv_table::Csv)),
    (Format::YoloPose, Clicks(&yolo_pose::YoloPose)),
    (Format::Coco, Clicks(&coco::Coco)),
    (Format::Cvat, Clicks(&cvat::Cvat)),
    (Format::LabelStudio, Clicks(&label_studio::LabelStudio)),
    (Format::Labelme, Clicks(&labelme::Labelme)),
    (Format::Points, Clicks(&points_table::PointsTable)),
    (Format::Wc14, Cameras(&homography_files::Wc14)),
    (Format::TsWorldCup, Cameras(&homography_files::TsWorldCup)),
    (
        Format::Homography,
        Cameras(&homography_files::HomographyLines),
    ),
    (
        Format::Homographies,
        Cameras(&homography_files::HomographyTables),
    ),
    (Format::BroadTrack, Cameras(&broadtrack::BroadTrack)),
    (Format::Colmap, Cameras(&colmap::Colmap)),
    (Format::OpenCv, Cameras(&opencv_yaml::OpenCvYaml)),
    (Format::Usda, Cameras(&usda::Usda)),
    (Format::OpenTrackIo, Cameras(&opentrackio::OpenTrackIo)),
    (Format::FreeD, Cameras(&freed::FreeD)),
    (Format::FreeDCsv, Cameras(&freed::FreeDCsv)),
    (Format::DeepSport, Cameras(&deepsport::DeepSport)),
    (Format::Chan, Cameras(&chan::Chan)),
    (Format::Fifa, Cameras(&fifa::Fifa)),
    (Format::Lens, Cameras(&lens_table::LensTable)),
    (Format::Cdf, Cameras(&cdf::Cdf)),
    (Format::PnlCalib, Cameras(&soccernet::PnlCalib)),
    (Format::AuthorsMat, Documents(authors_mat::ABOUT)),
];

/// What reads and writes a format.
pub fn codec(format: Format) -> Codec {
    FORMATS[format as usize].1
}

impl Format {
    /// Every format, in the order of the help.
    pub fn all() -> impl Iterator<Item = Self> {
        FORMATS.iter().map(|(format, _)| *format)
    }

    /// What it is.
    pub fn about(self) -> About {
        match codec(self) {
            Cameras(format) => format.about(),
            Clicks(format) => format.about(),
            Documents(about) => about,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.about().name
    }

    /// The format of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|format| format.name() == name)
    }

    /// Whether it stores points or lines of pictures, not cameras.
    pub fn is_of_points(self) -> bool {
        matches!(codec(self), Clicks(_))
    }

    /// Whether an export makes a folder, not a file.
    pub fn is_folder(self) -> bool {
        self.about().file.is_none()
    }

    /// The options that its export or import takes.
    pub fn options(self, direction: Direction) -> &'static [FormatOption] {
        let about = self.about();
        match direction {
            Direction::Export => about.export_options,
            Direction::Import => about.import_options,
        }
    }

    /// Whether its export or import takes an option.
    pub fn takes(self, option: FormatOption, direction: Direction) -> bool {
        self.options(direction).contains(&option)
    }

    /// Refuses options that its export or import does not take.
    ///
    /// # Errors
    /// One of them is such an option; the formats that take it are named.
    pub fn refuse_options(
        self,
        given: impl IntoIterator<Item = FormatOption>,
        direction: Direction,
    ) -> Result<(), ExchangeError> {
        let is_taken = |option| self.takes(option, direction);
        refuse_not_taken(given, is_taken, self.name(), direction)
    }

    /// The field that its files usually show.
    pub const fn usual_field(self) -> &'static str {
        match self {
            Self::DeepSport => "basketball_fiba",
            _ => "soccer",
        }
    }

    /// Whether it can be imported.
    pub fn imports(self) -> bool {
        !self.about().endings.is_empty()
    }

    /// Whether it can be exported.
    pub fn exports(self) -> bool {
        self.about().loses.is_some()
    }

    /// Whether an export is read back, and every landmark or click compared, before it is written.
    /// A sheet without cameras is not verified; a document is compared as text.
    pub fn is_proved(self) -> bool {
        self.exports() && !matches!(self, Self::Cdf | Self::Json)
    }
}

/// Refuses the first of some options that is not taken; `what` does not take it.
///
/// # Errors
/// There is one; the formats that take it are named.
pub(super) fn refuse_not_taken(
    given: impl IntoIterator<Item = FormatOption>,
    is_taken: impl Fn(FormatOption) -> bool,
    what: &str,
    direction: Direction,
) -> Result<(), ExchangeError> {
    match given.into_iter().find(|option| !is_taken(*option)) {
        None => Ok(()),
        Some(option) => Err(ExchangeError::OptionNotTaken {
            what: what.to_owned(),
            option: option.name(),
            takers: option.takers(direction),
        }),
    }
}

impl FormatOption {
    /// The formats that take it, in the order of the help.
    pub fn takers(self, direction: Direction) -> Vec<Format> {
        Format::all()
            .filter(|format| format.takes(self, direction))
            .collect()
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::{Direction, FORMATS, Format, FormatOption};

    #[test]
    fn every_format_has_a_name_of_its_own_and_goes_one_way_at_least() {
        for (place, (format, _)) in FORMATS.iter().enumerate() {
            assert_eq!(*format as usize, place, "{format}");
            assert_eq!(Format::from_name(format.name()), Some(*format));
            assert!(format.imports() || format.exports(), "{format}");
        }
    }

    /// Formats in words: those that are named, or those that are not.
    fn say(takers: &[Format], all: &[Format]) -> String {
        let names = |formats: &[Format]| {
            let names: Vec<&str> = formats.iter().map(|format| format.name()).collect();
            names.join(", ")
        };
        let others: Vec<Format> = all
            .iter()
            .copied()
            .filter(|format| !takers.contains(format))
            .collect();
        match (takers, &others[..]) {
            ([], _) => "–".to_owned(),
            (_, []) => "all".to_owned(),
            _ if takers.len() > others.len() => format!("all but {}", names(&others)),
            _ => names(takers),
        }
    }

    #[test]
    fn the_options_of_formats_are_on_their_page() {
        let exported: Vec<Format> = Format::all().filter(|format| format.exports()).collect();
        let imported: Vec<Format> = Format::all().filter(|format| format.imports()).collect();
        for option in FormatOption::all() {
            let row = format!(
                "| `--{}` | {} | {} |",
                option.name(),
                say(&option.takers(Direction::Export), &exported),
                say(&option.takers(Direction::Import), &imported)
            );
            assert!(touchline_assets::FORMATS.contains(&row), "{row}");
        }
    }

    #[test]
    fn every_format_has_its_page() {
        let pages = touchline_assets::FORMATS;
        for format in Format::all() {
            let page = pages
                .split("\n## ")
                .find(|page| page.lines().next() == Some(format.name()));
            let page = page.unwrap_or_else(|| panic!("assets/formats.md has no section {format}"));
            for part in ["**Conventions**", "**Used", "**Lost**"] {
                assert!(page.contains(part), "{format}: {part}");
            }
        }
        assert_eq!(pages.matches("\n## ").count(), FORMATS.len());
    }
}
