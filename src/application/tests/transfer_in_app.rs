//! Exports, datasets and imports in the application: looked at first, written on request, taken
//! over in one step.

use crate::headless::Headless;
use std::path::Path;
use touchline_application::app::selection::Selecting;
use touchline_application::app::transfer::{PreviewResult, TransferAction, TransferTab, in_dialog};
use touchline_application::app::{
    Action, Command, EditAction, Navigation, Question, Settings, ViewAction,
};
use touchline_core::camera::{Ptz, Radial};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::base_at;
use touchline_documents::document::{Camera, Click, Frame, FrameStatus, Frames, SolutionSource};
use touchline_documents::exchange::{DatasetOptions, Format, Gaps, Splitting};
use touchline_documents::testing::{match_from, new_frame, ptz_at, save, solved_by};

const SIZE: ImageSize = ImageSize::new(160, 90);

/// Four frames with pictures, the first two references with a click each, as a project.
fn open_project(folder: &Path) -> Headless {
    let mut document = match_from(&base_at([0.0, -60.0, 18.0], SIZE), SIZE);
    for index in 0..4_u8 {
        let name = format!("{index:04}.png");
        image::RgbImage::from_pixel(SIZE.width, SIZE.height, image::Rgb([60, 110 + index, 60]))
            .save(folder.join(&name))
            .unwrap();
        let mut frame = new_frame(&name, SIZE);
        if index < 2 {
            frame.status = FrameStatus::Reference;
            frame.ptz = ptz_at(f64::from(index) - 38.0, -13.0, 190.0);
            frame.solution = solved_by(SolutionSource::Clicks);
            frame.clicks = vec![Click::landmark(
                "centre_mark".into(),
                ImagePoint::new(80.0, 50.0),
            )];
        }
        document.frames.push(frame.into());
    }
    save(folder.join("project.json"), &document);
    let mut headless = Headless::new();
    headless.app = touchline_application::app::App::new(Settings {
        snap_points: false,
        ..Settings::default()
    });
    headless.act(Action::Open(folder.to_path_buf()));
    headless.wait_until("opening", |app| app.open().is_some());
    headless
}

fn act(headless: &mut Headless, action: TransferAction) {
    headless.act(Action::Transfer(action));
}

/// Whether a text names an option of the command line. That a place is taken is said in words of
/// the window's own.
fn names_option(text: &str) -> bool {
    let is_option = |rest: &str| rest.starts_with(|first: char| first.is_ascii_lowercase());
    !text.contains("--force") && text.split("--").skip(1).any(is_option)
}

/// The texts in double quotes of the sources below a folder that name an option of the command
/// line; their tests are left out.
fn texts_with_options(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(texts_with_options(&path));
            continue;
        }
        let source = std::fs::read_to_string(&path).unwrap();
        let source = source.split("#[cfg(test)]").next().unwrap_or_default();
        let lines = source
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"));
        let texts = lines.flat_map(|line| line.split('"').skip(1).step_by(2));
        found.extend(texts.filter(|text| names_option(text)).map(str::to_owned));
    }
    found
}

#[test]
fn every_option_that_an_export_or_import_speaks_of_has_words_in_the_dialog() {
    let texts =
        texts_with_options(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../documents/exchange"));
    assert!(texts.len() > 15, "{texts:?}");
    for text in texts {
        assert!(
            !names_option(&in_dialog(&text)),
            "{text:?} is {:?} in the dialog",
            in_dialog(&text)
        );
    }
}

fn wait_for_look(headless: &mut Headless) -> PreviewResult {
    headless.wait_until("looking", |app| app.operations.transfer.found.is_some());
    headless.app.operations.transfer.found.clone().unwrap().look
}

#[test]
fn an_export_is_shown_with_its_losses_before_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    headless.act(Action::Command(Command::Export));
    act(&mut headless, TransferAction::Format(Format::Wc14));
    let PreviewResult::Export(Ok(made)) = wait_for_look(&mut headless) else {
        panic!("an export was looked at")
    };
    assert_eq!(made.frames, 2);
    assert!(
        made.loss.as_ref().is_some_and(|loss| loss.off_ground > 0),
        "{:?}",
        made.loss
    );
    let out = folder.path().join("out");
    headless.answer(Question::ExportAs(Format::Wc14), &out);
    headless.wait_for_notice("writing", "2 frames written as wc14");
    assert!(out.join("0001.homographyMatrix").is_file());
    assert_eq!(headless.app.session.dialog, None);
    // A folder that holds something else gets a new one in it.
    headless.act(Action::Command(Command::Export));
    headless.answer(Question::ExportAs(Format::Wc14), folder.path());
    // What cannot be is said in one line, also where it was chosen while something was being
    // written.
    headless.act(Action::Command(Command::Export));
    act(&mut headless, TransferAction::Format(Format::FreeD));
    let mut options = headless.app.operations.transfer.export.clone();
    options.frames.statuses = vec![FrameStatus::Rejected];
    options.gaps = Gaps::Takes;
    act(&mut headless, TransferAction::Export(Box::new(options)));
    let PreviewResult::Export(Err(why)) = wait_for_look(&mut headless) else {
        panic!("no frame is rejected")
    };
    assert_eq!(
        why,
        "No frame to export as freed: no frame has the requested status, camera and confidence."
    );
    assert!(folder.path().join("wc14/0000.homographyMatrix").is_file());
}

