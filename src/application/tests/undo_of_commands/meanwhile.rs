//! What a person does while work goes on in the background stays when its result comes.

use super::documents::{demo, displaced, film, imported, turned, unseen, video};
use super::scene::{Known, Scene};
use super::table::label_film;
use crate::find_camera_in_app::{found_camera, unknown};
use touchline_application::app::operations::{
    BaseRefinement, CameraSearch, ClipTracking, FoundShots, FrameSnap, Mending, ShotSearch,
};
use touchline_application::app::selection::Scope;
use touchline_application::app::{
    Action, CameraChoice, Command, EditAction, Navigation, PointerAction,
};
use touchline_application::testing::base;
use touchline_calibration::autocalibrate::AutocalibrationAnswer;
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::pixel_box;
use touchline_documents::document::{Camera, Document, Frame, RejectReason, ShotKind};

/// Work that changes the document: the document, the command, and its result, which is the same
/// whatever a person edits meanwhile.
struct Work {
    command: Command,
    document: fn() -> Document,
    end: fn(&mut Scene, &mut Known),
}

const WORK: [Work; 8] = [
    Work {
        command: Command::Track,
        document: || few(demo()),
        end: Scene::end::<ClipTracking>,
    },
    Work {
        command: Command::RefineBaseOnShot,
        document: || few(displaced()),
        end: Scene::end::<BaseRefinement>,
    },
    Work {
        command: Command::MendCameras,
        document: || few(imported()),
        end: Scene::end::<Mending>,
    },
    Work {
        command: Command::Snap,
        document: || few(turned(0.3)),
        end: Scene::end::<FrameSnap>,
    },
    Work {
        command: Command::SearchLines,
        document: || few(unseen()),
        end: Scene::end::<FrameSnap>,
    },
    Work {
        command: Command::FindCamera,
        document: || unknown(5),
        end: |scene, _| {
            let found = found_camera(5, 0.0).into();
            scene.report::<CameraSearch>(AutocalibrationAnswer::Found(found));
        },
    },
    Work {
        command: Command::FindCameras,
        document: film,
        end: |scene, _| label_film(scene),
    },
    Work {
        command: Command::FindShots,
        document: video,
        end: |scene, _| {
            let cuts = vec![(5, ShotKind::Cut), (15, ShotKind::Cut)];
            scene.report::<ShotSearch>(FoundShots { last: 29, cuts });
        },
    },
];

/// The first frames of a document.
fn few(mut document: Document) -> Document {
    while document.frames.len() > 6 {
        document.frames.pop();
    }
    document
}

/// What a person does in a frame or beside it.
#[derive(Clone, Copy, Debug)]
enum Edit {
    Comment,
    Reject,
    Click,
    Mask,
    Assign,
    MoveBase,
    ChangeField,
    Cut,
}

const EDITS: [Edit; 8] = [
    Edit::Comment,
    Edit::Reject,
    Edit::Click,
    Edit::Mask,
    Edit::Assign,
    Edit::MoveBase,
    Edit::ChangeField,
    Edit::Cut,
];

impl Edit {
    fn make(self, scene: &mut Scene, at: usize) {
        scene.act(Action::Navigate(Navigation::GoTo(at)));
        let open = scene.window.app.open().unwrap();
        let frame = open.document.frames[at].clone();
        match self {
            Self::Comment => scene.edit(EditAction::SetComment("rain".to_owned())),
            Self::Reject => {
                scene.command(Command::Reject);
                scene.edit(EditAction::RejectAs(RejectReason::Blur));
            }
            Self::Click => {
                scene.pick("centre_mark");
                let at = ImagePoint::new(30.0, 30.0);
                scene.act(Action::Pointer(PointerAction::Press { at, on: None }));
                scene.act(Action::Pointer(PointerAction::Release));
            }
            Self::Mask => {
                let mask = pixel_box(2.0, 2.0, 20.0, 20.0);
                let of_camera = false;
                scene.edit(EditAction::AddMask { of_camera, mask });
            }
            Self::Assign => scene.edit(EditAction::AssignToCamera {
                scope: Scope::Frame,
                camera: CameraChoice::New("side".into()),
            }),
            Self::MoveBase => {
                let mut camera = Camera::clone(open.document.camera(&frame.camera).unwrap());
                let mut base = camera.base().unwrap_or_else(base);
                base.position_m.z += 1.5;
                camera.set_base(&base);
                scene.edit(EditAction::Camera(Box::new(camera)));
            }
            Self::ChangeField => {
                let mut field = open.document.field.clone();
                field.params.insert("length_m".to_owned(), 101.0);
                scene.edit(EditAction::Field(field));
            }
            Self::Cut => scene.command(Command::AddCut),
        }
    }

    /// What must stay of it, as text.
    fn kept(self, document: &Document, at: usize) -> String {
        let frame: &Frame = &document.frames[at];
        let base = document.camera(&frame.camera).and_then(Camera::base);
        match self {
            Self::Comment => format!("{:?}", frame.comment),
            Self::Reject => format!("{:?}", (frame.status, frame.reason)),
            Self::Click => format!("{:?}", frame.clicks),
            Self::Mask => format!("{:?}", frame.masks),
            Self::Assign | Self::MoveBase => format!("{:?}", (base, &frame.ptz)),
            Self::ChangeField => format!("{:?}", document.field),
            Self::Cut => {
                let is_cut = at == 0 || frame.clip != document.frames[at - 1].clip;
                format!("{is_cut}")
            }
        }
    }
}

impl Scene {
    fn document(&self) -> Document {
        (*self.window.app.open().unwrap().document).clone()
    }
}

#[test]
fn an_edit_made_while_work_goes_on_stays() {
    let mut failed = Vec::new();
    for work in WORK {
        // A frame that the result changes, if nobody does anything.
        let mut known = None;
        let mut scene = Scene::open(&(work.document)(), true);
        let before = scene.document();
        scene.command(work.command);
        (work.end)(&mut scene, &mut known);
        let after = scene.document();
        let changed = after.frames.differences(&before.frames);
        let Some(&at) = changed.last() else {
            failed.push(format!(
                "{:?} changes nothing: {:?}",
                work.command,
                scene.last_notice()
            ));
            continue;
        };
        for edit in EDITS {
            let mut scene = Scene::open(&(work.document)(), true);
            scene.command(work.command);
            edit.make(&mut scene, at);
            let kept = edit.kept(&scene.document(), at);
            (work.end)(&mut scene, &mut known);
            let now = edit.kept(&scene.document(), at);
            if now != kept {
                failed.push(format!(
                    "{:?} during {:?}: {kept:?}, then {now:?}",
                    edit, work.command
                ));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
