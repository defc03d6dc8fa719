//! A forest file: one forest per camera, the document they belong to, and the options of feature
//! detection.

use super::forest::{Forest, ForestFileError, Reader, write_forest};
use crate::features::{Detector, FeatureOptions};
use std::ops::RangeInclusive;
use touchline_core::camera::Ptz;
use touchline_core::geometry::{Angle, AngleRange, Mat3};

/// Magic bytes at the start of a forest file.
const MAGIC: &[u8; 8] = b"TLFOREST";

/// The version of files written and read.
pub const FOREST_VERSION: u32 = 5;

/// Bytes of a reference's camera in a file.
const CAMERA_BYTES: usize = 24;

/// Bytes of the covariance of a reference's camera.
const LABEL_BYTES: usize = 48;

/// The content of a forest file: enough to relocalize pictures without the project. It contains no
/// paths.
#[derive(Clone, Debug, PartialEq)]
pub struct ForestModel {
    /// The document's field and cameras as JSON, without frames; opaque text here.
    pub document: String,
    /// Options of feature detection for the references; those of other frames must be the same.
    pub features: FeatureOptions,
    /// A forest for each camera that has references.
    pub cameras: Vec<CameraForest>,
}

/// The forest of one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraForest {
    /// The camera's name in the document.
    pub camera: String,
    /// The views of its references.
    pub seen: SeenRange,
    /// From descriptors to rays in the camera's base.
    pub forest: Forest,
}

/// The views of a camera's references.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenRange {
    /// Pan of the optical axis, degrees: the smallest arc that contains all, from its left end to
    /// its right end; the right end exceeds 180 if the arc crosses ±180° (see [`SeenRange::pan`]).
    pub pan_deg: RangeInclusive<f64>,
    /// Tilt of the optical axis, degrees.
    pub tilt_deg: RangeInclusive<f64>,
    /// Focal length, px of the frame.
    pub focal_px: RangeInclusive<f64>,
    /// Number of references with features.
    pub references: u32,
    /// The camera of each reference: an answer that repeats one is checked again (see
    /// [`super::relocalize()`]).
    pub cameras: Vec<Ptz>,
    /// Covariance of (pan rad, tilt rad, focal px) of each of these cameras, given the base. Where
    /// there is none, four clicks are assumed.
    pub labels: Vec<Mat3>,
    /// Success rate on references left out of the training; empty if it was not measured.
    pub shown: CertainAnswerCounts,
}

impl SeenRange {
    /// The range of some cameras; `None` without any.
    pub fn from_cameras(cameras: &[Ptz]) -> Option<Self> {
        let pan = AngleRange::smallest(cameras.iter().map(|ptz| ptz.pan))?;
        Some(Self {
            pan_deg: pan.start().degrees()..=pan.end().degrees(),
            tilt_deg: range(cameras.iter().map(|ptz| ptz.tilt.degrees()))?,
            focal_px: range(cameras.iter().map(|ptz| ptz.focal_px))?,
            references: cameras.len() as u32,
            cameras: cameras.to_vec(),
            labels: Vec::new(),
            shown: CertainAnswerCounts::default(),
        })
    }

    /// The same with covariances: see [`SeenRange::labels`].
    #[must_use]
    pub fn with_labels(self, labels: Vec<Mat3>) -> Self {
        Self { labels, ..self }
    }

    /// The pans as an arc.
    pub fn pan(&self) -> AngleRange {
        AngleRange::new(
            Angle::from_degrees(*self.pan_deg.start()),
            Angle::from_degrees(*self.pan_deg.end()),
        )
    }
}

/// The smallest range that contains all values; `None` without any.
fn range(values: impl Iterator<Item = f64> + Clone) -> Option<RangeInclusive<f64>> {
    let least = values.clone().min_by(f64::total_cmp)?;
    let greatest = values.max_by(f64::total_cmp)?;
    Some(least..=greatest)
}

impl ForestModel {
    /// The forest of a camera.
    pub fn camera(&self, name: &str) -> Option<&CameraForest> {
        self.cameras.iter().find(|forest| forest.camera == name)
    }

    /// The file: magic, version, length and CRC-32 of the rest, then the rest; little-endian
    /// throughout.
    pub fn to_bytes(&self) -> Vec<u8> {
        // The body comes first, because the header states its length and checksum. Each list is
        // preceded by its length, and `from_bytes` reads the fields in this order.
        let mut body = Vec::new();
        text(&mut body, &self.document);
        for number in self.features.numbers() {
            body.extend(number.to_le_bytes());
        }
        body.extend((self.cameras.len() as u32).to_le_bytes());
        for camera in &self.cameras {
            text(&mut body, &camera.camera);
            for range in [
                &camera.seen.pan_deg,
                &camera.seen.tilt_deg,
                &camera.seen.focal_px,
            ] {
                body.extend(range.start().to_le_bytes());
                body.extend(range.end().to_le_bytes());
            }
            body.extend(camera.seen.references.to_le_bytes());
            body.extend((camera.seen.cameras.len() as u32).to_le_bytes());
            for ptz in &camera.seen.cameras {
                for number in [ptz.pan.radians(), ptz.tilt.radians(), ptz.focal_px] {
                    body.extend(number.to_le_bytes());
                }
            }
            body.extend((camera.seen.labels.len() as u32).to_le_bytes());
            for number in camera.seen.labels.iter().flat_map(upper) {
                body.extend(number.to_le_bytes());
            }
            body.extend(camera.seen.shown.certain.to_le_bytes());
            body.extend(camera.seen.shown.right.to_le_bytes());
            write_forest(&camera.forest, &mut body);
        }
        // The header allows a reader to reject a truncated or altered file before it interprets any
        // of it.
        let mut file = Vec::with_capacity(body.len() + 24);
        file.extend(MAGIC);
        file.extend(FOREST_VERSION.to_le_bytes());
        file.extend((body.len() as u64).to_le_bytes());
        file.extend(crc32fast::hash(&body).to_le_bytes());
        file.extend(body);
        file
    }

