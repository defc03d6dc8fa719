//! Pictures of drawn matches, in a folder.

use image::codecs::jpeg::JpegEncoder;
use std::path::Path;
use touchline::camera::{CameraBase, PtzCamera};
use touchline::document::{Camera, CameraId, Document, FieldSpec, Frame};
use touchline::geometry::ImageSize;
use touchline::synthetic::{FrameOptions, PathStep, ShootOptions, Stadium, camera_path};

/// The size of the pictures.
pub const SIZE: ImageSize = ImageSize::new(960, 540);

/// The camera's name in the documents.
pub const CAMERA: &str = "main";

/// A document without frames, and a camera of which nothing is known.
pub fn document(field: FieldSpec, size: ImageSize) -> Document {
    let mut document = Document::new(field);
    document
        .cameras
        .push(Camera::new(CameraId::from(CAMERA), size).into());
    document
}

/// A picture to be drawn.
#[derive(Clone)]
pub struct Shot {
    pub camera: PtzCamera,
    pub options: FrameOptions,
}

/// A drawn sequence and its exact cameras.
pub struct Drawn {
    pub document: Document,
    pub truth: Vec<PtzCamera>,
}

/// The pictures that an operator takes with a camera.
pub fn shots(
    scene: &Stadium,
    base: &CameraBase,
    shoot: &ShootOptions,
    frames: usize,
    seed: u64,
) -> Vec<Shot> {
    let path = camera_path(scene, base, SIZE, shoot, frames);
    let shot = |(index, step): (usize, &PathStep)| Shot {
        camera: PtzCamera::new(*base, step.ptz),
        options: shoot.frame(index, step, SIZE, seed),
    };
    path.iter().enumerate().map(shot).collect()
}

/// Draws the pictures that the folder lacks, and makes a document of them.
pub fn draw(folder: &Path, scenes: &[(&Stadium, &[Shot])], quality: u8, field: FieldSpec) -> Drawn {
    std::fs::create_dir_all(folder).unwrap();
    let mut truth = Vec::new();
    let mut document = document(field, SIZE);
    for (scene, shots) in scenes {
        for shot in *shots {
            let name = format!("{:04}.jpg", truth.len());
            let file = folder.join(&name);
            document
                .frames
                .push(Frame::from_image(&name, CameraId::from(CAMERA), SIZE).into());
            if !file.exists() {
                let mut bytes = Vec::new();
                let drawn = scene.render(&shot.camera, SIZE, &shot.options).image;
                JpegEncoder::new_with_quality(&mut bytes, quality)
                    .encode_image(&drawn)
                    .unwrap();
                std::fs::write(&file, bytes).unwrap();
            }
            truth.push(shot.camera);
        }
    }
    Drawn { document, truth }
}
