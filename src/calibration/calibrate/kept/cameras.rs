//! Cameras, fields and their evidence as bytes.

use super::{Kept, kept};
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence};
use touchline_core::camera::{
    BaseCorrelation, BaseSigma, CameraBase, FocalCurve, PanTilt, Ptz, SizeError,
};
use touchline_core::field::{
    Curve, FieldLine, FieldModel, Landmark, LandmarkId, LineId, PaintEdge,
};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, PixelBox};
use touchline_core::solve::Uncertainty;
use touchline_core::solve::base::{FittedSize, PixelAspect};
use touchline_documents::document::CameraId;
use touchline_vision::paint::{LineCheck, Snapped};

kept! {
    ImagePoint { x, y }
    ImageSize { width, height }
    PixelBox { x, y, width, height }
    PanTilt { pan, tilt }
    Ptz { pan, tilt, focal_px }
    FocalCurve { at_focal_px, value, per_1000_px, k2_per_k1_squared, pixel_aspect }
    BaseSigma {
        position_m, rotation, k1, k1_per_1000_px, crown_m, crown_width_m, principal_point_px,
        correlation, size,
    }
    CameraBase { position_m, base_from_world, principal_point, distortion, sigma }
    Uncertainty { clicks, by_base, base_root }
    SizeError { sigma_m, still_m, end_m, base_by_m }
    FittedSize { name, assumed_m, value_m, error, is_open }
    PixelAspect { value, sigma, stated, image_size }
    LineCheck {
        predicted, found, bare, offset_px, bias_px, halves_px, unexplained, emptiest, agreement,
        score,
    }
    Snapped { ptz, own_lens, samples, rms_px, halves_px, uncertainty, check }
    Landmark {
        id, label, code, nominal_m, click_sigma_px, place_sigma_px, spot_diameter_m, is_unmarked,
    }
    FieldLine { id, label, code, curve, width_m, edge, paint_centre, painted, dash_m }
    FieldModel {
        template, params, length_m, width_m, crown_m, landmarks, lines, line_click_sigma_px,
    }
    AutocalibratedFrame { index, ptz, uncertainty, snapped, unaligned_score }
    AutocalibrationEvidence {
        frames, nats, explained, visible, runner_up_nats, lines, missing, residual_px, parts_m,
        other_size_m, pixel_aspect,
    }
    AutocalibratedCamera { base, field, sizes, frames, others, paint, evidence }
}

impl Kept for Angle {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.radians().write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        f64::read(bytes).map(Self::from_radians)
    }
}

impl Kept for BaseCorrelation {
    fn write(&self, bytes: &mut Vec<u8>) {
        self.below_diagonal().to_vec().write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        Self::from_below_diagonal(&Vec::read(bytes)?)
    }
}

/// Keeps a name as its text.
macro_rules! kept_name {
    ($($type:ty),+) => {$(
        impl Kept for $type {
            fn write(&self, bytes: &mut Vec<u8>) {
                self.as_str().to_owned().write(bytes);
            }

            fn read(bytes: &mut &[u8]) -> Option<Self> {
                String::read(bytes).map(|name| Self::from(name.as_str()))
            }
        }
    )+};
}

kept_name!(CameraId, LandmarkId, LineId);

impl Kept for PaintEdge {
    fn write(&self, bytes: &mut Vec<u8>) {
        let number: u8 = match self {
            Self::Centre => 0,
            Self::Outer => 1,
            Self::Inner => 2,
        };
        number.write(bytes);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        match u8::read(bytes)? {
            0 => Some(Self::Centre),
            1 => Some(Self::Outer),
            2 => Some(Self::Inner),
            _ => None,
        }
    }
}

impl Kept for Curve {
    fn write(&self, bytes: &mut Vec<u8>) {
        match *self {
            Self::Segment { from, to } => {
                false.write(bytes);
                (from, to).write(bytes);
            }
            Self::Arc {
                centre,
                radius_m,
                start,
                sweep,
            } => {
                true.write(bytes);
                (centre, (radius_m, (start, sweep))).write(bytes);
            }
        }
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        if !bool::read(bytes)? {
            let (from, to) = Kept::read(bytes)?;
            return Some(Self::Segment { from, to });
        }
        let (centre, (radius_m, (start, sweep))) = Kept::read(bytes)?;
        Some(Self::Arc {
            centre,
            radius_m,
            start,
            sweep,
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::calibrate::kept::{from_bytes, to_bytes};
    use touchline_core::field::FieldModel;
    use touchline_core::testing::soccer;

    #[test]
    fn a_field_comes_back() {
        let field = soccer().with_crown_m(0.21);
        let read: FieldModel = from_bytes(&to_bytes(&field)).unwrap();
        assert_eq!(read, field);
    }
}
