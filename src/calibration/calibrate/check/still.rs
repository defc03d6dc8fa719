//! Frames in which the camera is exactly still according to its numbers, while the picture moves.

use super::fault::{Fault, Problem};
use crate::calibrate::Disagreements;
use touchline_documents::document::{Document, DocumentAt};
use touchline_vision::features::{ReducedPicture, has_moved};
use touchline_vision::media::FrameReader;

/// Maximum number of pictures of a run that are compared with its first.
const COMPARED: usize = 4;

/// The runs of frames in which the camera is exactly still while the picture moves. What was
/// matched there is fixed on the screen, or a camera was kept for frames that it does not fit.
/// Pictures that cannot be read are skipped.
pub fn check_still_runs(document: DocumentAt<'_>) -> Vec<Problem> {
    let mut reader = FrameReader::new();
    let mut problems = Vec::new();
    for run in still_runs(document.document) {
        let [first, others @ ..] = &*run else {
            continue;
        };
        let Some(shown) = read_reduced(document, *first, &mut reader) else {
            continue;
        };
        // Compare pictures spread evenly over the run, the last one included.
        let compared = COMPARED.min(others.len());
        let mut spread = (1..=compared).map(|at| others[at * others.len() / compared - 1]);
        let moves = spread.any(|other| {
            read_reduced(document, other, &mut reader)
                .is_some_and(|other| has_moved(&shown, &other) == Some(true))
        });
        if moves && let Some(last) = run.last().and_then(|last| document.frames.get(*last)) {
            let fault = Fault::StillCamera {
                last: last.name(),
                frames: run.len(),
            };
            problems.push(Problem::in_frame(*first, &document.frames[*first], fault));
        }
    }
    problems
}

/// The runs of at least three frames of a shot in which the camera is exactly still, as indices in
/// the document.
fn still_runs(document: &Document) -> Vec<Vec<usize>> {
    let known = Disagreements::from_document(document);
    let mut runs = Vec::new();
    for shot in known.shots() {
        let places: Vec<usize> = shot.iter().copied().collect();
        let inside: Vec<usize> = (0..places.len())
            .filter(|&at| {
                known
                    .for_frame(places[at])
                    .is_some_and(|found| found.is_still())
            })
            .collect();
        // A still frame has the same camera as its two neighbours, so each run extends by one frame
        // at both ends. A still frame always has neighbours on both sides.
        for run in inside.chunk_by(|one, next| one + 1 == *next) {
            if let [first, .., last] | [first @ last] = run {
                runs.push(places[first - 1..=last + 1].to_vec());
            }
        }
    }
    runs.sort();
    runs
}

/// The reduced picture of a frame; none if it cannot be read.
fn read_reduced(
    document: DocumentAt<'_>,
    index: usize,
    reader: &mut FrameReader,
) -> Option<ReducedPicture> {
    let source = document
        .frames
        .get(index)?
        .picture_source(document.folder)?;
    Some(ReducedPicture::new(&reader.read(&source).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::camera::CameraBase;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::base_at;
    use touchline_documents::document::{Clip, FrameStatus};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    const SIZE: ImageSize = ImageSize::new(480, 270);

    fn base(image_size: ImageSize) -> CameraBase {
        base_at([0.0, -60.0, 18.0], image_size)
    }

    /// A shot of four frames with one camera, whose pictures show stripes moved by these px.
    fn shot(folder: &Path, moved_px: [u32; 4]) -> Document {
        let mut document = match_from(&base(SIZE), SIZE);
        for (index, moved_px) in moved_px.into_iter().enumerate() {
            let name = format!("{index}.png");
            let stripes = |x: u32, y: u32| {
                image::Rgb(
                    [if (x + y / 2 + moved_px) % 31 < 15 {
                        90_u8
                    } else {
                        160
                    }; 3],
                )
            };
            image::RgbImage::from_fn(SIZE.width, SIZE.height, stripes)
                .save(folder.join(&name))
                .unwrap();
            let mut frame = new_frame(&name, SIZE);
            frame.clip = Some(Clip::Number(1));
            frame.ptz = ptz_at(3.0, -10.0, 600.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn a_camera_that_is_still_while_the_picture_moves_is_named_and_a_tripod_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let found = |moved_px| check_still_runs(shot(folder.path(), moved_px).at(folder.path()));
        assert_eq!(found([5; 4]), []);
        let [problem] = &found([0, 4, 8, 12])[..] else {
            panic!("one run")
        };
        assert_eq!(
            (problem.frame, problem.place.as_str()),
            (Some(0), "frames[0] (0.png)")
        );
        assert_eq!(
            problem.fault,
            Fault::StillCamera {
                last: "3.png".to_owned(),
                frames: 4
            }
        );
    }

    #[test]
    fn a_run_is_three_frames_of_a_shot_with_one_camera() {
        const SIZE: ImageSize = ImageSize::new(1280, 720);
        let mut document = match_from(&base(SIZE), SIZE);
        let still = [
            (1, 2.0),
            (1, 2.0),
            (1, 2.001),
            (1, 3.0),
            (1, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 3.0),
            (2, 4.0),
        ];
        for (number, (clip, pan_deg)) in still.into_iter().enumerate() {
            let name = format!("{number}.jpg");
            let mut frame = new_frame(&name, SIZE);
            frame.clip = Some(Clip::Number(clip));
            frame.ptz = ptz_at(pan_deg, -10.0, 1400.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        assert_eq!(still_runs(&document), [vec![0, 1, 2], vec![5, 6, 7, 8]]);
        document.frames[1].ptz.as_mut().unwrap().tilt_deg += 0.1;
        assert_eq!(still_runs(&document), [vec![5, 6, 7, 8]]);
    }
}
