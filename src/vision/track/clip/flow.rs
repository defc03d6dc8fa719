//! The boundary to OpenCV's corner detector and optical flow; only this file deals with OpenCV's
//! pixel convention.

use crate::media::GreyPicture;
use opencv::core::{Mat, Point, Point2f, Rect, Scalar, Size, TermCriteria, Vector, no_array};
use opencv::prelude::*;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// OpenCV's origin is the centre of the first pixel; ours is its top-left corner.
const CORNER_FROM_OPENCV: f64 = 0.5;

/// Side of the window of Lucas–Kanade, px.
const PATCH_PX: i32 = 21;

/// Number of pyramid levels above the full picture.
const LEVELS: i32 = 3;

/// Minimum eigenvalue threshold of OpenCV's flow (its default): patches with less texture are not
/// tracked.
const MIN_TEXTURE: f64 = 1e-4;

/// Minimum strength of a corner, relative to the strongest corner in its cell of the picture.
const CORNER_QUALITY: f64 = 0.05;

/// Rows and columns of cells from which corners are taken.
const ROWS: i32 = 5;
const COLUMNS: i32 = 8;

/// Forward–backward check: largest distance between a point and its image tracked forth and back,
/// px.
const THERE_AND_BACK_PX: f32 = 1.0;

/// A picture with its image pyramid.
pub(super) struct FlowPicture {
    grey: Mat,
    levels: Vector<Mat>,
    size: ImageSize,
}

impl FlowPicture {
    pub fn from_grey(grey: &GreyPicture) -> opencv::Result<Self> {
        let size = grey.size;
        // `rows` borrows the pixels; the clone owns them. The pyramid is built once and serves
        // four flows: forth and back, with the picture before it and with the next one.
        let rows = Mat::new_rows_cols_with_bytes::<u8>(
            size.height as i32,
            size.width as i32,
            &grey.values,
        )?;
        let grey = rows.try_clone()?;
        let mut levels = Vector::<Mat>::new();
        let patch = Size::new(PATCH_PX, PATCH_PX);
        let border = opencv::core::BORDER_REFLECT_101;
        let no_border = opencv::core::BORDER_CONSTANT;
        opencv::video::build_optical_flow_pyramid(
            &grey,
            &mut levels,
            patch,
            LEVELS,
            true,
            border,
            no_border,
            false,
        )?;
        Ok(Self { grey, levels, size })
    }

