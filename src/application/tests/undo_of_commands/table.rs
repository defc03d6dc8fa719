//! What each command does to a document. A new command does not compile without its line here.

use super::documents::{
    blank, demo, displaced, drafts, film, imported, labelled_film, pointed, suggested, turned,
    two_roots, unseen, video,
};
use super::scene::Scene;
use crate::burnt_in_in_app::found_mask;
use crate::clicking::names_in_app;
use crate::find_camera_in_app::{found_camera, unknown};
use crate::which_camera;
use touchline_application::app::operations::{
    BurntInSearch, CameraSearch, ClipTracking, FoundShots, LabelledDocument, MatchLabelling,
    ShotSearch,
};
use touchline_application::app::selection::Scope;
use touchline_application::app::transfer::TransferAction;
use touchline_application::app::{
    Action, CameraChoice, Command, EditAction, Navigation, PointerAction, Question, ViewAction,
};
use touchline_calibration::autocalibrate::AutocalibrationAnswer;
use touchline_calibration::calibrate::{LengthOnLines, TrackedClip};
use touchline_calibration::pipelines::{LabelledMatch, MatchLabels};
use touchline_core::camera::SizeError;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::solve::base::FittedSize;
use touchline_core::testing::seeded::rng;
use touchline_documents::document::{
    ClickNoise, Clip, Document, Extra, Frame, RejectReason, Repeat, ShotKind, Target,
};
use touchline_documents::exchange::Format;
use touchline_documents::testing::save;

/// What a command does to a document.
pub enum Plan {
    /// Nothing.
    Keeps,
    /// One step of undo.
    Changes(Change),
}

/// A command that changes the document, and what a user does with it.
pub struct Change {
    /// The document on which it is done.
    pub document: fn() -> Document,
    /// Whether work in the background is held back: no command waits for it, or the test gives its
    /// result.
    pub holds: bool,
    /// What is done before it.
    pub prepare: fn(&mut Scene),
    /// The command, and the answers to what it asks.
    pub make: fn(&mut Scene),
}

fn change(document: fn() -> Document, prepare: fn(&mut Scene), make: fn(&mut Scene)) -> Plan {
    Plan::Changes(Change {
        document,
        holds: true,
        prepare,
        make,
    })
}

/// The same for a command that waits for work in the background, which takes its time.
fn works(document: fn() -> Document, prepare: fn(&mut Scene), make: fn(&mut Scene)) -> Plan {
    Plan::Changes(Change {
        document,
        holds: false,
        prepare,
        make,
    })
}

fn nothing(_: &mut Scene) {}

fn go_to(scene: &mut Scene, frame: usize) {
    scene.act(Action::Navigate(Navigation::GoTo(frame)));
}

/// The first frames of a document, played and paused.
fn play(scene: &mut Scene) {
    scene.command(Command::PlayPause);
    for frame in 1..4 {
        scene.act(Action::View(ViewAction::PlayTo(frame)));
    }
    scene.command(Command::PlayPause);
}

fn track(scene: &mut Scene) {
    scene.command(Command::Track);
    scene.wait_for_work();
}

fn estimate(scene: &mut Scene) {
    scene.command(Command::EstimateBase);
    scene.wait_until("the base", |app| app.operations.proposed_base().is_some());
}

/// The search for the cameras of a video ends.
pub fn label_film(scene: &mut Scene) {
    let labels = MatchLabels::Labelled(LabelledMatch {
        cameras: Vec::new(),
        answered: 30,
        unanswered: 0,
        is_stopped: false,
    });
    scene.report::<MatchLabelling>(LabelledDocument {
        document: labelled_film(),
        labels,
    });
}

/// The lines of a tracked clip show another length than the assumed one.
fn measure_length(scene: &mut Scene) {
    let base = scene.window.app.open().unwrap().document.cameras[0].base();
    let length = LengthOnLines {
        size: FittedSize {
            name: "length_m".to_owned(),
            assumed_m: 105.0,
            value_m: 102.0,
            error: SizeError::alone(0.3),
            is_open: false,
        },
        shifts: vec![("main".into(), Vec3::new(1.5, 0.0, 0.0))],
        frames: 4,
        is_prescribed: false,
    };
    let tracked = TrackedClip {
        base: base.unwrap(),
        frames: Vec::new(),
        references: Vec::new(),
        missed: Vec::new(),
        unreadable: None,
        kept: 0,
        stops: Vec::new(),
        sigma_px: 0.3,
        inflation: 1.0,
        painted: 4,
        lengths: vec![length],
        jitter: None,
        raw_jitter: None,
    };
    scene.command(Command::Track);
    scene.report::<ClipTracking>(tracked.into());
}

