//! The foreign formats by name.

use std::fmt;

/// A format of an import or export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Format {
    /// This program's own: one JSON file.
    Json,
    /// Camera files of the SoccerNet challenges.
    SoccerNet,
    /// Line annotations of the SoccerNet challenges.
    SoccerNetLines,
    /// A table with one row per frame.
    Csv,
    /// Keypoints for Ultralytics' pose models.
    YoloPose,
    /// COCO keypoints.
    Coco,
    /// CVAT's XML 1.1.
    Cvat,
    /// Label Studio's JSON.
    LabelStudio,
    /// labelme's JSON, one file per image.
    Labelme,
    /// Homographies of the World Cup 2014 set.
    Wc14,
    /// Homographies of the TS-WorldCup set.
    TsWorldCup,
    /// Homographies as JSON lines that state their direction and units.
    Homography,
    /// `BroadTrack`'s JSON.
    BroadTrack,
    /// COLMAP's text files.
    Colmap,
    /// OpenCV's YAML, one file per frame.
    OpenCv,
    /// A USD stage as text.
    Usda,
    /// `OpenTrackIO` samples, one per line.
    OpenTrackIo,
    /// `FreeD` packets.
    FreeD,
    /// The contents of `FreeD` packets, as a table.
    FreeDCsv,
    /// `DeepSport`'s basketball cameras.
    DeepSport,
    /// Nuke's camera track.
    Chan,
    /// Arrays of the FIFA Skeletal Tracking tasks.
    Fifa,
    /// The Common Data Format's sheet of a video.
    Cdf,
    /// Cameras of `PnLCalib`, No Bells Just Whistles and `TVCalib`.
    PnlCalib,
    /// The MATLAB files of the two-point method's authors.
    AuthorsMat,
}

