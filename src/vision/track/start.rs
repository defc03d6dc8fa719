//! Initial rotations and focal lengths of matched frames, chained along a spanning tree of the view
//! graph.

use super::ViewGraphEdge;
use super::cycles::zoom_and_turn;
use super::edge_residual::View;
use touchline_core::geometry::rotation::nearest_rotation;
use touchline_core::geometry::{ImagePoint, Mat3};

/// An edge of the spanning tree: a frame, and the homography to it from a frame reached before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub frame: usize,
    pub from: usize,
    pub to_from: Mat3,
    pub zoom: f64,
}

/// A maximum spanning tree of the view graph by number of inliers (Prim's algorithm), in the order
/// in which frames are reached. The root is the frame with the most inliers and is its own first
/// step. Frames that are not connected to it are missing.
pub(super) fn steps(
    count: usize,
    edges: &[ViewGraphEdge],
    (centre, pixel_aspect): (ImagePoint, f64),
) -> Vec<Step> {
    // From square pixels about the centre to those of the picture.
    let pixels = Mat3::new(
        1.0,
        0.0,
        0.0,
        0.0,
        pixel_aspect,
        centre.y * (1.0 - pixel_aspect),
        0.0,
        0.0,
        1.0,
    );
    let square = Mat3::new(
        1.0,
        0.0,
        0.0,
        0.0,
        1.0 / pixel_aspect,
        centre.y * (1.0 - 1.0 / pixel_aspect),
        0.0,
        0.0,
        1.0,
    );
    // Root: the frame with the most inliers in total, the first of equals.
    let mut strength = vec![0_usize; count];
    for edge in edges {
        strength[edge.first] += edge.agreeing;
        strength[edge.second] += edge.agreeing;
    }
    let Some(root) = (0..count).max_by_key(|&frame| (strength[frame], std::cmp::Reverse(frame)))
    else {
        return Vec::new();
    };
    let mut reached = vec![false; count];
    reached[root] = true;
    let mut steps = vec![Step {
        frame: root,
        from: root,
        to_from: Mat3::identity(),
        zoom: 1.0,
    }];
    // Add the strongest edge between a frame reached and one not reached.
    while let Some(edge) = edges
        .iter()
        .filter(|edge| reached[edge.first] != reached[edge.second])
        .max_by_key(|edge| edge.agreeing)
    {
        let forth = reached[edge.first];
        let (from, frame) = if forth {
            (edge.first, edge.second)
        } else {
            (edge.second, edge.first)
        };
        reached[frame] = true;
        // A homography without an inverse, or of no sensible zoom, gives a start without that
        // motion or zoom: the adjustment that follows has to mend it, and its residual tells if it
        // did not.
        let to_from = if forth {
            edge.second_from_first
        } else {
            edge.second_from_first
                .try_inverse()
                .unwrap_or_else(Mat3::identity)
        };
        let to_from = if pixel_aspect == 1.0 {
            to_from
        } else {
            square * to_from * pixels
        };
        let zoom = zoom_and_turn(&to_from, centre).map_or(1.0, |(zoom, _)| zoom);
        steps.push(Step {
            frame,
            from,
            to_from,
            zoom,
        });
    }
    steps
}

/// The views of all frames if the root has the focal length `focal_px` and an identity rotation.
pub(super) fn views(count: usize, steps: &[Step], centre: ImagePoint, focal_px: f64) -> Vec<View> {
    let start = View {
        cam_from_common: Mat3::identity(),
        focal_px,
        principal_point: centre,
    };
    let mut views = vec![start; count];
    // For a rotating camera H ∝ K' R K⁻¹, so R ∝ K'⁻¹ H K (Hartley and Zisserman: "Multiple View
    // Geometry", section 8.4). The zoom gives K'; scaling to determinant 1 removes the unknown
    // factor, and the nearest rotation removes what noise and a wrong focal length leave.
    for step in steps.iter().skip(1) {
        let from = views[step.from];
        let focal_px = from.focal_px * step.zoom;
        let mut turn = inverse_calibration_matrix(focal_px, centre)
            * step.to_from
            * calibration_matrix(from.focal_px, centre);
        if turn.determinant() < 0.0 {
            turn = -turn;
        }
        let scale = turn.determinant().cbrt();
        let turned = if scale > 0.0 {
            nearest_rotation(&(turn / scale))
        } else {
            Mat3::identity()
        };
        views[step.frame] = View {
            cam_from_common: turned * from.cam_from_common,
            focal_px,
            ..from
        };
    }
    views
}

/// K: from directions in the camera to px, for a pinhole with square pixels.
fn calibration_matrix(focal_px: f64, centre: ImagePoint) -> Mat3 {
    Mat3::new(
        focal_px, 0.0, centre.x, 0.0, focal_px, centre.y, 0.0, 0.0, 1.0,
    )
}

/// K⁻¹: from px to directions in the camera.
fn inverse_calibration_matrix(focal_px: f64, centre: ImagePoint) -> Mat3 {
    Mat3::new(
        1.0 / focal_px,
        0.0,
        -centre.x / focal_px,
        0.0,
        1.0 / focal_px,
        -centre.y / focal_px,
        0.0,
        0.0,
        1.0,
    )
}
