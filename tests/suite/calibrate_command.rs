//! `touchline calibrate`: the camera of a drawn match without a click.
#![cfg(feature = "opencv")]

use crate::program::touchline;
use std::fs;
use std::path::Path;
use touchline::document::{Document, FrameStatus, SolutionSource, document_from_bytes};
use touchline::geometry::ImagePoint;

fn document(path: &Path) -> Document {
    document_from_bytes(&fs::read(path).unwrap()).unwrap()
}

/// How far a frame's overlay is off at the corners of a grid over the ground it shows, px: the greatest.
fn worst_px(found: &Document, truth: &Document, frame: usize) -> f64 {
    let (found_frame, exact) = (&found.frames[frame], &truth.frames[frame]);
    let (found, exact) = (found.pointed(found_frame).unwrap(), truth.pointed(exact).unwrap());
    let size = found_frame.image_size;
    let pixels = (0..48).map(|index| {
        let share = |at: u32, of: u32| (f64::from(at) + 0.5) / f64::from(of);
        ImagePoint::new(share(index % 8, 8) * f64::from(size.width), share(index / 8, 6) * f64::from(size.height))
    });
    let apart = |pixel: ImagePoint| {
        let ground = exact.plane_from_image(pixel, 0.0).filter(|at| at.x.abs() < 52.0 && at.y.abs() < 34.0)?;
        Some(found.image_from_world(ground).map_or(f64::INFINITY, |image| image.distance_px(pixel)))
    };
    pixels.filter_map(apart).fold(0.0, f64::max)
}

#[test]
fn a_drawn_match_is_calibrated_without_a_click_and_other_sports_are_not_found_in_it() {
    let place = tempfile::tempdir().unwrap();
    let drawn = touchline(place.path(), "synth -o match --frames 12 --seed 5 --size 960x540 --preset easy");
    assert_eq!(drawn.code, 0, "{}", drawn.stderr);
    let ran = touchline(place.path(), "calibrate match/images -o found");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let (found, truth) =
        (document(&place.path().join("found/project.json")), document(&place.path().join("match/truth.json")));
    let (base, exact) = (found.cameras[0].base().unwrap(), truth.cameras[0].base().unwrap());
    let off_m = (base.position_m - exact.position_m).norm();
    assert!(off_m < 1.0 && off_m < 4.0 * base.sigma.position_m.norm(), "{off_m} m: {}", ran.stderr);
    for frame in 0..found.frames.len() {
        assert!(found.frames[frame].clicks.is_empty());
        assert_eq!(found.frames[frame].status, FrameStatus::Suggested);
        let source = found.frames[frame].solution.as_ref().and_then(|solution| solution.source);
        assert_eq!(source, Some(SolutionSource::Markings));
        let off_px = worst_px(&found, &truth, frame);
        assert!(off_px < 5.0, "frame {frame}: {off_px} px");
    }
    let again = touchline(place.path(), "calibrate match/images -o again");
    assert_eq!(again.code, 0);
    let text = |name: &str| fs::read_to_string(place.path().join(name).join("project.json")).unwrap();
    assert_eq!(text("found"), text("again"), "same input, same bytes");

    let other = touchline(place.path(), "calibrate match/images -o other --field basketball_fiba");
    assert_eq!((other.code, other.stderr.trim_end().lines().count()), (2, 1), "{}", other.stderr);
    let refusals = ["not certain", "no place for the camera"];
    assert!(refusals.iter().any(|refusal| other.stderr.contains(refusal)), "{}", other.stderr);
    assert!(!place.path().join("other").exists(), "nothing is left behind");
}

#[test]
fn what_cannot_be_calibrated_is_one_line_and_leaves_nothing() {
    let place = tempfile::tempdir().unwrap();
    fs::create_dir(place.path().join("grey")).unwrap();
    for index in 0..4_u8 {
        let picture = image::RgbImage::from_fn(320, 180, |x, y| {
            image::Rgb([(x / 40 * 30) as u8, (y / 30 * 20) as u8, 40 * index])
        });
        picture.save(place.path().join(format!("grey/{index}.png"))).unwrap();
    }
    fs::create_dir(place.path().join("empty")).unwrap();
    for (arguments, named) in [
        ("calibrate grey -o found", "show the same stadium"),
        ("calibrate empty -o found", "holds no image"),
        ("calibrate nowhere -o found", "nowhere"),
        ("calibrate grey -o found --field cricket", "no field template is named"),
        ("calibrate grey -o found --set length_m=3", "length_m"),
        ("calibrate grey -o empty --look-at 2", "--look-at"),
    ] {
        let ran = touchline(place.path(), arguments);
        assert_eq!((ran.code, ran.stderr.trim_end().lines().count()), (2, 1), "{arguments}: {}", ran.stderr);
        assert!(ran.stderr.contains(named), "{arguments}: {}", ran.stderr);
        assert!(!place.path().join("found").exists(), "{arguments}");
    }
}
