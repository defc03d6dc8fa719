//! What a mended frame keeps: the camera that it came with, how far and why it was moved.

use super::given::{GivenCamera, GivenFault};
use crate::calibrate::ground_moved_px;
use touchline_documents::document::{Document, ImportedCamera, SolutionWarning};

/// The code of the warning that a frame's camera is not the one that it came with.
pub const MENDED: &str = "mended";

/// The code of the warning that a frame's camera stands where no other does.
pub const NO_PLACE: &str = "no_place";

/// A camera that moved by at most this much is as it came, px at 1920 px width: what the annotator
/// would not see.
pub(super) const AS_IT_CAME_PX: f64 = 3.0;

/// What was done with the camera of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Move {
    /// Nothing.
    None,
    /// It was put on the place that it shares with others.
    OntoPlace,
    /// It was mirrored back, and put on the place of its neighbours.
    Mirrored,
    /// It was taken away as it is out of line with those of its neighbours.
    OutOfLine { apart_px: f64 },
    /// It was interpolated between its neighbours.
    Interpolated {
        sigma_px: f64,
        /// How far the camera that came was out of line, if that is why it was replaced.
        out_of_line_px: Option<f64>,
    },
    /// It was aligned to its painted lines, or tracked from its neighbours.
    ByPicture,
    /// It fits no place that others share.
    FitsNoPlace,
}

impl Move {
    /// What was done, in words after "its camera".
    fn describe(self) -> Option<String> {
        Some(match self {
            Self::None => return None,
            Self::OntoPlace => "was put on the place that others share".to_owned(),
            Self::Mirrored => "was mirrored back onto the place of its neighbours".to_owned(),
            Self::OutOfLine { apart_px } => {
                format!(
                    "was taken away: it was {} with those of its neighbours",
                    describe_out_of_line(apart_px)
                )
            }
            Self::Interpolated {
                out_of_line_px: Some(apart_px),
                ..
            } => format!(
                "was interpolated between its neighbours: the one that came was {} with theirs",
                describe_out_of_line(apart_px)
            ),
            Self::Interpolated { .. } => "was interpolated between its neighbours".to_owned(),
            Self::ByPicture => "was mended on its picture".to_owned(),
            Self::FitsNoPlace => {
                "stands where no other camera does, or fits that place badly: it is as it came"
                    .to_owned()
            }
        })
    }

    /// The warning for the frame, with the reason and how far its ground was moved, px.
    fn warning(
        self,
        has_camera: bool,
        moved_px: Option<f64>,
        fault: Option<&GivenFault>,
    ) -> Option<SolutionWarning> {
        let action = match fault {
            Some(fault) if !has_camera => format!("was taken away: {fault}"),
            Some(fault) => format!("{}: {fault}", self.describe()?),
            None if self == Self::ByPicture && !has_camera => {
                "was taken away: it does not fit its picture".to_owned()
            }
            None => self.describe()?,
        };
        if self == Self::FitsNoPlace {
            return Some(SolutionWarning::new(
                NO_PLACE,
                format!("Its camera {action}."),
            ));
        }
        let far = moved_px.filter(|moved_px| moved_px.is_finite());
        let far = far.map(|moved_px| format!(", {moved_px:.0} px from the one that came"));
        let message = format!("Its camera {action}{}.", far.unwrap_or_default());
        Some(SolutionWarning::new(MENDED, message))
    }

    /// 1-σ of the camera by the numbers, px at 1920 px width; none where there is no camera of the
    /// program's.
    pub const fn sigma_px(self) -> Option<f64> {
        match self {
            Self::OntoPlace | Self::Mirrored => Some(0.0),
            Self::Interpolated { sigma_px, .. } => Some(sigma_px),
            Self::None | Self::OutOfLine { .. } | Self::ByPicture | Self::FitsNoPlace => None,
        }
    }

    pub const fn is_out_of_line(self) -> bool {
        matches!(
            self,
            Self::OutOfLine { .. }
                | Self::Interpolated {
                    out_of_line_px: Some(_),
                    ..
                }
        )
    }

    /// Why a frame is left for a person, if it is.
    pub fn why_left(self, given: &GivenCamera, has_camera: bool) -> Option<String> {
        match (self, given.fault()) {
            (Self::FitsNoPlace | Self::OutOfLine { .. }, _) => {
                Some(format!("its camera {}", self.describe()?))
            }
            _ if has_camera => None,
            (_, Some(fault)) => Some(format!("its camera is impossible: {fault}")),
            _ => Some("no camera beside it is near enough in time".to_owned()),
        }
    }
}

fn describe_out_of_line(apart_px: f64) -> String {
    if apart_px.is_finite() {
        format!("{apart_px:.0} px out of line")
    } else {
        "out of line".to_owned()
    }
}

/// Keeps with a frame the camera that it came with, and says by how far and why it was moved.
/// Returns the distance of its ground in the picture, px at 1920 px width: the median; none if it
/// has no camera now, or had none. `before` is the document as it came.
pub(super) fn keep_given(
    document: &mut Document,
    before: &Document,
    index: usize,
    fault: Option<&GivenFault>,
    how: Move,
) -> Option<f64> {
    let came = before.ptz_camera(&before.frames[index])?;
    let frame = &document.frames[index];
    let now = document.ptz_camera(frame);
    let scale = frame.image_size.scale_from_1920();
    let moved_px = now.and_then(|now| ground_moved_px(&came, &now, frame.image_size));
    let warning = how.warning(now.is_some(), moved_px, fault).filter(|_| {
        let stayed = moved_px.is_some_and(|moved_px| moved_px <= AS_IT_CAME_PX * scale);
        how == Move::FitsNoPlace || !stayed
    });
    // A camera that was mended before came with the one that is on record.
    let earlier = before.frames[index].solution.as_ref();
    let earlier = earlier.and_then(|known| known.imported.clone());
    let solution = document.frames[index].solution.get_or_insert_default();
    solution.imported =
        earlier.or_else(|| ImportedCamera::new(&came, moved_px, fault.map(ToString::to_string)));
    solution.warnings.extend(warning);
    moved_px.map(|moved_px| moved_px / scale)
}
