//! Evidence of painted lines as bytes.

use super::kept;
use crate::calibrate::{BasePaintEvidence, LengthOnLines, OnPaintErrors};
use touchline_core::solve::base::HeldOutErrors;

kept! {
    HeldOutErrors { median_px, p90_px, count }
    OnPaintErrors { paint, clicks }
    BasePaintEvidence { frames, places, lines, before, after }
    LengthOnLines { size, shifts, frames, is_prescribed }
}
