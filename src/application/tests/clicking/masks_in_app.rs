//! Masks by hand in the application, which get their frames.

use crate::bench::Bench;
use touchline_application::app::{
    Action, App, Command, EditAction, MaskList, MaskScope, Navigation, Tool,
};
use touchline_core::geometry::PixelBox;
use touchline_core::testing::{SIZE, pixel_box};
use touchline_documents::document::{Camera, Clip, Document, MaskSource, VideoFrame};
use touchline_documents::testing::{a_match, new_frame};

pub const BUG: PixelBox = pixel_box(60.0, 40.0, 300.0, 50.0);

/// Ten frames of a video, the last four another shot.
pub fn video() -> Document {
    let mut document = a_match(SIZE);
    for index in 0..10 {
        let mut frame = new_frame("", SIZE);
        frame.image = None;
        frame.video = Some(VideoFrame::new("match.mp4", 100 * index, None));
        frame.clip = Some(Clip::Number(i64::from(index >= 6)));
        document.frames.push(frame.into());
    }
    document
}

pub fn ranged_masks(app: &App) -> Vec<(Option<u64>, Option<u64>, MaskSource)> {
    let document = &app.open().unwrap().document;
    document.cameras[0]
        .ranged_masks
        .iter()
        .map(|mask| (mask.from, mask.to, mask.source))
        .collect()
}

#[test]
fn a_mask_by_hand_is_for_a_frame_a_shot_a_range_or_all() {
    let mut bench = Bench::new(video());
    let scope = |bench: &mut Bench, list, scope| {
        bench.act(Action::Edit(EditAction::ScopeMask {
            list,
            index: 0,
            scope,
        }));
    };
    bench.act(Action::Navigate(Navigation::GoTo(2)));
    bench.act(Action::Edit(EditAction::AddMask {
        of_camera: false,
        mask: BUG,
    }));
    scope(&mut bench, MaskList::Frame, MaskScope::Shot);
    assert_eq!(
        ranged_masks(&bench.app),
        [(Some(0), Some(500), MaskSource::ByHand)]
    );
    scope(&mut bench, MaskList::Ranged, MaskScope::FromHere);
    assert_eq!(
        ranged_masks(&bench.app),
        [(Some(200), Some(500), MaskSource::ByHand)]
    );
    bench.act(Action::Navigate(Navigation::GoTo(4)));
    scope(&mut bench, MaskList::Ranged, MaskScope::UpToHere);
    assert_eq!(
        ranged_masks(&bench.app),
        [(Some(200), Some(400), MaskSource::ByHand)]
    );
    let covered = |bench: &Bench| {
        let document = &bench.app.open().unwrap().document;
        document
            .frames
            .iter()
            .map(|frame| document.masks_of(frame).len())
            .collect::<Vec<_>>()
    };
    assert_eq!(covered(&bench), [0, 0, 1, 1, 1, 0, 0, 0, 0, 0]);
    scope(&mut bench, MaskList::Ranged, MaskScope::All);
    assert_eq!(covered(&bench), [1; 10]);
    assert_eq!(bench.app.open().unwrap().document.cameras[0].masks, [BUG]);
    scope(&mut bench, MaskList::Camera, MaskScope::Frame);
    assert_eq!(covered(&bench), [0, 0, 0, 0, 1, 0, 0, 0, 0, 0]);
    bench.command(Command::Undo);
    assert_eq!(covered(&bench), [1; 10], "each is one step");
}

#[test]
fn images_have_no_range_in_time_but_a_shot() {
    let mut document = video();
    for (index, frame) in document.frames.iter_mut().enumerate() {
        (frame.image, frame.video) = (Some(format!("{index}.jpg")), None);
    }
    let mut bench = Bench::new(document);
    bench.act(Action::Navigate(Navigation::GoTo(8)));
    bench.act(Action::Edit(EditAction::AddMask {
        of_camera: true,
        mask: BUG,
    }));
    assert!(bench.app.why_not_scope(MaskScope::FromHere).is_some());
    bench.act(Action::Edit(EditAction::ScopeMask {
        list: MaskList::Camera,
        index: 0,
        scope: MaskScope::FromHere,
    }));
    assert_eq!(
        bench.app.open().unwrap().document.cameras[0].masks,
        [BUG],
        "refused"
    );
    bench.act(Action::Edit(EditAction::ScopeMask {
        list: MaskList::Camera,
        index: 0,
        scope: MaskScope::Shot,
    }));
    let document = &bench.app.open().unwrap().document;
    let covered: Vec<usize> = document
        .frames
        .iter()
        .map(|frame| frame.masks.len())
        .collect();
    assert_eq!(covered, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1]);
    assert!(document.cameras[0].masks.is_empty());
}

#[test]
fn selected_frames_of_two_videos_or_cameras_get_the_mask_each_for_itself() {
    let mut two_cameras = video();
    two_cameras
        .cameras
        .push(Camera::new("side".into(), SIZE).into());
    two_cameras.frames[7].camera = "side".into();
    let mut two_videos = video();
    if let Some(video) = &mut two_videos.frames[7].video {
        video.path = "second_half.mp4".into();
    }
    for document in [two_cameras, two_videos] {
        let mut bench = Bench::new(document);
        bench.act(Action::Navigate(Navigation::GoTo(2)));
        bench.act(Action::Edit(EditAction::AddMask {
            of_camera: false,
            mask: BUG,
        }));
        bench.app.session.frames_selected = [2, 7].into();
        bench.act(Action::Edit(EditAction::ScopeMask {
            list: MaskList::Frame,
            index: 0,
            scope: MaskScope::Selected,
        }));
        let document = &bench.app.open().unwrap().document;
        let covered: Vec<usize> = document
            .frames
            .iter()
            .map(|frame| document.masks_of(frame).len())
            .collect();
        assert_eq!(covered, [0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    }
}

#[test]
fn escape_leaves_the_masks_and_enter_accepts_nothing_below_them() {
    let mut bench = Bench::new(touchline_application::testing::proposed::suggestions(&[
        Some(0.9),
        Some(0.9),
    ]));
    bench.command(Command::ShowMasks);
    bench.command(Command::Accept);
    bench.command(Command::AcceptAndStay);
    assert_eq!(bench.statuses(), "SS");
    assert_eq!(
        bench.last_notice(),
        "Masks are being drawn: Esc ends that first."
    );
    bench.command(Command::Cancel);
    assert_eq!(bench.app.session.picture.tool, Tool::Point);
    bench.command(Command::AcceptAndStay);
    assert_eq!(bench.statuses(), "RS");
}