fn find_burnt_in(scene: &mut Scene) {
    scene.report::<BurntInSearch>(vec![found_mask(None, None)]);
}

/// A reference of which one point is named wrongly.
fn doubtful() -> Document {
    let mut document = drafts();
    let click = &mut document.frames[0].clicks[0];
    click.image = click.image.translate(Vec2::new(90.0, 40.0));
    document
}

fn with_unnamed() -> Document {
    let mut document = drafts();
    document.frames[0].clicks[0].target = None;
    document
}

/// References that were clicked again, half a pixel off.
fn clicked_again() -> Document {
    let mut document = demo();
    for frame in &mut document.frames {
        let frame: &mut Frame = frame;
        for (number, click) in frame.clicks.iter().enumerate() {
            let Some(Target::Landmark(landmark)) = &click.target else {
                continue;
            };
            let off = if number % 2 == 0 { 0.5 } else { -0.4 };
            let at = click.image.translate(Vec2::new(off, 0.3));
            let repeat = Repeat::new(landmark.clone(), at, 1);
            frame.repeats.push(repeat);
        }
        frame.gold = !frame.repeats.is_empty();
    }
    document
}

fn with_own_noise() -> Document {
    let mut document = clicked_again();
    let noise = ClickNoise {
        in_use: true,
        factor: 0.7,
        factor_by_landmark: std::collections::BTreeMap::new(),
        sigma_px: 0.6,
        sigma_interval_95_px: [0.5, 0.8],
        repeats: 30,
        extra: Extra::new(),
    };
    document.set_click_noise(&noise).unwrap();
    document
}

fn swapped() -> Document {
    let mut document = names_in_app::project();
    document.frames.push(names_in_app::swapped_frame().into());
    document
}

fn bumped() -> Document {
    which_camera::document(24, 12, 2.0, &mut rng("undo of a new camera"))
}

/// Every frame belongs to one shot and has a camera that is suggested.
fn in_one_shot() -> Document {
    let mut document = suggested();
    for frame in &mut document.frames {
        frame.clip = Some(Clip::Number(1));
    }
    document
}

/// The demo match as it was before its last three pictures came.
fn without_last() -> Document {
    let mut document = demo();
    for _ in 0..3 {
        document.frames.pop();
    }
    document
}

fn of_five() -> Document {
    unknown(5)
}

/// Writes another document beside the project and names it in answer to a question.
fn answer(scene: &mut Scene, question: Question, document: &Document) {
    let file = scene.folder.path().join("other.json");
    save(&file, document);
    scene.act(Action::Answer(question, file));
}