#[test]
fn a_dataset_is_planned_written_and_can_be_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    headless.act(Action::Command(Command::ExportDataset));
    assert_eq!(headless.app.operations.transfer.tab, TransferTab::Dataset);
    let options = DatasetOptions {
        splitting: Some(Splitting::default()),
        undistorted: true,
        ..DatasetOptions::default()
    };
    act(&mut headless, TransferAction::Dataset(Box::new(options)));
    let PreviewResult::Dataset(Ok(plan)) = wait_for_look(&mut headless) else {
        panic!("a dataset was planned")
    };
    assert_eq!(
        (plan.frames.len(), plan.pictures(), plan.counts()),
        (2, 4, [2, 0, 0])
    );
    assert!(
        plan.notes
            .iter()
            .any(|note| note.contains("none is left for validation, test")),
        "{:?}",
        plan.notes
    );
    let out = folder.path().join("set");
    headless.answer(Question::DatasetTo, &out);
    headless.wait_for_notice("writing", "Dataset of 2 frames written");
    assert!(
        out.join("manifest.sha256").is_file()
            && out.join("undistorted/images/train/0001.png").is_file()
    );
    // Once more, stopped at once: nothing temporary stays.
    headless.act(Action::Command(Command::ExportDataset));
    headless.answer(Question::DatasetTo, &folder.path().join("other"));
    act(&mut headless, TransferAction::Stop);
    let transfer = &headless.app.operations.transfer;
    assert!(!transfer.is_looking() && transfer.writing().is_none());
    drop(headless);
    let left = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(
        left.filter(|name| name.contains(".tmp")).count() == 0,
        "nothing temporary is left"
    );
}

#[test]
fn labels_of_another_program_come_in_after_a_look_in_one_step_of_undo() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    let labelme = folder.path().join("labelme");
    std::fs::create_dir(&labelme).unwrap();
    for index in [0, 2] {
        let json = serde_json::json!({
            "version": "6.3.1", "flags": {}, "imagePath": format!("../{index:04}.png"), "imageData": null, "imageHeight": 90, "imageWidth": 160,
            "shapes": [
                { "label": "halfway_far", "points": [[70.0, 30.0]], "shape_type": "point" },
                { "label": "centre_mark", "points": [[81.0, 51.0]], "shape_type": "point" },
            ],
        });
        // Names without a folder: labelme writes beside the images.
        let json = json.to_string().replace("../", "");
        std::fs::write(labelme.join(format!("{index:04}.json")), json).unwrap();
    }
    headless.act(Action::Command(Command::Import));
    act(&mut headless, TransferAction::ImportFormat(Format::Labelme));
    let before = headless.app.open().unwrap().document.frames.clone();
    headless.answer(Question::ImportFrom(Format::Labelme), &labelme);
    let PreviewResult::Import(Ok(look)) = wait_for_look(&mut headless) else {
        panic!("{:?}", headless.app.operations.transfer.found);
    };
    let joined = &look.joined;
    assert_eq!(
        (joined.matched, joined.kept, joined.added, joined.clicks),
        (1, 1, 0, 2)
    );
    assert_eq!(
        headless.app.open().unwrap().document.frames,
        before,
        "a look changes nothing"
    );
    act(&mut headless, TransferAction::TakeOver);
    let frames = &headless.app.open().unwrap().document.frames;
    assert_eq!(
        (frames[2].clicks.len(), frames[2].status),
        (2, FrameStatus::Draft)
    );
    assert_eq!(frames[0], before[0], "a person's own label stays");
    let next = headless
        .app
        .open()
        .unwrap()
        .history
        .next_undo()
        .map(|step| step.name.clone());
    assert_eq!(next.as_deref(), Some("Import labels"));
    headless.act(Action::Command(Command::Undo));
    assert!(
        headless.app.open().unwrap().document.frames[2]
            .clicks
            .is_empty()
    );
}

