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

impl Measure {
    /// All measures, in the order of tables.
    pub const ALL: [Self; 19] = [
        Self::IouPart,
        Self::IouSegments,
        Self::IouWhole,
        Self::Rotation,
        Self::Pan,
        Self::Tilt,
        Self::Focal,
        Self::FocalPercent,
        Self::Position,
        Self::Landmarks,
        Self::WorstLandmark,
        Self::LandmarksOnGround,
        Self::Clicks,
        Self::HeldOutClicks,
        Self::HeldOutOnGround,
        Self::Jaccard5,
        Self::Jaccard10,
        Self::Jaccard20,
        Self::Sigmas,
    ];

    /// Its key in files, including the unit.
    pub const fn key(self) -> &'static str {
        match self {
            Self::IouPart => "iou_part",
            Self::IouSegments => "iou_segments",
            Self::IouWhole => "iou_whole",
            Self::Rotation => "rotation_deg",
            Self::Pan => "pan_deg",
            Self::Tilt => "tilt_deg",
            Self::Focal => "focal_px",
            Self::FocalPercent => "focal_percent",
            Self::Position => "position_m",
            Self::Landmarks => "landmarks_px",
            Self::WorstLandmark => "worst_landmark_px",
            Self::LandmarksOnGround => "landmarks_m",
            Self::Clicks => "clicks_px",
            Self::HeldOutClicks => "held_out_px",
            Self::HeldOutOnGround => "held_out_m",
            Self::Jaccard5 => "jac_5",
            Self::Jaccard10 => "jac_10",
            Self::Jaccard20 => "jac_20",
            Self::Sigmas => "error_over_sigma",
        }
    }

    /// Its label for readers, including the unit.
    pub const fn label(self) -> &'static str {
        match self {
            Self::IouPart => "IoU_part",
            Self::IouSegments => "IoU_segments",
            Self::IouWhole => "IoU_whole",
            Self::Rotation => "rotation error (°)",
            Self::Pan => "pan error (°)",
            Self::Tilt => "tilt error (°)",
            Self::Focal => "focal error (px)",
            Self::FocalPercent => "focal error (%)",
            Self::Position => "position error (m)",
            Self::Landmarks => "landmarks, mean (px)",
            Self::WorstLandmark => "landmarks, worst (px)",
            Self::LandmarksOnGround => "landmarks, mean (m)",
            Self::Clicks => "clicks used (px)",
            Self::HeldOutClicks => "clicks held out (px)",
            Self::HeldOutOnGround => "clicks held out (m)",
            Self::Jaccard5 => "JaC@5",
            Self::Jaccard10 => "JaC@10",
            Self::Jaccard20 => "JaC@20",
            Self::Sigmas => "error in stated σ",
        }
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
