//! The directions that references see, and where a reference is missing.

use std::ops::RangeInclusive;
use touchline_core::camera::{CameraBase, PanTilt, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, AngleRange, ImageSize, Vec3};
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame};

/// Number of columns (pan) and rows (tilt) of the map.
const COLUMNS: usize = 30;
const ROWS: usize = 8;

/// Margin of the map around the field, degrees.
const MARGIN_DEG: f64 = 2.0;

/// Ground up to this far outside the field counts as field, m.
const BESIDE_M: f64 = 3.0;

/// The directions that the references of a camera see: a map over pan and tilt of the rays from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// The camera.
    pub camera: CameraId,
    /// The pans from the map's left to its right border.
    pub pan: AngleRange,
    /// The map's lower and upper border, degrees of tilt.
    pub tilt_deg: RangeInclusive<f64>,
    /// Columns of the map.
    pub columns: usize,
    /// Cells of the map, row by row from the top.
    pub cells: Vec<CoverageCell>,
    /// Pan of the middle of the widest part of the field that no reference sees, degrees; none if
    /// all of it is seen.
    pub missing_pan_deg: Option<f64>,
}

/// A cell of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CoverageCell {
    /// Number of references that see its centre.
    pub references: u32,
    /// Whether its centre is on the field.
    pub field: bool,
}

impl Coverage {
    /// The coverage by `training_frames`, for each camera that has any, in the document's order.
    /// Cameras without a base or a valid field are left out.
    pub fn measure_cameras(document: DocumentAt<'_>, training_frames: &[usize]) -> Vec<Self> {
        let used = document.cameras.iter().filter(|camera| {
            let mut frames = training_frames
                .iter()
                .filter_map(|&index| document.frames.get(index));
            frames.any(|frame| frame.camera == camera.id)
        });
        let coverages = used.filter_map(|camera| {
            let spec = document.field_of_camera(&camera.id);
            let field = spec.model(document.folder).ok()?;
            Self::measure(&document, &field, &camera.id, training_frames)
        });
        coverages.collect()
    }

    /// The coverage of one camera by `training_frames`. None if the camera has no base.
    pub fn measure(
        document: &Document,
        field: &FieldModel,
        camera: &CameraId,
        training_frames: &[usize],
    ) -> Option<Self> {
        let base = document.camera(camera)?.base()?;
        // The map covers the border of the field as seen from the camera. Pans are an angular
        // range, because they wrap.
        let outline = outline(field, &base);
        let pan = AngleRange::smallest(outline.iter().map(|ray| ray.pan))?
            .expand(Angle::from_degrees(MARGIN_DEG));
        let tilts = || outline.iter().map(|ray| ray.tilt.degrees());
        let tilt_deg = tilts().min_by(f64::total_cmp)? - MARGIN_DEG
            ..=tilts().max_by(f64::total_cmp)? + MARGIN_DEG;
        let seeing: Vec<ReferenceView> = training_frames
            .iter()
            .filter_map(|&index| document.frames.get(index).map(|frame| &**frame))
            .filter(|frame| frame.camera == *camera)
            .filter_map(|frame| ReferenceView::from_frame(document, frame))
            .collect();
        // Count for the centre of each cell the references that show it.
        let middle_of = |step: usize, steps: usize| (step as f64 + 0.5) / steps as f64;
        let lower_deg = *tilt_deg.start();
        let height_deg = tilt_deg.end() - lower_deg;
        let cells = (0..ROWS)
            .flat_map(|row| (0..COLUMNS).map(move |column| (row, column)))
            .map(|(row, column)| {
                let tilt_deg = lower_deg + middle_of(ROWS - 1 - row, ROWS) * height_deg;
                let ray = PanTilt {
                    pan: pan.at(middle_of(column, COLUMNS)),
                    tilt: Angle::from_degrees(tilt_deg),
                };
                let direction = ray.direction();
                let seen = seeing.iter().filter(|view| view.shows(ray, &direction));
                CoverageCell {
                    references: seen.count() as u32,
                    field: shows_field(field, &base, ray),
                }
            })
            .collect();
        let mut coverage = Self {
            camera: camera.clone(),
            pan,
            tilt_deg,
            columns: COLUMNS,
            cells,
            missing_pan_deg: None,
        };
        coverage.missing_pan_deg = coverage.widest_gap_deg();
        Some(coverage)
    }

