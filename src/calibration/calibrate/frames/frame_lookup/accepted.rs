//! Where a camera usually looks: the ranges of its accepted frames, one of them left out.

use super::sorted::Sorted;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, Directions};
use touchline_core::solve::PtzRanges;

/// Minimum number of accepted frames for a prior on where a camera looks.
pub(super) const MIN_ACCEPTED: usize = 5;

/// The values of a camera's accepted frames.
#[derive(Clone, Debug, Default)]
pub(super) struct Accepted {
    pans: Directions,
    /// Tilts, rad.
    tilts: Sorted,
    /// Focal lengths, px.
    focals: Sorted,
}

impl Accepted {
    pub(super) fn from_ptz(all: &[Ptz]) -> Self {
        Self {
            pans: all.iter().map(|ptz| ptz.pan).collect(),
            tilts: all.iter().map(|ptz| ptz.tilt.radians()).collect(),
            focals: all.iter().map(|ptz| ptz.focal_px).collect(),
        }
    }

    pub(super) fn change(&mut self, removed: Option<Ptz>, added: Option<Ptz>) {
        self.pans
            .change(added.map(|ptz| ptz.pan), removed.map(|ptz| ptz.pan));
        if let Some(ptz) = removed {
            self.tilts.remove(ptz.tilt.radians());
            self.focals.remove(ptz.focal_px);
        }
        if let Some(ptz) = added {
            self.tilts.insert(ptz.tilt.radians());
            self.focals.insert(ptz.focal_px);
        }
    }

    /// The ranges of all values but those of `left_out`; none with fewer than [`MIN_ACCEPTED`] of
    /// them. Pans are cyclic: their range is the smallest arc that contains all.
    pub(super) fn without(&self, left_out: Option<Ptz>) -> Option<PtzRanges> {
        // `left_out` is one of the values, so the difference is not negative.
        if self.pans.len() - usize::from(left_out.is_some()) < MIN_ACCEPTED {
            return None;
        }
        let pan = match left_out {
            Some(ptz) => AngleRange::smallest_without(&self.pans, ptz.pan),
            None => AngleRange::smallest_of(&self.pans),
        }?;
        // Tilts and focal lengths are no cyclic quantities: their ends are those of the sorted
        // lists.
        let [lowest, highest] = self
            .tilts
            .ends_without(left_out.map(|ptz| ptz.tilt.radians()))?;
        let [shortest, longest] = self.focals.ends_without(left_out.map(|ptz| ptz.focal_px))?;
        let tilt = Angle::from_radians(lowest)..=Angle::from_radians(highest);
        Some(PtzRanges {
            pan,
            tilt,
            focal_px: shortest..=longest,
        })
    }
}