impl Format {
    /// Every format, in the order of the help.
    pub const ALL: [Self; 25] = [
        Self::Json,
        Self::SoccerNet,
        Self::SoccerNetLines,
        Self::Csv,
        Self::YoloPose,
        Self::Coco,
        Self::Cvat,
        Self::LabelStudio,
        Self::Labelme,
        Self::Wc14,
        Self::TsWorldCup,
        Self::Homography,
        Self::BroadTrack,
        Self::Colmap,
        Self::OpenCv,
        Self::Usda,
        Self::OpenTrackIo,
        Self::FreeD,
        Self::FreeDCsv,
        Self::DeepSport,
        Self::Chan,
        Self::Fifa,
        Self::Cdf,
        Self::PnlCalib,
        Self::AuthorsMat,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::SoccerNet => "soccernet",
            Self::SoccerNetLines => "soccernet-lines",
            Self::Csv => "csv",
            Self::YoloPose => "yolo-pose",
            Self::Coco => "coco",
            Self::Cvat => "cvat",
            Self::LabelStudio => "label-studio",
            Self::Labelme => "labelme",
            Self::Wc14 => "wc14",
            Self::TsWorldCup => "tsworldcup",
            Self::Homography => "homography",
            Self::BroadTrack => "broadtrack",
            Self::Colmap => "colmap",
            Self::OpenCv => "opencv",
            Self::Usda => "usda",
            Self::OpenTrackIo => "opentrackio",
            Self::FreeD => "freed",
            Self::FreeDCsv => "freed-csv",
            Self::DeepSport => "deepsport",
            Self::Chan => "chan",
            Self::Fifa => "fifa",
            Self::Cdf => "cdf",
            Self::PnlCalib => "pnlcalib",
            Self::AuthorsMat => "authors-mat",
        }
    }

    /// Its description in one line.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Json => "a dataset: one file of the document's own schema",
            Self::SoccerNet => "SoccerNet camera files, one per frame",
            Self::SoccerNetLines => "SoccerNet line annotations, one file per frame",
            Self::Csv => "a table, one row per frame, with R, t and H",
            Self::YoloPose => "keypoints for Ultralytics' pose models",
            Self::Coco => "COCO keypoints",
            Self::Cvat => "CVAT for images, XML 1.1",
            Self::LabelStudio => "Label Studio keypoints",
            Self::Labelme => "labelme, one file per image",
            Self::Wc14 => "World Cup 2014 homographies, one file per frame",
            Self::TsWorldCup => "TS-WorldCup homographies, one .npy per frame",
            Self::Homography => "homographies that state their direction",
            Self::BroadTrack => "BroadTrack cameras, one JSON file",
            Self::Colmap => "COLMAP text: cameras, images, points3D",
            Self::OpenCv => "OpenCV FileStorage YAML, one file per frame",
            Self::Usda => "a USD stage with an animated camera",
            Self::OpenTrackIo => "OpenTrackIO 1.0.1, one sample per line",
            Self::FreeD => "FreeD D1 packets, back to back",
            Self::FreeDCsv => "FreeD data as a table, with times",
            Self::DeepSport => "DeepSport basketball cameras",
            Self::Chan => "a Nuke camera track",
            Self::Fifa => "FIFA Skeletal Tracking cameras, one .npz per video",
            Self::Cdf => "Common Data Format: the sheet of a video",
            Self::PnlCalib => "cameras of PnLCalib, NBJW or TVCalib",
            Self::AuthorsMat => "the two-point method's MATLAB files",
        }
    }

    /// What an export loses, in a few words.
    #[must_use]
    pub const fn loses(self) -> &'static str {
        match self {
            Self::Json => "nothing",
            Self::SoccerNet => "size of the picture, time, uncertainty",
            Self::SoccerNetLines => "landmarks, cameras; corner arcs have no class",
            Self::Csv => "clicks",
            Self::YoloPose => "points on lines, points outside of the picture, cameras",
            Self::Coco => "points on lines, cameras",
            Self::LabelStudio | Self::Labelme => "check points, cameras",
            Self::Wc14 | Self::TsWorldCup | Self::Homography => {
                "lens, points off the ground, time, uncertainty"
            }
            Self::BroadTrack => "an off-centre principal point, time, uncertainty",
            Self::Colmap | Self::OpenCv => "time, uncertainty",
            Self::Usda => "lens, size of the picture, uncertainty",
            Self::OpenTrackIo => "uncertainty",
            Self::FreeD => {
                "lens, principal point, size, time; steps of 1/32768° and 1/64 mm, whole zoom values"
            }
            Self::FreeDCsv => "lens, principal point, size; whole zoom values",
            Self::Chan => "lens, principal point, size, rate, uncertainty",
            Self::Fifa => "size of the picture, numbers and times of frames, uncertainty",
            Self::Cdf => {
                "everything but the camera's position, the picture size and the frame rate"
            }
            Self::Cvat | Self::DeepSport | Self::PnlCalib | Self::AuthorsMat => "it is read only",
        }
    }

    /// The format of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }

    /// Whether it stores points or lines of pictures, not cameras.
    #[must_use]
    pub const fn is_of_points(self) -> bool {
        matches!(
            self,
            Self::SoccerNetLines
                | Self::YoloPose
                | Self::Coco
                | Self::Cvat
                | Self::LabelStudio
                | Self::Labelme
        )
    }

    /// Whether an export makes a folder, not a file.
    #[must_use]
    pub const fn is_folder(self) -> bool {
        matches!(
            self,
            Self::SoccerNet
                | Self::SoccerNetLines
                | Self::YoloPose
                | Self::Labelme
                | Self::Wc14
                | Self::TsWorldCup
                | Self::Colmap
                | Self::OpenCv
                | Self::DeepSport
                | Self::PnlCalib
                | Self::AuthorsMat
        )
    }

    /// Whether it can be imported.
    #[must_use]
    pub const fn imports(self) -> bool {
        !matches!(self, Self::Usda | Self::Cdf)
    }

    /// Whether an export is read back, and every landmark or click compared, before it is written.
    /// A sheet without cameras is not verified; a document is compared as text.
    #[must_use]
    pub const fn is_proved(self) -> bool {
        self.exports() && !matches!(self, Self::Cdf | Self::Json)
    }

    /// Whether it can be exported.
    #[must_use]
    pub const fn exports(self) -> bool {
        !matches!(
            self,
            Self::Cvat | Self::DeepSport | Self::PnlCalib | Self::AuthorsMat
        )
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::Format;

    #[test]
    fn every_format_has_a_name_of_its_own_and_goes_one_way_at_least() {
        for format in Format::ALL {
            assert_eq!(Format::from_name(format.name()), Some(format));
            assert!(format.imports() || format.exports(), "{format}");
            assert!(
                !format.exports() || format.loses() != "it is read only",
                "{format}"
            );
        }
    }

    #[test]
    fn every_format_has_its_page() {
        let pages = touchline_assets::FORMATS;
        for format in Format::ALL {
            let page = pages
                .split("\n## ")
                .find(|page| page.lines().next() == Some(format.name()));
            let page = page.unwrap_or_else(|| panic!("assets/formats.md has no section {format}"));
            for part in ["**Conventions**", "**Used", "**Lost**"] {
                assert!(page.contains(part), "{format}: {part}");
            }
        }
        assert_eq!(pages.matches("\n## ").count(), Format::ALL.len());
    }
}
