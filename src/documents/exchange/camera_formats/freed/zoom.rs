//! The raw number of a zoom and the focal length that it stands for.

use crate::exchange::error::Problem;
use crate::exchange::options::Zoom;
use touchline_core::geometry::ImageSize;

/// The largest unsigned number of 24 bits.
const MAX_U24: f64 = 16_777_215.0;

impl Zoom {
    /// The raw value nearest to a focal length.
    pub(super) fn raw(
        &self,
        focal_px: f64,
        size: ImageSize,
        sensor_mm: Option<f64>,
    ) -> Result<f64, String> {
        let raw = match self {
            Self::FocalPx => focal_px,
            Self::FocalMmX100 => {
                let sensor =
                    sensor_mm.ok_or("the sensor's width is not known; give --sensor-mm")?;
                100.0 * focal_px * sensor / f64::from(size.width)
            }
            Self::Table(table) => {
                // The table the other way round.
                between(table.iter().map(|(raw, focal)| (*focal, *raw)), focal_px).ok_or_else(
                    || format!("the focal length {focal_px} px is not within the zoom table"),
                )?
            }
        };
        // A packet has whole numbers of 24 bits without a sign.
        let raw = raw.round();
        if (0.0..=MAX_U24).contains(&raw) {
            Ok(raw)
        } else {
            Err(format!("the zoom value {raw} needs more than 24 bits"))
        }
    }

    /// The focal length of a raw value, px.
    pub(super) fn focal_px(
        &self,
        raw: f64,
        size: ImageSize,
        sensor_mm: Option<f64>,
    ) -> Result<f64, Problem> {
        match self {
            Self::FocalPx => Ok(raw),
            Self::FocalMmX100 => {
                let sensor = sensor_mm.ok_or_else(|| {
                    Problem::Missing("the sensor's width (--sensor-mm)".to_owned())
                })?;
                Ok(raw / 100.0 * f64::from(size.width) / sensor)
            }
            Self::Table(table) => between(table.iter().copied(), raw).ok_or_else(|| {
                let what = "the zoom value".to_owned();
                Problem::out_of_range(what, raw, "within the zoom table")
            }),
        }
    }
}

/// Linear interpolation between the rows of a table, whose first column may be ascending or
/// descending. None outside the table.
fn between(table: impl Iterator<Item = (f64, f64)>, at: f64) -> Option<f64> {
    let mut rows: Vec<(f64, f64)> = table.collect();
    // Either column may fall along the table, so that the rows are put in order for the column that
    // is searched.
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pair = rows
        .windows(2)
        .find(|pair| pair[0].0 <= at && at <= pair[1].0)?;
    // Two rows of one value divide by zero; then the first of them counts.
    let share = (at - pair[0].0) / (pair[1].0 - pair[0].0);
    Some(if share.is_finite() {
        pair[0].1 + share * (pair[1].1 - pair[0].1)
    } else {
        pair[0].1
    })
}
