//! Frames are looked at coarsely first, and finely only where that leaves a doubt.
#![cfg(feature = "opencv")]

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_calibration::pipelines::{ForestRequest, propose_on_lines};
use touchline_calibration::proposals::{
    FeatureStore, FramePictures, FrameWithFeatures, LearnOptions, LineEvidence, Resolution,
    TrainingFrames, learn, overlay_error_px, study,
};
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, Frame};
use touchline_documents::store::read;
use touchline_documents::testing::soccer_document;
use touchline_vision::features::{FeatureKey, FeatureOptions, Features};
use touchline_vision::media::{FrameReader, sha256_of_file};
use touchline_vision::relocalize::{CERTAIN, RelocalizeOptions};

fn demo() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../projects/demo")
}

/// Whether the features of a frame at these options are in a store.
fn has_features(pictures: &FramePictures<'_>, frame: &Frame, options: &FeatureOptions) -> bool {
    let sha256 = sha256_of_file(&frame.image_path(pictures.folder).unwrap()).unwrap();
    let masks = pictures.document.masks_of(frame);
    let key = FeatureKey::new(&sha256, options, &masks);
    pictures.store.get(&key).is_some()
}

#[test]
fn work_that_is_content_sees_coarse_features_alone_and_the_rest_both_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = soccer_document();
    for (name, width) in [("wide", 960), ("narrow", 480)] {
        let size = ImageSize::new(width, 270);
        let camera = Camera::new(name.into(), size);
        document.cameras.push(camera.into());
        for number in 0..10 {
            let file = format!("{name}-{number}.png");
            let texture = |x: u32, y: u32| image::Luma([((x * 7) ^ (y * 5) ^ (number * 31)) as u8]);
            image::GrayImage::from_fn(width, 270, texture)
                .save(folder.path().join(&file))
                .unwrap();
            let frame = Frame::from_image(&file, name.into(), size);
            document.frames.push(frame.into());
        }
    }
    let store = FeatureStore::in_memory();
    let pictures = FramePictures {
        document: &document,
        folder: folder.path(),
        options: FeatureOptions::default(),
        store: &store,
    };
    let open: Vec<usize> = (0..20).rev().collect();
    let looks = pictures.each_coarse_to_fine(
        &mut FrameReader::new(),
        &open,
        |look: FrameWithFeatures<'_, Vec<(usize, Resolution)>>| {
            let mut seen = look.earlier.unwrap_or_default();
            seen.push((look.index, look.found.unwrap().resolution));
            ControlFlow::Continue(seen)
        },
        |seen| seen[0].0.is_multiple_of(3),
    );
    for (index, seen) in open.into_iter().zip(looks.unwrap()) {
        let expected = match index {
            10.. => vec![(index, Resolution::Fine)],
            0 | 3 | 6 | 9 => vec![(index, Resolution::Coarse), (index, Resolution::Fine)],
            _ => vec![(index, Resolution::Coarse)],
        };
        assert_eq!(seen, expected);
    }
    let ended = pictures.each_coarse_to_fine(
        &mut FrameReader::new(),
        &[0, 1],
        |look: FrameWithFeatures<'_, ()>| match look.earlier {
            Some(()) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        },
        |()| true,
    );
    assert_eq!(ended, None);
}

#[test]
fn the_demo_is_answered_by_coarse_features_and_only_doubts_cost_fine_ones() {
    let (location, document, _) = read(&demo()).unwrap();
    let (_, truth, _) = read(&demo().join("truth.json")).unwrap();
    let (options, store) = (LearnOptions::default(), FeatureStore::in_memory());
    let pictures = FramePictures {
        document: &document,
        folder: location.folder(),
        options: options.features,
        store: &store,
    };
    let mut reader = FrameReader::new();
    let references = TrainingFrames::from_document(&document, false).frames;
    let studied = study(&pictures, &mut reader, &references, &Progress::default()).unwrap();
    assert!(studied.failed.is_empty());
    for sample in &studied.training_samples {
        let coarse = sample.coarse.as_ref().unwrap();
        let smallest = |features: &Features| {
            let sizes = features.keypoints.iter().map(|keypoint| keypoint.size_px);
            sizes.fold(f32::INFINITY, f32::min)
        };
        let [smallest_coarse, smallest_fine] =
            [coarse, &sample.fine].map(|look| smallest(&look.features));
        assert!(coarse.rays.len() > 100 && smallest_coarse > 1.5 * smallest_fine);
    }
    let model = learn(&document, &studied, &options, &Progress::default()).unwrap();
    let forest = ForestRequest {
        model: &model,
        generation: 0,
        options: RelocalizeOptions::default(),
    };
    let evidence =
        LineEvidence::from_document(document.at(location.folder()), &mut reader, false).unwrap();
    let open: Vec<usize> = (0..document.frames.len())
        .filter(|&index| document.frames[index].ptz.is_none())
        .collect();
    let proposals = propose_on_lines(
        &pictures,
        &mut reader,
        &open,
        &forest,
        Some(&evidence),
        &Progress::default(),
    );
    let mut by_coarse = 0;
    for (&index, proposal) in open.iter().zip(&proposals) {
        let frame = &*document.frames[index];
        assert_eq!(proposal.frame, frame.id);
        let answer = proposal.outcome.as_ref().unwrap();
        let camera = truth.ptz_camera(&truth.frames[index]).unwrap();
        let found = PtzCamera::new(proposal.request.base.unwrap(), answer.ptz.ptz());
        let error_px = overlay_error_px(&camera, &found, frame.image_size);
        assert!(error_px < 10.0, "{}: {error_px} px", frame.name());
        let needed_fine = has_features(&pictures, frame, &options.features);
        by_coarse += usize::from(!needed_fine);
        // No doubtful answer rests on coarse features alone.
        assert!(
            needed_fine || answer.confidence >= CERTAIN,
            "{}",
            frame.name()
        );
    }
    assert!(
        by_coarse * 3 > open.len() * 2,
        "{by_coarse} of {}",
        open.len()
    );
}
