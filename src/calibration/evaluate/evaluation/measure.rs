//! The measures of a frame.

/// A measure of a frame. Errors are absolute values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Measure {
    /// Intersection over union of the part of the field that the picture shows.
    IouPart,
    /// Mean intersection over union of the field's segments that the picture shows.
    IouSegments,
    /// Intersection over union of the whole field.
    IouWhole,
    /// The angle between the rotations.
    Rotation,
    /// Error of the optical axis's pan.
    Pan,
    /// Error of the optical axis's tilt.
    Tilt,
    /// Error of the focal length, px.
    Focal,
    /// Error of the focal length, per cent.
    FocalPercent,
    /// Distance of the centres of projection.
    Position,
    /// Mean distance of the landmarks in the picture from their estimated projections.
    Landmarks,
    /// Largest of these distances.
    WorstLandmark,
    /// Mean distance of the landmarks on the ground.
    LandmarksOnGround,
    /// Median distance of the clicks from which the estimate was made.
    Clicks,
    /// Median distance of the clicks from which it was not made.
    HeldOutClicks,
    /// Median distance of these on the ground.
    HeldOutOnGround,
    /// Share of markings within 5 px at 960 px width.
    Jaccard5,
    /// Share of markings within 10 px.
    Jaccard10,
    /// Share of markings within 20 px.
    Jaccard20,
    /// Root mean square error of pan, tilt and focal length in units of the estimate's own sigmas.
    Sigmas,
}

/// Every measure with its key in files and its label for readers, both with the unit, in the order
/// of tables and of the type.
const MEASURES: [(Measure, &str, &str); 19] = [
    (Measure::IouPart, "iou_part", "IoU_part"),
    (Measure::IouSegments, "iou_segments", "IoU_segments"),
    (Measure::IouWhole, "iou_whole", "IoU_whole"),
    (Measure::Rotation, "rotation_deg", "rotation error (°)"),
    (Measure::Pan, "pan_deg", "pan error (°)"),
    (Measure::Tilt, "tilt_deg", "tilt error (°)"),
    (Measure::Focal, "focal_px", "focal error (px)"),
    (Measure::FocalPercent, "focal_percent", "focal error (%)"),
    (Measure::Position, "position_m", "position error (m)"),
    (Measure::Landmarks, "landmarks_px", "landmarks, mean (px)"),
    (
        Measure::WorstLandmark,
        "worst_landmark_px",
        "landmarks, worst (px)",
    ),
    (
        Measure::LandmarksOnGround,
        "landmarks_m",
        "landmarks, mean (m)",
    ),
    (Measure::Clicks, "clicks_px", "clicks used (px)"),
    (
        Measure::HeldOutClicks,
        "held_out_px",
        "clicks held out (px)",
    ),
    (
        Measure::HeldOutOnGround,
        "held_out_m",
        "clicks held out (m)",
    ),
    (Measure::Jaccard5, "jac_5", "JaC@5"),
    (Measure::Jaccard10, "jac_10", "JaC@10"),
    (Measure::Jaccard20, "jac_20", "JaC@20"),
    (Measure::Sigmas, "error_over_sigma", "error in stated σ"),
];

impl Measure {
    /// All measures, in the order of tables.
    pub const ALL: [Self; 19] = {
        let mut all = [Self::IouPart; 19];
        let mut at = 0;
        while at < all.len() {
            all[at] = MEASURES[at].0;
            at += 1;
        }
        all
    };

    /// Its key in files, including the unit.
    pub const fn key(self) -> &'static str {
        MEASURES[self as usize].1
    }

    /// Its label for readers, including the unit.
    pub const fn label(self) -> &'static str {
        MEASURES[self as usize].2
    }

    /// Whether larger values are better; false for errors.
    pub const fn more_is_better(self) -> bool {
        matches!(
            self,
            Self::IouPart
                | Self::IouSegments
                | Self::IouWhole
                | Self::Jaccard5
                | Self::Jaccard10
                | Self::Jaccard20
        )
    }
}
