//! Going to a frame by its number or its time in the application: numbers are those of the video's
//! frames.

use touchline_application::app::place::FrameOrTime;
use touchline_application::app::{Action, App, Navigation};
use touchline_core::geometry::ImageSize;
use touchline_documents::testing::{WithFrames, a_match, new_video_frame};

/// Every fifth of a hundred frames of one video, then ten of another one.
fn app_with_samples() -> App {
    let size = ImageSize::new(64, 36);
    let one = (0..100).step_by(5).map(|index| ("one.mp4", index));
    let all = one.chain((0..10).map(|index| ("other.mp4", index)));
    let frames = all.map(|(video, index)| new_video_frame(video, index, size));
    App::with_document(a_match(size).with_frames(frames))
}

/// The number of the frame that is shown after going to a place, and what was said.
fn go_to_place(app: &mut App, place: &str) -> (u64, String) {
    app.session.messages.notices.clear();
    app.update(Action::Navigate(Navigation::GoToPlace(
        place.parse::<FrameOrTime>().unwrap(),
    )));
    let said = app
        .session
        .messages
        .notices
        .iter()
        .map(|notice| notice.text.clone())
        .collect();
    (app.open().unwrap().frame_number(app.session.frame), said)
}

#[test]
fn a_number_is_that_of_the_videos_frame() {
    let mut app = app_with_samples();
    assert_eq!(go_to_place(&mut app, "45"), (45, String::new()));
    assert_eq!(app.session.frame, 9);
    assert_eq!(
        go_to_place(&mut app, "1:00"),
        (95, String::new()),
        "the last one is nearest to a time behind it"
    );
    assert_eq!(
        go_to_place(&mut app, "17"),
        (
            15,
            "There is no frame 17: the nearest one is 15.".to_owned()
        )
    );
    assert_eq!(
        go_to_place(&mut app, "500"),
        (
            95,
            "There is no frame 500: the nearest one is 95.".to_owned()
        )
    );
    assert_eq!(
        app.open().unwrap().numbers_beside(app.session.frame),
        (0, 95)
    );
}

#[test]
fn a_number_is_looked_for_in_the_video_that_is_shown() {
    let mut app = app_with_samples();
    app.update(Action::Navigate(Navigation::GoTo(24)));
    assert_eq!(go_to_place(&mut app, "7"), (7, String::new()));
    assert_eq!(app.session.frame, 27);
    assert_eq!(app.open().unwrap().numbers_beside(27), (0, 9));
}
