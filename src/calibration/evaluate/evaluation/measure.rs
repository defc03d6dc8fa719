//! The numbers by which a frame is judged.

/// One number of a frame. Errors are magnitudes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Measure {
    /// Intersection over union of the part of the field that the picture shows.
    IouPart,
    /// Intersection over union of the whole field.
    IouWhole,
    /// The angle between the rotations.
    Rotation,
    /// Pan of the optical axis.
    Pan,
    /// Tilt of the optical axis.
    Tilt,
    /// Focal length, px.
    Focal,
    /// Focal length, per cent.
    FocalPercent,
    /// The distance of the centres of projection.
    Position,
    /// The mean distance of the landmarks in the picture from where the estimate puts them.
    Landmarks,
    /// The largest of these.
    WorstLandmark,
    /// The mean distance on the ground.
    LandmarksOnGround,
    /// The median distance of the clicks that the estimate was made from.
    Clicks,
    /// The median distance of the clicks that it was not made from.
    HeldOutClicks,
    /// The same on the ground.
    HeldOutOnGround,
    /// The share of markings within 5 px at 960 px width.
    Jaccard5,
    /// Within 10 px.
    Jaccard10,
    /// Within 20 px.
    Jaccard20,
    /// The error of pan, tilt and focal length in the estimate's own sigmas, a root mean square.
    Sigmas,
}

impl Measure {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 18] = [
        Self::IouPart,
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

    /// Its key in files; the unit is in it.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::IouPart => "iou_part",
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

    /// What a person reads, with the unit.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::IouPart => "IoU_part",
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

    /// Shares of which more is better; everything else is an error.
    #[must_use]
    pub const fn more_is_better(self) -> bool {
        matches!(
            self,
            Self::IouPart | Self::IouWhole | Self::Jaccard5 | Self::Jaccard10 | Self::Jaccard20
        )
    }
}