    /// Reads a forest file.
    ///
    /// # Errors
    /// The bytes are no forest, come from a newer or older program, or are damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ForestFileError> {
        // The version is checked before length and checksum: another version may have another
        // header, and to state the version helps more than to call the file damaged.
        let mut header = Reader::new(bytes);
        if header.bytes(MAGIC.len()).ok() != Some(MAGIC) {
            return Err(ForestFileError::NotAForest);
        }
        let version = header.u32()?;
        if version > FOREST_VERSION {
            return Err(ForestFileError::Newer {
                version,
                newest: FOREST_VERSION,
            });
        }
        if version < FOREST_VERSION {
            return Err(ForestFileError::Older { version });
        }
        let (length, checksum) = (header.u64()?, header.u32()?);
        let length =
            usize::try_from(length).map_err(|_| ForestFileError::damaged("it ends too early"))?;
        let body = header.bytes(length)?;
        header.finish()?;
        if crc32fast::hash(body) != checksum {
            return Err(ForestFileError::damaged("its checksum does not fit"));
        }
        // The checksum finds accidents, not a file made with intent, so each number is still
        // checked as it is read.
        let mut body = Reader::new(body);
        let document = body.text()?.to_owned();
        let features = FeatureOptions {
            max_count: body.u32()?,
            max_width_px: body.u32()?,
            root_sift: match body.u32()? {
                0 => false,
                1 => true,
                _ => {
                    return Err(ForestFileError::damaged(
                        "its kind of features is not known",
                    ));
                }
            },
            detector: Detector::from_code(body.u32()?).ok_or(ForestFileError::damaged(
                "its detector of features is not known",
            ))?,
        };
        let count = body.count(1)?;
        let cameras = (0..count)
            .map(|_| camera(&mut body))
            .collect::<Result<_, _>>()?;
        body.finish()?;
        Ok(Self {
            document,
            features,
            cameras,
        })
    }
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

/// The upper triangle of a covariance, row by row.
fn upper(covariance: &Mat3) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| covariance[at])
}

fn camera(body: &mut Reader) -> Result<CameraForest, ForestFileError> {
    let camera = body.text()?.to_owned();
    let mut seen = SeenRange {
        pan_deg: body.f64()?..=body.f64()?,
        tilt_deg: body.f64()?..=body.f64()?,
        focal_px: body.f64()?..=body.f64()?,
        references: body.u32()?,
        cameras: Vec::new(),
        labels: Vec::new(),
        shown: CertainAnswerCounts::default(),
    };
    for _ in 0..body.count(CAMERA_BYTES)? {
        let (pan, tilt) = (
            Angle::from_radians(body.f64()?),
            Angle::from_radians(body.f64()?),
        );
        seen.cameras.push(Ptz::new(pan, tilt, body.f64()?));
    }
    for _ in 0..body.count(LABEL_BYTES)? {
        let mut upper = [0.0; 6];
        for number in &mut upper {
            *number = body.f64()?;
        }
        let [a, b, c, d, e, f] = upper;
        seen.labels.push(Mat3::new(a, b, c, b, d, e, c, e, f));
    }
    seen.shown = CertainAnswerCounts {
        certain: body.u32()?,
        right: body.u32()?,
    };
    Ok(CameraForest {
        camera,
        seen,
        forest: body.forest()?,
    })
}

/// How often certain answers about left-out references were right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CertainAnswerCounts {
    /// Number of answers stated to be certain: see [`CERTAIN`].
    pub certain: u32,
    /// Number of those that were right.
    pub right: u32,
}

/// Weight of the prior success rate, in answers.
const BEFORE: f64 = 20.0;

/// Prior success rate of certain answers, from the calibration on other matches.
const RIGHT_BEFORE: f64 = 0.998;

/// An answer of at least this probability is called certain: it is used for other frames without
/// confirmation by the user.
pub const CERTAIN: f64 = 0.9;

impl CertainAnswerCounts {
    /// Upper bound of the stated probability: the success rate of certain answers, combined with
    /// the prior rate. 1 if nothing was measured.
    pub fn at_most(&self) -> f64 {
        if self.certain == 0 {
            return 1.0;
        }
        (f64::from(self.right) + BEFORE * RIGHT_BEFORE) / (f64::from(self.certain) + BEFORE)
    }
}

#[cfg(test)]
mod tests {
    use super::CertainAnswerCounts;

    #[test]
    fn wrong_answers_about_references_bound_what_is_stated() {
        let at_most = |certain, right| CertainAnswerCounts { certain, right }.at_most();
        assert!(at_most(0, 0) == 1.0);
        assert!((0.998..0.9995).contains(&at_most(8, 8)) && at_most(200, 200) > at_most(8, 8));
        assert!((0.92..0.95).contains(&at_most(8, 6)), "{}", at_most(8, 6));
        assert!(at_most(8, 7) < at_most(32, 31));
    }
}
