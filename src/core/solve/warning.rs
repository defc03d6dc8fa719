//! Warnings about a solved frame, for the user.

use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A warning. Its message states the problem, the number and the remedy, in this order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Its kind.
    pub code: WarningCode,
    /// What a person reads.
    pub message: String,
    /// The clicks it is about, from 0; empty if it is about the frame.
    pub clicks: Vec<usize>,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

macro_rules! warning_codes {
    ($($(#[$doc:meta])* $variant:ident = $name:literal,)*) => {
        /// The kinds of warning, as documents write them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum WarningCode {
            $($(#[$doc])* $variant,)*
        }

        impl WarningCode {
            /// Every kind.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// The name in documents.
            pub const fn as_str(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }
    };
}

impl Serialize for WarningCode {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

warning_codes! {
    /// The points lie close together, so that far corners are uncertain.
    Separation = "separation",
    /// The base contributes more to the uncertainty than the points.
    BaseUncertain = "base_uncertain",
    /// A corner far from all points is uncertain.
    Extrapolation = "extrapolation",
    /// Two landmarks fit better with their names exchanged.
    Swapped = "swapped",
    /// The mirrored end or side fits as well, or better.
    Mirrored = "mirrored",
    /// A click fits a neighbouring line or landmark better.
    WrongLine = "wrong_line",
    /// Two focal lengths fit.
    TwoRoots = "two_roots",
    /// Another camera of the document fits the clicks, the frame's own does not.
    OtherCamera = "other_camera",
    /// Pan, tilt or focal length is outside the usual range of this camera.
    Implausible = "implausible",
    /// The clicks contradict each other or the base by more than their noise.
    Contradiction = "contradiction",
    /// A check click is farther off than the uncertainty explains.
    CheckFailed = "check_failed",
    /// The field's size is assumed, neither confirmed nor fitted.
    FieldAssumed = "field_assumed",
    /// No reference frame shows this part of the field.
    Coverage = "coverage",
    /// A relocalisation rests on few inliers.
    FewInliers = "few_inliers",
}

impl fmt::Display for WarningCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A warning code that this version does not know.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown warning code {0:?}")]
pub struct UnknownWarningCode(pub String);

impl FromStr for WarningCode {
    type Err = UnknownWarningCode;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .iter()
            .copied()
            .find(|code| code.as_str() == name)
            .ok_or_else(|| UnknownWarningCode(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_read_back() {
        for &code in WarningCode::ALL {
            assert_eq!(code.as_str().parse::<WarningCode>().unwrap(), code);
        }
        assert!("nonsense".parse::<WarningCode>().is_err());
    }
}
