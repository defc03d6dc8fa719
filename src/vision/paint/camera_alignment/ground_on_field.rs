//! The colours of the ground inside the field that a camera projects.
//!
//! A picture alone suggests its most common colour as the ground ([`Surface`]). That is the wrong
//! one where a court differs from its surroundings: a purple tennis court in a green surround, a
//! green mat on a blue carpet. A camera says where the field is, and what is smooth there is
//! ground, whatever its colour.
//!
//! [`Surface`]: crate::paint::Surface

use super::unexplained::on_field;
use crate::paint::GroundPicture;
use std::borrow::Cow;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::ImagePoint;

/// Distance between the pixels that are looked at, px at 1920 px width.
const SPACING_PX: f64 = 16.0;

/// A pixel's surroundings are smooth if the brightness this far away, px, differs from its own by
/// at most the larger of the two limits: a share of it, grey levels. Players, nets and crowds are
/// not.
const NEIGHBOUR_PX: u32 = 2;
const SMOOTH_SHARE: f64 = 0.12;
const SMOOTH: f64 = 6.0;

/// Minimum number of smooth pixels on the field.
const MIN_SMOOTH: usize = 60;

/// The picture's own ground is right if at least this share of the field's smooth pixels has its
/// colours.
const SHARE_OF_OWN: f64 = 0.8;

/// Minimum share of the field's pixels that are smooth. Where a wrong camera projects the field
/// into stands, they have no ground.
const SHARE_OF_SMOOTH: f64 = 0.5;

/// The picture with the ground as the field inside has it. Unchanged where the picture's own ground
/// covers the field, and where no colours do.
pub(in crate::paint) fn ground_on_field<'a>(
    ground: &'a GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> Cow<'a, GroundPicture> {
    let inside = FieldColours::inside(ground, field, camera);
    let smooth = inside.smooth.len();
    if smooth < MIN_SMOOTH || (smooth as f64) < SHARE_OF_SMOOTH * inside.all as f64 {
        return Cow::Borrowed(ground);
    }
    let own = ground.surface();
    let of_own = inside.smooth.iter().filter(|colour| own.holds(**colour));
    if of_own.count() as f64 >= SHARE_OF_OWN * smooth as f64 {
        return Cow::Borrowed(ground);
    }
    own.with_floor(&inside.smooth)
        .map_or(Cow::Borrowed(ground), |surface| {
            Cow::Owned(ground.with_surface(surface))
        })
}

/// The pixels of a picture that show the field, subsampled.
struct FieldColours {
    /// Number of pixels, smooth or not.
    all: usize,
    /// The colours of those with smooth surroundings.
    smooth: Vec<[u8; 3]>,
}

impl FieldColours {
    fn inside(ground: &GroundPicture, field: &FieldModel, camera: &PtzCamera) -> Self {
        let size = ground.size();
        let step = (SPACING_PX * size.scale_from_1920()).round().max(2.0) as usize;
        let mut found = Self {
            all: 0,
            smooth: Vec::new(),
        };
        let margin = NEIGHBOUR_PX;
        for y in (margin..size.height.saturating_sub(margin)).step_by(step) {
            for x in (margin..size.width.saturating_sub(margin)).step_by(step) {
                let at = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                if on_field(camera, field, at).is_none() || ground.is_masked(at) {
                    continue;
                }
                found.all += 1;
                if is_smooth(ground, x, y)
                    && let Some([red, green, blue, _]) = ground.picture().pixel(x, y)
                {
                    found.smooth.push([red, green, blue]);
                }
            }
        }
        found
    }
}

/// Whether the brightness of a pixel is about that of the pixels left, right, above and below.
fn is_smooth(ground: &GroundPicture, x: u32, y: u32) -> bool {
    let grey = ground.grey();
    let width = grey.size.width as usize;
    let at = |x: u32, y: u32| f64::from(grey.values[y as usize * width + x as usize]);
    let here = at(x, y);
    let far = NEIGHBOUR_PX;
    let beside = [
        at(x - far, y),
        at(x + far, y),
        at(x, y - far),
        at(x, y + far),
    ];
    let limit = SMOOTH.max(SMOOTH_SHARE * here);
    beside.iter().all(|grey| (grey - here).abs() <= limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{
        COURT, HARD_COURT, PICTURE, court, court_truth, soccer, tennis, tennis_camera,
        tennis_truth, truth,
    };
    use crate::paint::{SnapOptions, check_lines, snap};
    use touchline_core::markings::LineVerdict;

    #[test]
    fn the_ground_of_the_picture_stays_where_it_covers_the_field() {
        for (picture, field, camera) in [
            (&PICTURE, soccer(), truth()),
            (&COURT, court(), court_truth()),
        ] {
            let ground = GroundPicture::new(picture, &[]);
            let on_field = ground_on_field(&ground, &field, &camera);
            assert!(matches!(on_field, Cow::Borrowed(_)));
        }
    }

    /// More of the picture is green than purple, so that the court is not the picture's own ground.
    #[test]
    fn a_court_of_another_colour_than_its_surroundings_is_checked_and_aligned_to() {
        let (ground, field) = (GroundPicture::new(&HARD_COURT, &[]), tennis());
        assert!(ground.surface().is_turf() && !ground.surface().holds([92, 70, 140]));
        let check = check_lines(&ground, &field, &tennis_truth());
        assert_eq!(check.verdict(), LineVerdict::Supports, "{check:?}");
        assert!(check.found * 10 >= check.num_open() * 9, "{check:?}");

        let beside = tennis_camera(0.25, -13.2, 2010.0);
        let (base, start) = (beside.base(), beside.ptz());
        let aligned = snap(&ground, &field, base, start, &[], &SnapOptions::default()).unwrap();
        let pan_deg = aligned.ptz.pan.degrees();
        assert!(pan_deg.abs() < 0.01, "{pan_deg}°");

        let wrong = check_lines(&ground, &field, &tennis_camera(2.0, -13.0, 2000.0));
        assert_ne!(wrong.verdict(), LineVerdict::Supports, "{wrong:?}");
    }
}
