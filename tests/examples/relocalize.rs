//! A forest trained on a document's references, and asked for the camera of a picture without
//! clicks.
//!
//! ```sh
//! cargo run --release --example relocalize -- [DOC PICTURE]
//! ```

use std::env;
use std::error::Error;
use std::path::PathBuf;
use touchline::features::extract;
use touchline::media::{FrameReader, FrameRef};
use touchline::progress::Progress;
use touchline::proposals::{
    FeatureStore, FramePictures, LearnOptions, TrainingFrames, learn, study,
};
use touchline::relocalize::{RelocalizeOptions, relocalize};
use touchline::store::read;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let path = arguments
        .next()
        .map_or_else(|| PathBuf::from("projects/demo"), PathBuf::from);
    let picture = arguments.next().map_or_else(
        || PathBuf::from("projects/demo/images/0002.jpg"),
        PathBuf::from,
    );
    let (location, document, _) = read(&path)?;

    // The training samples of the references: features, each with its ray.
    let (options, store) = (LearnOptions::default(), FeatureStore::in_memory());
    let pictures = FramePictures {
        document: &document,
        folder: location.folder(),
        options: options.features,
        store: &store,
    };
    let mut reader = FrameReader::new();
    let references = TrainingFrames::from_document(&document, false).frames;
    let studied =
        study(&pictures, &mut reader, &references, &Progress::default()).ok_or("stopped")?;
    let model = learn(&document, &studied, &options, &Progress::default())?;

    // The picture of a camera that the forest knows.
    let camera = document
        .cameras
        .first()
        .ok_or("the document has no camera")?;
    let forest = model
        .camera(camera.id.as_str())
        .ok_or("the forest does not know the camera")?;
    let base = camera.base().ok_or("the camera has no base")?;
    let picture = reader.read(&FrameRef::image(picture))?;
    let features = extract(&picture, &camera.masks, &model.features)?;
    let answer = relocalize(
        &features,
        &forest.forest,
        &forest.seen,
        &base,
        &RelocalizeOptions::default(),
    );

    let pose = answer.pose?;
    println!(
        "pan {:.2}, tilt {:.2}, focal length {:.0} px",
        pose.ptz.pan, pose.ptz.tilt, pose.ptz.focal_px
    );
    println!(
        "confidence {:.3}, {} features agree",
        pose.confidence,
        pose.inliers.len()
    );
    Ok(())
}
