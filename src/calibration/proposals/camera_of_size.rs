//! The camera of a picture that says nothing but its size.

use thiserror::Error;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{Camera, Document};
use touchline_vision::relocalize::ForestModel;

/// Why the size of a picture does not decide its camera.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CameraOfSizeError {
    /// No camera with a forest has pictures of this size.
    #[error(
        "{} × {} px; the forest has no camera with pictures of this size",
        size.width,
        size.height
    )]
    Missing {
        /// The size of the picture.
        size: ImageSize,
    },
    /// Several cameras with a forest have. What to do about it is the caller's to add.
    #[error(
        "{} × {} px; {} cameras of the forest have pictures of this size ({}), and an \
         image does not say which is its own",
        size.width,
        size.height,
        names.len(),
        names.join(", ")
    )]
    Several {
        /// The size of the picture.
        size: ImageSize,
        /// The names of the cameras.
        names: Vec<String>,
    },
}

/// The camera of a forest with pictures of a size. `of_forest` is the document stored in the
/// forest.
///
/// # Errors
/// There is none, or there are several.
pub fn camera_of_size<'a>(
    of_forest: &'a Document,
    model: &ForestModel,
    size: ImageSize,
) -> Result<&'a Camera, CameraOfSizeError> {
    // Cameras without references have no forest, so that no picture can be answered with them.
    let cameras = of_forest.cameras.iter().map(|camera| &**camera);
    let with_forest = cameras.filter(|camera| model.camera(camera.id.as_str()).is_some());
    only_of_size(with_forest, size)
}

/// The only one of these cameras with pictures of a size.
fn only_of_size<'a>(
    cameras: impl Iterator<Item = &'a Camera>,
    size: ImageSize,
) -> Result<&'a Camera, CameraOfSizeError> {
    // A picture says nothing else of its camera: of several, each choice would be a guess.
    let of_size: Vec<&Camera> = cameras.filter(|camera| camera.image_size == size).collect();
    match of_size[..] {
        [camera] => Ok(camera),
        [] => Err(CameraOfSizeError::Missing { size }),
        _ => {
            let names = of_size.iter().map(|camera| camera.id.as_str().to_owned());
            Err(CameraOfSizeError::Several {
                size,
                names: names.collect(),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::testing::a_match;
    use touchline_vision::features::FeatureOptions;

    #[test]
    fn an_image_whose_size_two_cameras_have_is_given_to_neither() {
        let (wide, small) = (ImageSize::new(1920, 1080), ImageSize::new(1280, 720));
        let cameras = [("main", wide), ("left", small), ("right", small)]
            .map(|(name, size)| Camera::new(name.into(), size));
        assert_eq!(
            only_of_size(cameras.iter(), wide).unwrap().id.as_str(),
            "main"
        );
        for (size, said) in [
            (
                small,
                "2 cameras of the forest have pictures of this size (left, right)",
            ),
            (
                ImageSize::new(64, 48),
                "64 × 48 px; the forest has no camera",
            ),
        ] {
            let refused = only_of_size(cameras.iter(), size).unwrap_err().to_string();
            assert!(refused.contains(said), "{refused}");
        }
    }

    #[test]
    fn a_camera_without_a_forest_is_given_to_no_image() {
        let size = ImageSize::new(1280, 720);

        let document = a_match(size);
        let model = ForestModel {
            document: String::new(),
            features: FeatureOptions::default(),
            cameras: Vec::new(),
        };
        assert_eq!(
            camera_of_size(&document, &model, size),
            Err(CameraOfSizeError::Missing { size })
        );
    }
}