    /// The value of a new reference with this view, from 0 to 1: the mean of 1/(n + 1) over the
    /// cells of the field in the view, where n references see the cell already. None if the view
    /// shows no field.
    pub fn novelty(&self, view: AngleRange) -> Option<f64> {
        /// Tolerance for rounding, in columns, so that a view that ends exactly on the border of a
        /// column does not include the next one.
        const ROUNDING: f64 = 1e-9;
        let columns = self.columns as f64;
        // The columns that the view overlaps.
        let (middle, half) = (
            self.pan.share(view.centre()) * columns,
            0.5 * columns * (view.width().radians() / self.pan.width().radians()),
        );
        let first = (middle - half + ROUNDING).floor().max(0.0) as usize;
        let last = (middle + half - ROUNDING).ceil().max(0.0) as usize;
        let (mut value, mut places) = (0.0, 0_u32);
        for row in self.cells.chunks(self.columns.max(1)) {
            for cell in row.iter().take(last).skip(first).filter(|cell| cell.field) {
                value += 1.0 / f64::from(cell.references + 1);
                places += 1;
            }
        }
        (places > 0).then(|| value / f64::from(places))
    }

    /// Pan of the middle of the longest run of columns with a part of the field that no reference
    /// sees. Of equally long runs, the first.
    fn widest_gap_deg(&self) -> Option<f64> {
        let gaps: Vec<usize> = (0..self.columns)
            .filter(|column| self.is_gap(*column))
            .collect();
        // `max_by_key` returns the last of equals: reversed, that is the first run.
        let runs = gaps.chunk_by(|a, b| a + 1 == *b);
        let widest = runs.rev().max_by_key(|run| run.len())?;
        let middle = (widest.first()? + widest.last()? + 1) as f64 / 2.0 / self.columns as f64;
        Some(self.pan.at(middle).wrap().degrees())
    }

    /// Whether a column shows some of the field, and no reference sees any of it.
    fn is_gap(&self, column: usize) -> bool {
        let mut cells = self
            .cells
            .iter()
            .skip(column)
            .step_by(self.columns)
            .filter(|cell| cell.field)
            .peekable();
        cells.peek().is_some() && cells.all(|cell| cell.references == 0)
    }
}

/// The view of a frame.
struct ReferenceView {
    camera: PtzCamera,
    image_size: ImageSize,
    /// Direction of the centre of its picture in the base.
    middle: Vec3,
    /// Cosine of the angle between that direction and the farthest corner. Most rays lie outside of
    /// this cone, and the test is cheaper than a projection.
    reach: f64,
}

impl ReferenceView {
    fn from_frame(document: &Document, frame: &Frame) -> Option<Self> {
        let camera = document.ptz_camera(frame)?;
        let image_size = frame.image_size;
        let middle = camera.ray_from_image(image_size.centre()).ok()?.direction();
        let corners = image_size.corners().into_iter();
        let cosines = corners.map(|corner| {
            camera
                .ray_from_image(corner)
                .map_or(-1.0, |ray| ray.direction().dot(&middle))
        });
        // A corner beyond the fold of the lens has no ray. A cosine of −1 then lets all rays pass
        // to the exact test.
        let reach = cosines.fold(1.0, f64::min);
        Some(Self {
            camera,
            image_size,
            middle,
            reach,
        })
    }

    fn shows(&self, ray: PanTilt, direction: &Vec3) -> bool {
        // The cone first, then the exact test.
        direction.dot(&self.middle) >= self.reach
            && self
                .camera
                .image_from_ray(ray)
                .is_ok_and(|image| self.image_size.contains(image))
    }
}

