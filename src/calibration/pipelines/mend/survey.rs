//! What given cameras say about themselves before any picture is read: which are impossible, which
//! are mirrored, and where they stand.

use super::given::{GivenCamera, GivenFault, given_cameras};
use super::places::{mirror_back, places_of_given};
use touchline_core::field::FieldError;
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::{DocumentAt, Fields, Frame};

/// The cameras that another program gave for the frames of a document, compared with each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraSurvey {
    /// Number of frames with a given camera.
    pub cameras: usize,
    /// The impossible ones among them, in the document's order.
    pub impossible: Vec<ImpossibleCamera>,
    /// Number of mirrored ones among them.
    pub mirrored: usize,
    /// The places that the possible ones share, the one with the most frames first. Their members
    /// are indices of frames of the document.
    pub places: Vec<SharedPlace>,
}

/// A frame with an impossible camera.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpossibleCamera {
    /// The name under which it came, or that of its picture.
    pub frame: String,
    /// What makes its camera impossible.
    pub fault: GivenFault,
}

/// The name under which a frame's camera came, else that of its picture.
fn name_of_camera(frame: &Frame) -> String {
    frame.labels_name.clone().unwrap_or_else(|| frame.name())
}

/// Examines the imported cameras of a document that no person has decided on.
///
/// # Errors
/// The field of a camera is not valid.
pub fn survey_cameras(at: DocumentAt<'_>) -> Result<CameraSurvey, FieldError> {
    let document = at.document;
    let fields = Fields::from_document(at)?;
    let mut given = given_cameras(document, &fields);
    for (frame, given) in document.frames.iter().zip(&mut given) {
        // Cameras that this program or a person determined say nothing about what was imported.
        if !frame.has_imported_camera() {
            *given = GivenCamera::Missing;
        }
    }
    let places = places_of_given(&given);
    let impossible = document
        .frames
        .iter()
        .zip(&given)
        .filter_map(|(frame, given)| {
            Some(ImpossibleCamera {
                frame: name_of_camera(frame),
                fault: given.fault()?.clone(),
            })
        });
    let impossible = impossible.collect();
    let mirrored = mirror_back(&given, &places);
    Ok(CameraSurvey {
        cameras: given.iter().filter(|given| !given.is_missing()).count(),
        impossible,
        mirrored: mirrored.iter().filter(|given| given.is_mirrored()).count(),
        places,
    })
}
