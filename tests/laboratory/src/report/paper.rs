//! Numbers from the paper: Chen, Zhu, Little, "A Two-point Method for PTZ Camera Calibration in
//! Sports", WACV 2018.

/// A mean and the standard deviation over frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    pub mean: f64,
    pub sd: f64,
}

const fn mean_and_sd(mean: f64, sd: f64) -> Stated {
    Stated { mean, sd }
}

impl Stated {
    /// As in the paper: `.83 ± .16`.
    pub fn describe(self) -> String {
        // The paper writes no 0 before the point.
        let short = |value: f64| format!("{value:.2}").trim_start_matches('0').to_owned();
        format!("{} ± {}", short(self.mean), short(self.sd))
    }
}

/// A sequence of table 2: the ranges of its camera, and the `IoU` of `CalibMe` and of the paper's
/// method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequence {
    pub pan_deg: [f64; 2],
    pub tilt_deg: [f64; 2],
    /// In pictures of 1280 × 720 px.
    pub focal_px: [f64; 2],
    pub calib_me: Stated,
    pub theirs: Stated,
}

/// Table 2: the highlights, from one camera position behind the corner, in two games.
pub const TABLE_2: [Sequence; 4] = [
    Sequence {
        pan_deg: [49.0, 68.0],
        tilt_deg: [-13.0, -9.0],
        focal_px: [1586.0, 4346.0],
        calib_me: mean_and_sd(0.75, 0.22),
        theirs: mean_and_sd(0.88, 0.06),
    },
    Sequence {
        pan_deg: [49.0, 68.0],
        tilt_deg: [-11.0, -8.0],
        focal_px: [3330.0, 4947.0],
        calib_me: mean_and_sd(0.73, 0.27),
        theirs: mean_and_sd(0.81, 0.21),
    },
    Sequence {
        pan_deg: [17.0, 67.0],
        tilt_deg: [-9.0, -5.0],
        focal_px: [1938.0, 4225.0],
        calib_me: mean_and_sd(0.61, 0.37),
        theirs: mean_and_sd(0.69, 0.36),
    },
    Sequence {
        pan_deg: [54.0, 69.0],
        tilt_deg: [-8.0, -7.0],
        focal_px: [2642.0, 4074.0],
        calib_me: mean_and_sd(0.62, 0.33),
        theirs: mean_and_sd(0.94, 0.04),
    },
];
/// The last rows of table 2 for `CalibMe` and the paper's method: the average, and the time of a
/// frame, seconds.
pub const TABLE_2_AVERAGE: [Stated; 2] = [mean_and_sd(0.68, 0.30), mean_and_sd(0.83, 0.16)];
pub const TABLE_2_SECONDS: [f64; 2] = [3.0, 0.3];
/// Number of frames of a sequence.
pub const SEQUENCE_FRAMES: usize = 29;

/// Table 3: the games of the World Cup, their numbers of frames, and the `IoU` of `CalibMe` and of
/// the paper's method.
pub const TABLE_3: [(&str, usize, [Stated; 2]); 2] = [
    (
        "BRA–MEX",
        42,
        [mean_and_sd(0.84, 0.24), mean_and_sd(0.99, 0.01)],
    ),
    (
        "BRA–NED",
        33,
        [mean_and_sd(0.69, 0.37), mean_and_sd(0.98, 0.01)],
    ),
];

/// Table 4, without and with the threshold on distances of descriptors: the share of rays within
/// 0.5°, and the mean `IoU`.
pub const TABLE_4: [[f64; 2]; 2] = [[0.09, 0.53], [0.33, 0.83]];
/// Maximum angle of an inlier's ray from the true one in table 4, degrees.
pub const INLIER_DEG: f64 = 0.5;

/// Mean `IoU` with SIFT and with SURF.
pub const SIFT_SURF: [f64; 2] = [0.83, 0.74];
/// "More than about 85 %" of the frames have a rotation error below 1°: degrees and share.
pub const ROTATION: (f64, f64) = (1.0, 0.85);
/// A frame is a failure if its `IoU` is below this. By the paper, failures have a field of view
/// below about the second number, and none has one above the third, degrees.
pub const FAILURE_IOU: f64 = 0.6;
pub const FAILURES_BELOW_DEG: f64 = 25.0;
pub const NO_FAILURE_ABOVE_DEG: f64 = 40.0;
/// More trees than this improve nothing, by the paper.
pub const ENOUGH_TREES: usize = 5;
/// Figure (b): noise (px), and the limits of the errors of angles (degrees) and focal length (px)
/// at that noise.
pub const FIGURE_B: (f64, f64, f64) = (3.0, 0.02, 2.5);
