//! A camera that lies beside its paint is named with the line, and one that lies on it is not.
#![cfg(feature = "opencv")]

use crate::undo_of_commands::documents::all_turned;
use crate::undo_of_commands::scene::Scene;
use touchline_core::geometry::Angle;

/// Of the frames of the demo match with cameras turned by some degrees: how many were measured, and
/// how many are said to lie beside their paint. Only frames that are off by at least `least_px` at
/// 1920 px width count.
fn accused(turned_deg: f64, least_px: f64) -> [usize; 2] {
    let mut scene = Scene::open(&all_turned(turned_deg), false);
    let frames = scene.window.app.open().unwrap().document.frames.len();
    scene.wait_until("the line checks", |app| {
        (0..frames).all(|frame| app.own_paint_says(frame).is_some())
    });
    let app = &scene.window.app;
    let mut counts = [0; 2];
    for (index, frame) in app.open().unwrap().document.frames.iter().enumerate() {
        let focal_px = frame.ptz.as_ref().unwrap().focal_px;
        let off_px = Angle::from_degrees(turned_deg).radians() * focal_px
            / frame.image_size.scale_from_1920();
        if off_px < least_px || app.line_offsets(index).is_empty() {
            continue;
        }
        counts[0] += 1;
        counts[1] += usize::from(app.line_beside_paint(index).is_some());
    }
    counts
}

#[test]
fn a_camera_ten_px_beside_its_paint_is_named_and_a_right_one_is_not() {
    let [right, wrongly] = accused(0.0, 0.0);
    let [off, named] = accused(0.4, 10.0);
    eprintln!("right: {wrongly} of {right} accused; 10 px off: {named} of {off} named");
    assert!(right >= 20 && wrongly == 0, "{wrongly} of {right}");
    assert!(off >= 10 && named * 10 >= off * 9, "{named} of {off}");
}
