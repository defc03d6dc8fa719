//! Which drawn landmark or line lies under the pointer: what can be grabbed and dragged.

use super::overlay::{OverlayScene, landmarks_without_click, lines_in_picture};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

/// A landmark or line as it is drawn over the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnElement {
    /// Its name.
    pub target: Target,
    /// Where it is drawn, px of the picture: a landmark's ring, or the point of a line that is
    /// nearest to the pointer.
    pub image: ImagePoint,
}

/// How near the pointer has to be, px of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementReach {
    /// To a landmark's ring.
    pub landmark_px: f64,
    pub line_px: f64,
}

/// The drawn landmark or line nearest to a point of the picture; none within reach.
///
/// A landmark within reach precedes every line, because landmarks lie on lines.
pub fn element_at(
    scene: &OverlayScene<'_>,
    at: ImagePoint,
    reach: ElementReach,
) -> Option<DrawnElement> {
    landmark_at(scene, at, reach.landmark_px).or_else(|| line_at(scene, at, reach.line_px))
}

fn landmark_at(scene: &OverlayScene<'_>, at: ImagePoint, reach_px: f64) -> Option<DrawnElement> {
    if !scene.style.landmarks {
        return None;
    }
    let (landmark, _) = landmarks_without_click(scene)
        .into_iter()
        .map(|landmark| (landmark, landmark.image.distance_px(at)))
        .filter(|(_, distance_px)| *distance_px <= reach_px)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(DrawnElement {
        target: Target::Landmark(scene.field.landmarks[landmark.landmark].id.clone()),
        image: landmark.image,
    })
}

fn line_at(scene: &OverlayScene<'_>, at: ImagePoint, reach_px: f64) -> Option<DrawnElement> {
    let mut nearest: Option<(usize, ImagePoint)> = None;
    // The distance to beat begins at the reach, so that nothing farther is found.
    let mut least_px = reach_px;
    for line in lines_in_picture(scene) {
        for ends in line.points.windows(2) {
            let on_line = at.nearest_on_segment(ends[0], ends[1]);
            let distance_px = on_line.distance_px(at);
            // A click has to lie within the picture; lines are drawn up to its edge.
            if distance_px <= least_px && scene.image_size.contains(on_line) {
                least_px = distance_px;
                nearest = Some((line.line, on_line));
            }
        }
    }
    let (line, image) = nearest?;
    Some(DrawnElement {
        target: Target::Line(scene.field.lines[line].id.clone()),
        image,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::OverlayStyle;
    use touchline_core::camera::PtzCamera;
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_core::testing::{TestBase, base_at, soccer};
    use touchline_documents::document::Click;

    const SIZE: ImageSize = ImageSize::new(1280, 720);
    const REACH: ElementReach = ElementReach {
        landmark_px: 8.0,
        line_px: 5.0,
    };

    fn camera() -> PtzCamera {
        base_at([0.0, -60.0, 18.0], SIZE).aim(0.0, -14.0, 1000.0)
    }

    #[test]
    fn a_ring_comes_before_the_line_through_it_and_beside_both_there_is_nothing() {
        let (field, camera, style) = (soccer(), camera(), OverlayStyle::default());
        let scene = OverlayScene {
            camera: Some(&camera),
            ..OverlayScene::new(&field, SIZE, &style)
        };
        let mark = field.landmark_in_world(field.landmark("centre_mark").unwrap());
        let ring = camera.image_from_world(mark).unwrap();
        let near = ImagePoint::new(ring.x + 3.0, ring.y - 4.0);
        let found = element_at(&scene, near, REACH).unwrap();
        assert_eq!(found.target, Target::Landmark("centre_mark".into()));
        assert!(found.image.distance_px(ring) < 1e-9);

        // On the halfway line between the centre mark and the circle.
        let on_line = camera
            .image_from_world(mark + Vec3::new(0.0, 5.0, 0.0))
            .unwrap();
        let near = ImagePoint::new(on_line.x + 4.0, on_line.y);
        let found = element_at(&scene, near, REACH).unwrap();
        assert_eq!(found.target, Target::Line("halfway_line".into()));
        assert!(found.image.distance_px(on_line) < 1.0, "{found:?}");

        let beside = ImagePoint::new(on_line.x + 20.0, on_line.y);
        assert_eq!(element_at(&scene, beside, REACH), None);
    }

    #[test]
    fn what_is_not_drawn_cannot_be_grabbed() {
        let (field, camera) = (soccer(), camera());
        let mark = field.landmark_in_world(field.landmark("penalty_mark_left").unwrap());
        let look_left = camera.base().aim(-35.0, -12.0, 1500.0);
        let ring = look_left.image_from_world(mark).unwrap();
        let style = OverlayStyle::default();
        let scene = OverlayScene {
            camera: Some(&look_left),
            ..OverlayScene::new(&field, SIZE, &style)
        };
        assert!(SIZE.contains(ring) && element_at(&scene, ring, REACH).is_some());
        let clicks = [Click::landmark("penalty_mark_left".into(), ring)];
        let clicked = OverlayScene {
            clicks: &clicks,
            ..scene
        };
        assert_eq!(
            element_at(&clicked, ring, REACH),
            None,
            "the click itself is what is grabbed there"
        );
        let without_rings = OverlayStyle {
            landmarks: false,
            ..style
        };
        let scene_without_rings = OverlayScene {
            style: &without_rings,
            ..scene
        };
        assert_eq!(element_at(&scene_without_rings, ring, REACH), None);
        let unsolved = OverlayScene {
            camera: None,
            ..scene
        };
        assert_eq!(element_at(&unsolved, ring, REACH), None);
    }
}