#[test]
fn a_typed_path_replaces_no_file_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    let precious = folder.path().join("precious.csv");
    std::fs::write(&precious, "precious").unwrap();
    headless.act(Action::Command(Command::Export));
    act(&mut headless, TransferAction::Format(Format::Csv));
    headless.act(Action::View(ViewAction::TypePath(Question::ExportAs(
        Format::Csv,
    ))));
    headless.answer(Question::ExportAs(Format::Csv), &precious);
    headless.wait_for_notice("the refusal", "exists");
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "precious");
    // The user has confirmed the replacement in the file dialog.
    headless.act(Action::Command(Command::Export));
    headless.answer(Question::ExportAs(Format::Csv), &precious);
    headless.wait_for_notice("writing", "written as csv");
    assert_ne!(std::fs::read_to_string(&precious).unwrap(), "precious");
}

#[test]
fn undo_of_an_import_shows_a_frame_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    // Another project brings six frames of its own.
    let other = tempfile::tempdir().unwrap();
    let mut theirs = (*headless.app.open().unwrap().document).clone();
    let frame = |index: usize| new_frame(&format!("{index}-theirs.png"), SIZE);
    theirs.frames = (0..6).map(|index| frame(index).into()).collect();
    for frame in &mut theirs.frames {
        frame.clicks = vec![Click::landmark(
            "centre_mark".into(),
            ImagePoint::new(80.0, 50.0),
        )];
        frame.status = FrameStatus::Draft;
    }
    save(other.path().join("project.json"), &theirs);
    headless.act(Action::Command(Command::Import));
    act(&mut headless, TransferAction::ImportFormat(Format::Json));
    headless.answer(
        Question::ImportFrom(Format::Json),
        &other.path().join("project.json"),
    );
    let PreviewResult::Import(Ok(look)) = wait_for_look(&mut headless) else {
        panic!("{:?}", headless.app.operations.transfer.found)
    };
    assert_eq!(look.joined.added, 6);
    act(&mut headless, TransferAction::TakeOver);
    for frame in [9, 1] {
        headless.act(Action::Navigate(Navigation::SelectFrame {
            frame,
            how: Selecting::Toggle,
        }));
    }
    headless.act(Action::Navigate(Navigation::GoTo(9)));
    headless.act(Action::Command(Command::Undo));
    assert_eq!(headless.app.open().unwrap().document.frames.len(), 4);
    assert_eq!(
        (headless.app.session.frame, headless.app.frame().is_some()),
        (3, true)
    );
    assert!(
        headless
            .app
            .session
            .frames_selected
            .iter()
            .all(|frame| *frame < 4)
    );
}

/// Imports a document in which this number of frames has a camera of another program.
fn import_cameras(headless: &mut Headless, folder: &Path, cameras: usize) {
    let mut theirs = (*headless.app.open().unwrap().document).clone();
    let base = base_at([1.0, -62.0, 17.0], SIZE);
    theirs.cameras.clear();
    theirs.frames = (0..cameras)
        .map(|index| {
            let mut camera = Camera::new(format!("theirs-{index}").as_str().into(), SIZE);
            camera.set_base(&base);
            let name = format!("{index}-theirs.png");
            let mut frame = Frame::from_image(&name, camera.id.clone(), SIZE);
            frame.point(Ptz::from_degrees(2.0, -12.0, 150.0), Radial::default());
            frame.status = FrameStatus::Suggested;
            frame.solution = solved_by(SolutionSource::Import);
            theirs.cameras.push(camera.into());
            frame.into()
        })
        .collect();
    let file = folder.join("theirs.json");
    save(&file, &theirs);
    headless.act(Action::Command(Command::Import));
    act(headless, TransferAction::ImportFormat(Format::Json));
    headless.answer(Question::ImportFrom(Format::Json), &file);
    assert!(matches!(
        wait_for_look(headless),
        PreviewResult::Import(Ok(_))
    ));
    act(headless, TransferAction::TakeOver);
}

#[test]
fn imported_cameras_can_be_mended_at_once_where_there_are_enough() {
    for (cameras, can_be_mended) in [(2, false), (3, cfg!(feature = "opencv"))] {
        let folder = tempfile::tempdir().unwrap();
        let mut headless = open_project(folder.path());
        let other = tempfile::tempdir().unwrap();
        import_cameras(&mut headless, other.path(), cameras);
        assert_eq!(
            headless.app.session.offers(Command::MendCameras),
            can_be_mended,
            "{cameras}"
        );
    }
}