/// The border of the field as rays from the camera.
fn outline(field: &FieldModel, base: &CameraBase) -> Vec<PanTilt> {
    /// Half the number of points on each side.
    const STEPS: i32 = 20;
    let (x_m, y_m) = (field.length_m / 2.0, field.width_m / 2.0);
    let along = (-STEPS..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
    along
        .flat_map(|t| {
            [
                (t * x_m, -y_m),
                (t * x_m, y_m),
                (-x_m, t * y_m),
                (x_m, t * y_m),
            ]
        })
        .map(|(x, y)| {
            PanTilt::from_direction(base.base_from_world_point(Vec3::new(x, y, field.ground_z(y))))
        })
        .collect()
}

/// Whether a ray meets the plane z = 0 within the field or its margin; below the horizon only.
fn shows_field(field: &FieldModel, base: &CameraBase, ray: PanTilt) -> bool {
    // Intersect the ray with z = 0; the crown is neglected.
    let direction = base.base_from_world.transpose() * ray.direction();
    // A ray that is parallel to the ground gives an infinite or undefined distance, for which no
    // comparison below is true.
    let distance = -base.position_m.z / direction.z;
    let at = base.position_m + direction * distance;
    distance > 0.0
        && at.x.abs() <= field.length_m / 2.0 + BESIDE_M
        && at.y.abs() <= field.width_m / 2.0 + BESIDE_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{soccer, turned_base};
    use touchline_documents::testing::{match_from, new_frame, ptz_at};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// Frames with these pans.
    fn document(pans_deg: &[f64]) -> Document {
        let mut document = match_from(
            &turned_base([0.0, -66.0, 18.0], [0.0, -2.0, 0.0], SIZE),
            SIZE,
        );
        for pan_deg in pans_deg {
            let mut frame = new_frame("a.jpg", SIZE);
            frame.ptz = ptz_at(*pan_deg, -10.0, 1800.0);
            document.frames.push(frame.into());
        }
        document
    }

    fn coverage(document: &Document, training_frames: &[usize]) -> Coverage {
        let field = soccer();
        Coverage::measure(document, &field, &"main".into(), training_frames).unwrap()
    }

    #[test]
    fn what_many_references_see_is_hardly_new() {
        let document = document(&[-40.0, -40.0, -40.0]);
        let found = coverage(&document, &[0, 1, 2]);
        let novelty = |from, upto| {
            found.novelty(AngleRange::new(
                Angle::from_degrees(from),
                Angle::from_degrees(upto),
            ))
        };
        assert_eq!(novelty(20.0, 40.0), Some(1.0));
        let (known, partly) = (novelty(-41.0, -39.0).unwrap(), novelty(-40.0, 0.0).unwrap());
        assert!(
            (0.25..0.6).contains(&known) && known < partly && partly < 1.0,
            "{known} {partly}"
        );
        assert_eq!(
            (novelty(90.0, 100.0), novelty(-170.0, -120.0)),
            (None, None)
        );
        let folder = std::path::Path::new("");
        assert_eq!(
            Coverage::measure_cameras(document.at(folder), &[0, 1, 2]),
            [found]
        );
        assert_eq!(Coverage::measure_cameras(document.at(folder), &[]), []);
    }

    #[test]
    fn what_no_reference_sees_is_missing() {
        let document = document(&[-40.0, -15.0, 10.0, 50.0, 30.0]);
        let found = coverage(&document, &[0, 1, 2]);
        assert_eq!(found.cells.len(), ROWS * COLUMNS);
        let (left, right) = (found.pan.start().degrees(), found.pan.end().degrees());
        assert!(left < -50.0 && right > 50.0, "{:?}", found.pan);
        let missing = found.missing_pan_deg.unwrap();
        assert!((30.0..60.0).contains(&missing), "{missing}");
        let middle = coverage(&document, &[]).missing_pan_deg.unwrap();
        assert!(
            middle.abs() < 3.0,
            "nothing is seen: begin in the middle, {middle}"
        );
        let seen: u32 = found.cells.iter().map(|cell| cell.references).sum();
        assert!(
            seen > 0
                && coverage(&document, &[])
                    .cells
                    .iter()
                    .all(|cell| cell.references == 0)
        );
        assert!(
            found.cells.iter().any(|cell| cell.field) && found.cells.iter().any(|cell| !cell.field)
        );
    }
}