/// What a command does.
pub fn plan(command: Command) -> Plan {
    use Command as C;
    match command {
        // Points.
        C::DeleteClick => change(demo, |scene| scene.select(0), |scene| scene.command(C::DeleteClick)),
        C::RenameClick => change(
            demo,
            |scene| scene.select(0),
            |scene| {
                scene.command(C::RenameClick);
                scene.pick("corner_near_right");
            },
        ),
        C::NameNext => change(with_unnamed, nothing, |scene| {
            scene.command(C::NameNext);
            scene.pick("goal_area_far_right_goal_line");
        }),
        C::ToggleCheck => change(demo, |scene| scene.select(0), |scene| scene.command(C::ToggleCheck)),
        C::MendNames => change(swapped, nothing, |scene| scene.command(C::MendNames)),
        // Decisions.
        C::Accept => change(drafts, nothing, |scene| scene.command(C::Accept)),
        C::AcceptAndStay => change(drafts, nothing, |scene| scene.command(C::AcceptAndStay)),
        C::AcceptAnyway => change(
            doubtful,
            |scene| scene.command(C::AcceptAndStay),
            |scene| scene.command(C::AcceptAnyway),
        ),
        C::AcceptAllAbove => change(suggested, nothing, |scene| {
            scene.command(C::AcceptAllAbove);
            scene.edit(EditAction::AcceptAll);
        }),
        C::AcceptPlayed => change(suggested, play, |scene| scene.command(C::AcceptPlayed)),
        C::StopAtWrong => change(suggested, play, |scene| scene.command(C::StopAtWrong)),
        C::AcceptStretch => works(
            in_one_shot,
            |scene| {
                let frames = 0..scene.frames();
                scene.wait_until("the line checks", |app| {
                    frames.clone().all(|frame| app.paint_says(frame).is_some())
                });
                scene.command(C::SelectShot);
            },
            |scene| {
                scene.command(C::AcceptStretch);
                scene.edit(EditAction::AcceptAll);
            },
        ),
        C::AcceptShot => works(
            in_one_shot,
            |scene| {
                let frames = 0..scene.frames();
                scene.wait_until("the line checks", |app| {
                    frames.clone().all(|frame| app.paint_says(frame).is_some())
                });
            },
            |scene| {
                scene.command(C::AcceptShot);
                scene.edit(EditAction::AcceptAll);
            },
        ),
        C::Reject => change(suggested, nothing, |scene| {
            scene.command(C::Reject);
            scene.edit(EditAction::RejectAs(RejectReason::Blur));
        }),
        C::RejectShot => change(suggested, nothing, |scene| {
            scene.command(C::RejectShot);
            scene.edit(EditAction::RejectAs(RejectReason::Replay));
        }),
        C::Comment => change(suggested, nothing, |scene| {
            scene.command(C::Comment);
            scene.edit(EditAction::SetComment("rain".to_owned()));
        }),
        C::UseForTraining => change(demo, nothing, |scene| scene.command(C::UseForTraining)),
        C::UseForBase => change(demo, nothing, |scene| scene.command(C::UseForBase)),
        C::MarkGold => change(demo, nothing, |scene| scene.command(C::MarkGold)),
        C::ChooseGold => change(demo, nothing, |scene| scene.command(C::ChooseGold)),
        C::ClickAgain => change(
            demo,
            |scene| scene.command(C::ChooseGold),
            |scene| {
                scene.command(C::ClickAgain);
                let at = ImagePoint::new(500.0, 400.0);
                scene.act(Action::Pointer(PointerAction::Press { at, on: None }));
                scene.act(Action::Pointer(PointerAction::Release));
                scene.command(C::Cancel);
            },
        ),
        C::UseOwnNoise => change(clicked_again, nothing, |scene| scene.command(C::UseOwnNoise)),
        C::UseUsualNoise => change(with_own_noise, nothing, |scene| scene.command(C::UseUsualNoise)),
        // Suggestions.
        C::Snap => works(|| turned(0.3), nothing, |scene| {
            scene.command(C::Snap);
            scene.wait_for_work();
        }),
        C::SearchLines => works(unseen, nothing, |scene| {
            scene.command(C::SearchLines);
            scene.wait_for_work();
        }),
        C::Track => works(demo, nothing, track),
        C::DiscardTracked => works(demo, track, |scene| scene.command(C::DiscardTracked)),
        C::DiscardBatch => change(suggested, nothing, |scene| scene.command(C::DiscardBatch)),
        C::RemoveModelPoints => {
            change(pointed, nothing, |scene| scene.command(C::RemoveModelPoints))
        }
        C::RefineBaseOnShot => works(displaced, nothing, |scene| {
            scene.command(C::RefineBaseOnShot);
            scene.wait_for_work();
        }),
        C::MendCameras => works(imported, nothing, |scene| {
            scene.command(C::MendCameras);
            scene.wait_for_work();
        }),
        C::SwitchRoot => change(two_roots, nothing, |scene| scene.command(C::SwitchRoot)),
        C::TakeLength => change(demo, measure_length, |scene| scene.command(C::TakeLength)),
        // Cameras and field.
        C::FindCamera => change(of_five, nothing, |scene| {
            scene.command(C::FindCamera);
            let found = found_camera(5, 0.0).into();
            scene.report::<CameraSearch>(AutocalibrationAnswer::Found(found));
        }),
        C::FindCameras => change(film, nothing, |scene| {
            scene.command(C::FindCameras);
            label_film(scene);
        }),
        C::UseEstimatedBase => works(displaced, estimate, |scene| scene.command(C::UseEstimatedBase)),
        C::LoadCamera => works(blank, nothing, |scene| {
            scene.command(C::LoadCamera);
            answer(scene, Question::CameraFrom, &demo());
            scene.wait_until("the camera", |app| {
                app.open().unwrap().document.cameras[0].base().is_some()
            });
        }),
        C::AssignToCamera => change(suggested, nothing, |scene| {
            scene.command(C::AssignToCamera);
            scene.edit(EditAction::AssignToCamera {
                scope: Scope::Onwards,
                camera: CameraChoice::New("side".into()),
            });
        }),
        C::NewCameraFromChange => works(
            bumped,
            |scene| {
                scene.wait_until("the change", |app| app.camera_change().is_some());
            },
            |scene| scene.command(C::NewCameraFromChange),
        ),
        C::KeepBurntIn => change(video, find_burnt_in, |scene| scene.command(C::KeepBurntIn)),
        C::ChangeBurntIn => change(video, find_burnt_in, |scene| scene.command(C::ChangeBurntIn)),
        C::ConfirmFieldSize => change(demo, nothing, |scene| scene.command(C::ConfirmFieldSize)),
        C::ChooseSport => change(blank, nothing, |scene| {
            scene.command(C::ChooseSport);
            scene.edit(EditAction::ChooseSport("futsal".to_owned()));
        }),
        // Shots.
        C::FindShots => change(video, nothing, |scene| {
            scene.command(C::FindShots);
            let cuts = vec![(5, ShotKind::Cut), (15, ShotKind::Cut)];
            scene.report::<ShotSearch>(FoundShots { last: 29, cuts });
        }),
        C::ShotContent => change(video, nothing, |scene| scene.command(C::ShotContent)),
        C::AddCut => change(video, |scene| go_to(scene, 15), |scene| scene.command(C::AddCut)),
        C::MoveCutHere => change(video, |scene| go_to(scene, 12), |scene| scene.command(C::MoveCutHere)),
        C::RemoveCut => change(video, |scene| go_to(scene, 12), |scene| scene.command(C::RemoveCut)),
        // Files.
        C::Import => works(blank, nothing, |scene| {
            scene.command(C::Import);
            scene.act(Action::Transfer(TransferAction::ImportFormat(Format::Json)));
            answer(scene, Question::ImportFrom(Format::Json), &imported());
            scene.wait_until("looking", |app| app.operations.transfer.found.is_some());
            scene.act(Action::Transfer(TransferAction::TakeOver));
        }),
        C::AddNewImages => works(
            without_last,
            |scene| {
                scene.wait_until("the folder", |app| {
                    app.why_not(C::AddNewImages).is_none()
                });
            },
            |scene| scene.command(C::AddNewImages),
        ),
        C::OpenProject
        | C::OpenFolder
        | C::OpenVideo
        | C::OpenQueue
        | C::NextMatch
        | C::PreviousMatch
        | C::QueuePanel
        | C::OpenDemo
        | C::Save
        | C::SaveAs
        | C::Export
        | C::ExportDataset
        | C::StopExport
        | C::ShowExported
        | C::Orphans
        | C::Quit
        // They change what other commands have changed.
        | C::Undo
        | C::Redo
        | C::PointTool
        | C::SelectTool
        | C::LineTool
        | C::CheckTool
        | C::ShowMasks
        | C::PlaceOnLine
        | C::NextClick
        | C::PreviousClick
        | C::Cancel
        | C::NextFrame
        | C::PreviousFrame
        | C::NextTenFrames
        | C::PreviousTenFrames
        | C::NextNeedsMe
        | C::PreviousNeedsMe
        | C::NextUnanswered
        | C::FirstFrame
        | C::LastFrame
        | C::GoToPlace
        | C::PlayPause
        | C::NextShot
        | C::PreviousShot
        | C::StopShotSearch
        | C::NextReference
        | C::PreviousReference
        | C::SkipAgain
        | C::CompareAnnotators
        | C::StopTracking
        | C::StopMending
        | C::ShowForBase
        | C::StopSearch
        | C::SnapPoints
        | C::SnapSuggestions
        | C::ZoomIn
        | C::ZoomOut
        | C::ZoomToFit
        | C::ZoomToClick
        | C::HideOverlay
        | C::OverlayStyle
        | C::ShowFieldMap
        | C::ShowCurves
        | C::Compare
        | C::Uncertainty
        | C::CameraPanel
        | C::TrainerPanel
        | C::PauseTrainer
        | C::ShowFeatures
        | C::ReviewPanel
        | C::Gallery
        | C::QualityPage
        | C::StopFindCamera
        | C::StopFindCameras
        // Their result waits for “Use the estimated base”.
        | C::EstimateBase
        | C::FitFieldSize
        | C::BaseOnPaint
        | C::DropEstimatedBase
        | C::StopSolving
        | C::SelectShot
        | C::PictureLook
        | C::Preferences
        | C::Guide
        | C::StartTour
        | C::LeaveTour
        | C::Palette
        | C::Keys
        | C::Messages
        | C::DismissNotices
        | C::About => Plan::Keeps,
    }
}