    /// The strongest corners of each cell of the picture, outside the masks. Each cell gets an
    /// equal share of `limit`, less the points in `taken` that it already contains. Corners keep
    /// `distance_px` from all of `taken`, and from each other within a cell.
    pub fn corners(
        &self,
        limit: usize,
        distance_px: f64,
        taken: &[ImagePoint],
        masks: &[PixelBox],
    ) -> opencv::Result<Vec<ImagePoint>> {
        // Blank out the masks and the surroundings of points that are already tracked.
        let mut open = Mat::new_rows_cols_with_default(
            self.size.height as i32,
            self.size.width as i32,
            opencv::core::CV_8UC1,
            Scalar::all(255.0),
        )?;
        // A mask that begins within a pixel ends one pixel later, hence the + 1. The conversions to
        // integers saturate, and so does this sum: a document may state any number.
        let (closed, filled) = (Scalar::all(0.0), opencv::imgproc::FILLED);
        for mask in masks {
            let whole = Rect::new(
                mask.x.floor() as i32,
                mask.y.floor() as i32,
                (mask.width.ceil() as i32).saturating_add(1),
                (mask.height.ceil() as i32).saturating_add(1),
            );
            let line = opencv::imgproc::LINE_8;
            opencv::imgproc::rectangle(&mut open, whole, closed, filled, line, 0)?;
        }
        for point in taken {
            let centre = pixel_of(*point);
            let (radius, line) = (distance_px as i32, opencv::imgproc::LINE_8);
            opencv::imgproc::circle(&mut open, centre, radius, closed, filled, line, 0)?;
        }
        // Equal numbers per cell, so that points cover the picture.
        let mut corners = Vec::new();
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let ((left, right), (top, bottom)) = (
                    cell_range_px(column, COLUMNS, self.size.width),
                    cell_range_px(row, ROWS, self.size.height),
                );
                let area = Rect::new(left, top, right - left, bottom - top);
                let inside = taken.iter().filter(|at| area.contains(pixel_of(**at)));
                let wanted = (limit / (ROWS * COLUMNS) as usize).saturating_sub(inside.count());
                if wanted > 0 {
                    corners.extend(self.strongest(area, &open, wanted, distance_px)?);
                }
            }
        }
        Ok(corners)
    }

    /// The strongest corners of one cell, where `open` is not zero. Burnt-in graphics are crisper
    /// than anything else; the strongest corners of the whole picture would all be on them.
    fn strongest(
        &self,
        area: Rect,
        open: &Mat,
        limit: usize,
        distance_px: f64,
    ) -> opencv::Result<impl Iterator<Item = ImagePoint>> {
        let (part, open) = (Mat::roi(&self.grey, area)?, Mat::roi(open, area)?);
        let (mut found, limit) = (Vector::<Point2f>::new(), limit as i32);
        // The smaller eigenvalue as measure (Shi and Tomasi: "Good features to track", CVPR 1994),
        // over blocks of 5 px; 0.04 is Harris' parameter and has no effect here.
        let (block, harris) = (5, false);
        opencv::imgproc::good_features_to_track(
            &part,
            &mut found,
            limit,
            CORNER_QUALITY,
            distance_px,
            &open,
            block,
            harris,
            0.04,
        )?;
        let corner = Point2f::new(area.x as f32, area.y as f32);
        Ok(found.into_iter().map(move |at| from_opencv(at + corner)))
    }

    /// Tracks points into another picture. Each item is a point's position here and a guess of its
    /// position there; `None` if it is not found, leaves the picture, or fails the forward–backward
    /// check.
    pub fn track_into(
        &self,
        into: &Self,
        points: &[(ImagePoint, ImagePoint)],
    ) -> opencv::Result<Vec<Option<ImagePoint>>> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        // Track forth from the guess, then back from where that ended, and compare with the start.
        // A point that is covered or that has changed seldom returns. The search back begins at the
        // start, which is where it ends if the point is the same.
        let from: Vector<Point2f> = points.iter().map(|(from, _)| to_opencv(*from)).collect();
        let guess: Vector<Point2f> = points.iter().map(|(_, guess)| to_opencv(*guess)).collect();
        let (there, found) = flow(&self.levels, &into.levels, &from, guess)?;
        let (back, returned) = flow(&into.levels, &self.levels, &there, from.clone())?;
        let mut tracked = Vec::with_capacity(points.len());
        for at in 0..points.len() {
            let (start, end, again) = (from.get(at)?, there.get(at)?, back.get(at)?);
            let off_px = (start.x - again.x).hypot(start.y - again.y);
            let good = found.get(at)? == 1
                && returned.get(at)? == 1
                && off_px <= THERE_AND_BACK_PX
                && self.size.contains(from_opencv(end));
            tracked.push(good.then(|| from_opencv(end)));
        }
        Ok(tracked)
    }
}

/// The first pixel of a cell and that of the next one, along a side that is divided into `cells`.
fn cell_range_px(cell: i32, cells: i32, side_px: u32) -> (i32, i32) {
    (
        cell * side_px as i32 / cells,
        (cell + 1) * side_px as i32 / cells,
    )
}

/// Pyramidal Lucas–Kanade from an initial guess (Bouguet: "Pyramidal implementation of the Lucas
/// Kanade feature tracker", Intel, 2001).
fn flow(
    from: &Vector<Mat>,
    into: &Vector<Mat>,
    points: &Vector<Point2f>,
    guess: Vector<Point2f>,
) -> opencv::Result<(Vector<Point2f>, Vector<u8>)> {
    // `there` is the guess on the way in and the result on the way out. A search ends after 20
    // steps or one shorter than 0.01 px.
    let (mut there, mut found) = (guess, Vector::<u8>::new());
    let until = TermCriteria::new(
        opencv::core::TermCriteria_COUNT + opencv::core::TermCriteria_EPS,
        20,
        0.01,
    )?;
    let patch = Size::new(PATCH_PX, PATCH_PX);
    opencv::video::calc_optical_flow_pyr_lk(
        from,
        into,
        points,
        &mut there,
        &mut found,
        &mut no_array(),
        patch,
        LEVELS,
        until,
        opencv::video::OPTFLOW_USE_INITIAL_FLOW,
        MIN_TEXTURE,
    )?;
    Ok((there, found))
}

/// The pixel that contains a point, as OpenCV counts it. In the corner convention its index is the
/// integer part.
fn pixel_of(at: ImagePoint) -> Point {
    Point::new(at.x as i32, at.y as i32)
}

fn to_opencv(at: ImagePoint) -> Point2f {
    Point2f::new(
        (at.x - CORNER_FROM_OPENCV) as f32,
        (at.y - CORNER_FROM_OPENCV) as f32,
    )
}

fn from_opencv(at: Point2f) -> ImagePoint {
    ImagePoint::new(
        f64::from(at.x) + CORNER_FROM_OPENCV,
        f64::from(at.y) + CORNER_FROM_OPENCV,
    )
}
