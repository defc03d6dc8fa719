//! Conversion between the field's axes and those of a virtual-production stage, in which tracks are
//! written.

use crate::document::Stage;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use touchline_core::geometry::{Mat3, Vec3};

/// The axes of a stage in `world`, as columns: x to its right, y ahead, z up.
fn world_from_stage(stage: &Stage) -> Mat3 {
    // The heading is positive to the right, like pan: at 90° the stage looks along +x of the field,
    // and its x axis points along −y.
    let (sin, cos) = stage.heading_deg.to_radians().sin_cos();
    Mat3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0)
}

/// The frame with its camera in other axes. `position` maps points into them, and `rotation` maps
/// directions back.
fn transform_camera(
    frame: &FrameCamera,
    position: impl Fn(Vec3) -> Vec3,
    rotation: &Mat3,
) -> FrameCamera {
    // Only a camera has axes; tracks have no homographies.
    let FrameProjection::Camera(pinhole) = &frame.shown else {
        return frame.clone();
    };
    let moved = Pinhole {
        position_m: position(pinhole.position_m),
        cam_from_world: pinhole.cam_from_world * rotation,
        ..*pinhole
    };
    FrameCamera {
        shown: FrameProjection::Camera(moved),
        ..frame.clone()
    }
}

/// A frame's camera in the axes of a stage.
pub fn in_stage(frame: &FrameCamera, stage: &Stage) -> FrameCamera {
    let axes = world_from_stage(stage);
    transform_camera(frame, |at| axes.transpose() * (at - stage.origin_m), &axes)
}

/// A frame's camera in the field's axes, from those of a stage.
pub fn in_world(frame: &FrameCamera, stage: &Stage) -> FrameCamera {
    let axes = world_from_stage(stage);
    transform_camera(frame, |at| axes * at + stage.origin_m, &axes.transpose())
}

#[cfg(test)]
mod tests {
    use crate::document::Stage;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, reference};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;
    use touchline_core::geometry::Vec3;

    /// A stage at the penalty mark on the right that looks toward the left goal.
    fn stage() -> Stage {
        Stage {
            heading_deg: -90.0,
            ..Stage::at(Vec3::new(41.5, 0.0, 0.5))
        }
    }

    #[test]
    fn a_track_is_written_in_the_axes_of_the_stage_and_proves_itself_in_the_fields() {
        let mut document = reference();
        document.cameras[0].stage = Some(stage());
        let exported = export(
            document.at(Path::new("/")),
            Format::OpenTrackIo,
            &ExportOptions::default(),
        )
        .unwrap();
        assert!(exported.worst_px < 1e-6, "{}", exported.worst_px);
        let text = String::from_utf8(exported.files.sorted_entries()[0].1.to_vec()).unwrap();
        let sample: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
        let transform = &sample["transforms"][0];
        let near = |value: &serde_json::Value, wanted: f64| {
            (value.as_f64().unwrap() - wanted).abs() < 1e-9
        };
        // The camera is 60 m toward the near side, which is on the stage's left, and 41.5 m ahead.
        let at = &transform["translation"];
        assert!(
            near(&at["x"], -60.0) && near(&at["y"], 41.5) && near(&at["z"], 17.5),
            "{transform}"
        );
        // It looks 12.5 degrees right of the far side, which the stage has on its right.
        assert!(near(&transform["rotation"]["pan"], -102.5), "{transform}");
    }

    #[test]
    fn every_track_goes_through_a_stage_and_back() {
        for format in [Format::OpenTrackIo, Format::FreeDCsv, Format::Chan] {
            let options = ExportOptions {
                stage: Some(stage()),
                ..ExportOptions::default()
            };
            let exported = export(awkward().at(Path::new("/")), format, &options).unwrap();
            assert!(exported.worst_px < 1e-6, "{format}: {}", exported.worst_px);
            assert!(
                exported
                    .notes
                    .iter()
                    .any(|note| note.contains("axes of the stage")),
                "{:?}",
                exported.notes
            );
        }
    }
}