#[test]
fn an_import_that_was_looked_at_before_a_change_is_joined_with_the_change() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    let labels = folder.path().join("labels.json");
    let mut document = (*headless.app.open().unwrap().document).clone();
    document.frames[2].clicks = vec![Click::landmark(
        "halfway_far".into(),
        ImagePoint::new(70.0, 30.0),
    )];
    document.frames[2].status = FrameStatus::Draft;
    save(&labels, &document);
    headless.act(Action::Command(Command::Import));
    act(&mut headless, TransferAction::ImportFormat(Format::Json));
    headless.answer(Question::ImportFrom(Format::Json), &labels);
    // The document changes while the background looks, before it reports.
    headless.act(Action::Edit(EditAction::SetComment("meanwhile".to_owned())));
    let changed = headless.app.open().unwrap().document.frames.clone();
    assert!(
        changed
            .iter()
            .any(|frame| frame.comment.as_deref() == Some("meanwhile"))
    );
    assert!(matches!(
        wait_for_look(&mut headless),
        PreviewResult::Import(Ok(_))
    ));
    act(&mut headless, TransferAction::TakeOver);
    let now = headless.app.open().unwrap().document.frames.clone();
    let others = |frames: &Frames| [0, 1, 3].map(|index| frames[index].clone());
    assert_eq!(
        others(&now),
        others(&changed),
        "the change is not taken back"
    );
    assert_eq!(now[2].clicks, document.frames[2].clicks);
}

#[test]
fn another_picture_in_place_of_a_labelled_one_is_named_on_its_frame() {
    let folder = tempfile::tempdir().unwrap();
    let headless = open_project(folder.path());
    let mut document = (*headless.app.open().unwrap().document).clone();
    for frame in &mut document.frames {
        frame.sha256 =
            touchline_vision::media::sha256_of_file(&frame.image_path(folder.path()).unwrap()).ok();
    }
    drop(headless);
    save(folder.path().join("project.json"), &document);
    image::RgbImage::from_pixel(SIZE.width, SIZE.height, image::Rgb([9, 9, 9]))
        .save(folder.path().join("0001.png"))
        .unwrap();
    let mut headless = Headless::open(folder.path());
    headless.wait_until("comparing", |app| app.other_picture(1).is_some());
    assert!(
        headless
            .app
            .other_picture(1)
            .unwrap()
            .starts_with("the image changed since it was labelled")
    );
    headless.wait_until("the notice", |app| {
        app.session.messages.notices.iter().any(|notice| {
            notice.text == "The picture of 0001.png is not the one that was labelled."
        })
    });
    assert_eq!(
        [0, 2, 3].map(|index| headless.app.other_picture(index)),
        [None; 3]
    );
}

#[test]
fn labels_wait_for_their_pictures_and_are_then_shown_in_the_dialog() {
    let folder = tempfile::tempdir().unwrap();
    let mut headless = open_project(folder.path());
    let cameras = tempfile::tempdir().unwrap();
    let to = cameras.path().join("cameras");
    headless.act(Action::Command(Command::Export));
    headless.answer(Question::ExportAs(Format::SoccerNet), &to);
    headless.wait_until("writing", |_| to.exists());
    drop(headless);

    // Nothing is open: the labels wait, and Escape leaves them.
    let mut headless = Headless::new();
    for _ in 0..2 {
        headless.act(Action::OpenAny(vec![to.clone()]));
        headless.wait_until("sorting", |app| app.waiting_labels().is_some());
        headless.act(Action::Command(Command::Cancel));
        assert!(headless.app.waiting_labels().is_none());
    }
    // With their pictures they are looked at as soon as those are open, and once more later.
    for paths in [vec![to.clone(), folder.path().to_path_buf()], vec![to]] {
        headless.act(Action::OpenAny(paths));
        let PreviewResult::Import(Ok(look)) = wait_for_look(&mut headless) else {
            panic!("{:?}", headless.app.operations.transfer.found)
        };
        assert_eq!(look.format, Format::SoccerNet);
        assert_eq!(headless.app.operations.transfer.tab, TransferTab::Import);
        assert_eq!((look.joined.kept, look.joined.added), (2, 0));
        headless.act(Action::View(ViewAction::CloseDialog));
        headless.app.operations.transfer.found = None;
    }
}
