//! The interface's own time for one frame of the window, without drawing it: every panel laid out
//! and turned into shapes, with 5,000 frames in the list or as many as `TOUCHLINE_FRAMES` says.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

use divan::{Bencher, black_box};
use egui::{Context, Event, Key, Modifiers, Pos2, RawInput, Rect, vec2};
use std::sync::Arc;
#[cfg(feature = "opencv")]
use std::time::Duration;
#[cfg(feature = "opencv")]
use touchline::app::TrainerOrder;
use touchline::app::{Action, App, Command, Navigation, Opened, Settings, TrainerReport};
use touchline::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
use touchline::document::{
    Camera, Click, Clip, Document, FieldSpec, Frame, FramePtz, FrameStatus, VideoFrame,
};
use touchline::field::builtin;
use touchline::geometry::{ImageSize, Mat3, Vec3};
#[cfg(feature = "opencv")]
use touchline::jobs::{SharedPictures, Trainer, TrainerOptions};
use touchline::proposals::{Answer, FrameRequest, Proposal, Timings};
use touchline::relocalize::NotFound;
use touchline::ui::{Panel, Pictures, apply_theme, read, show};

const SHOT: usize = 250;
/// So many proposals are reported together at most.
const BATCH: usize = 64;
const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn main() {
    divan::main();
}

/// How many frames the list has; `TOUCHLINE_FRAMES=300000` is a match at 50 frames a second.
fn frame_count() -> usize {
    std::env::var("TOUCHLINE_FRAMES").map_or(5_000, |frames| frames.parse().unwrap())
}

/// A match of shots; every frame has six points and a camera.
fn document(frames: usize) -> Document {
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let base = CameraBase::new(
        Vec3::new(1.5, -66.0, 18.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(&base);
    document.cameras.push(camera.into());
    for index in 0..frames {
        let ptz = Ptz::from_degrees(-20.0 + 40.0 * index as f64 / frames as f64, -13.0, 1900.0);
        let pointed = PtzCamera::new(base, ptz);
        let mut frame = Frame::from_image(&format!("images/{index:06}.jpg"), "main".into(), SIZE);
        frame.clip = Some(Clip::Number((index / SHOT) as i64));
        frame.status = if index % 3 == 0 {
            FrameStatus::Reference
        } else {
            FrameStatus::Draft
        };
        frame.clicks = field
            .landmarks
            .iter()
            .filter_map(|landmark| {
                let image = pointed
                    .image_from_world(field.landmark_in_world(landmark))
                    .ok()?;
                SIZE.contains(image)
                    .then(|| Click::landmark(landmark.id.clone(), image))
            })
            .take(6)
            .collect();
        frame.ptz = Some(FramePtz::new(ptz, None));
        document.frames.push(frame.into());
    }
    document
}

/// The same frames as those of one video.
fn of_video(mut document: Document) -> Document {
    for (index, frame) in (0_u64..).zip(&mut document.frames) {
        frame.image = None;
        frame.video = Some(VideoFrame::new(
            "match.mp4",
            index,
            Some(index as f64 / 50.0),
        ));
    }
    document
}

/// A window without a screen.
struct Window {
    app: App,
    pictures: Pictures,
    ctx: Context,
    time: f64,
}

impl Window {
    fn open() -> Self {
        Self::on(document(frame_count()))
    }

    /// Looking through suggestions of all frames of a match, with the list as it is by default.
    fn review() -> Self {
        let mut document = document(frame_count());
        let twice = document.frames.clone();
        document.frames.extend(twice.iter().cloned());
        for frame in &mut document.frames {
            frame.clicks.clear();
            (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        }
        let mut window = Self::on(document);
        let all: Vec<usize> = (0..2 * frame_count()).collect();
        let proposals = window.proposals(&all, 1);
        window
            .app
            .update(Action::Trainer(TrainerReport::Proposals(proposals)));
        window.app.update(Action::Command(Command::ReviewPanel));
        window.frame(Vec::new());
        assert!(window.app.review().rows.len() > 2 * frame_count() * 9 / 10);
        window
    }

    /// What a forest says of some frames: one of 50 has no answer.
    fn proposals(&self, frames: &[usize], generation: u64) -> Vec<Proposal> {
        let document = &self.app.open().unwrap().document;
        let propose = |&frame: &usize| {
            // A number that jumps about, so that the list has to be sorted.
            let chance = (frame * 7919 + generation as usize * 104_729) % 1000;
            let answer = Answer {
                ptz: FramePtz::new(
                    Ptz::from_degrees(-20.0 + 0.004 * frame as f64, -13.0, 1900.0),
                    None,
                ),
                covariance: Mat3::identity(),
                own_covariance: Mat3::identity(),
                rms_px: 0.5,
                worst_corner_sigma_px: 1.0,
                confidence: 0.5 + 0.0005 * chance as f64,
                inliers: 200,
                places: 30,
                evidence: touchline::relocalize::Evidence {
                    breadth_px: 200.0,
                    features_sigma_px: 0.5,
                    labelled_sigma_px: 2.0,
                    from_reference: touchline::relocalize::FromReference::default(),
                    at_most: 1.0,
                },
                line_check: None,
                samples: None,
            };
            let none = NotFound::FewMatches {
                matched: 3,
                needed: 12,
            };
            let outcome = if chance.is_multiple_of(50) {
                Err(none.into())
            } else {
                Ok(answer)
            };
            let frame = &document.frames[frame];
            let request = FrameRequest::from_frame(document, frame);
            Proposal {
                frame: frame.id.clone(),
                request,
                generation,
                outcome,
                timings: Timings::default(),
            }
        };
        frames.iter().map(propose).collect()
    }

    fn on(document: Document) -> Self {
        let mut app = App::new(Settings {
            details: true,
            ..Settings::default()
        });
        app.update(Action::Opened(Box::new(Opened::new(
            document,
            "/match/project.json",
        ))));
        app.update(Action::Navigate(Navigation::GoTo(frame_count() / 2)));
        let ctx = Context::default();
        apply_theme(&ctx);
        let mut window = Self {
            app,
            pictures: Pictures::start(Arc::new(|| ())).unwrap(),
            ctx,
            time: 0.0,
        };
        for _ in 0..5 {
            window.frame(Vec::new());
        }
        window
    }

    /// One frame of the window, and the actions that it asked for.
    fn frame(&mut self, events: Vec<Event>) -> usize {
        self.time += 1.0 / 60.0;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 720.0))),
            time: Some(self.time),
            events,
            ..RawInput::default()
        };
        let (app, pictures) = (&mut self.app, &mut self.pictures);
        let mut output = self.ctx.clone().run_ui(input, |ui| {
            let mut actions = Vec::new();
            read(
                &mut Panel {
                    app,
                    pictures,
                    actions: &mut actions,
                    adapter: "",
                },
                ui.ctx(),
            );
            for action in actions.drain(..) {
                app.update(action);
            }
            show(
                &mut Panel {
                    app,
                    pictures,
                    actions: &mut actions,
                    adapter: "",
                },
                ui,
            );
        });
        // Nobody uploads them.
        output.textures_delta.clear();
        black_box(output).shapes.len()
    }
}

/// Each time the pointer goes on to the right, from a place up to so many points beyond it.
fn pointer_along(bencher: Bencher<'_, '_>, mut window: Window, from: Pos2, far: f32) {
    let mut x = 0.0;
    bencher.bench_local(|| {
        x = (x + 3.0) % far;
        window.frame(vec![Event::PointerMoved(from + vec2(x, 0.0))])
    });
}

/// Each time a command is given.
fn command_each_time(bencher: Bencher<'_, '_>, mut window: Window, command: Command) {
    bencher.bench_local(|| {
        window.app.update(Action::Command(command));
        window.frame(Vec::new())
    });
}

/// Nothing happens: the window is drawn again.
#[divan::bench]
fn still(bencher: Bencher<'_, '_>) {
    let mut window = Window::open();
    bencher.bench_local(|| window.frame(Vec::new()));
}

/// The timeline of a video is drawn as well, and the pointer moves along it.
#[divan::bench]
fn timeline(bencher: Bencher<'_, '_>) {
    pointer_along(
        bencher,
        Window::on(of_video(document(frame_count()))),
        Pos2::new(300.0, 560.0),
        400.0,
    );
}

/// Every time a frame of a video is accepted.
#[divan::bench]
fn timeline_accept(bencher: Bencher<'_, '_>) {
    command_each_time(
        bencher,
        Window::on(of_video(document(frame_count()))),
        Command::Accept,
    );
}

/// The quality page is drawn again, all of the time shown.
#[divan::bench]
fn quality_page(bencher: Bencher<'_, '_>) {
    let mut window = Window::on(document(2 * frame_count()));
    window.app.update(Action::Command(Command::QualityPage));
    pointer_along(bencher, window, Pos2::new(60.0, 100.0), 900.0);
}

/// What the quality page shows is derived: it is closed and opened.
#[divan::bench]
fn quality_page_derived(bencher: Bencher<'_, '_>) {
    let mut window = Window::on(document(2 * frame_count()));
    bencher.bench_local(|| {
        window.app.update(Action::Command(Command::QualityPage));
        window.app.update(Action::Command(Command::QualityPage));
    });
}

/// The pointer moves over the picture.
#[divan::bench]
fn pointer_moves(bencher: Bencher<'_, '_>) {
    pointer_along(bencher, Window::open(), Pos2::new(20.0, 300.0), 900.0);
}

/// The filmstrip is at another frame every time.
#[divan::bench]
fn step(bencher: Bencher<'_, '_>) {
    let mut window = Window::open();
    bencher.bench_local(|| {
        let key = if window.app.session.frame + 1 < frame_count() {
            Key::Period
        } else {
            Key::R
        };
        window.frame(vec![Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        }])
    });
}

/// The same while the trainer learns without a pause: every 20 frames of the window a reference is
/// changed.
#[cfg(feature = "opencv")]
#[divan::bench]
fn step_while_the_trainer_works(bencher: Bencher<'_, '_>) {
    let mut window = Window::open();
    let school = School::open();
    let mut frames = 0;
    bencher.bench_local(|| {
        if frames % 20 == 0 {
            school.change(frames);
        }
        frames += 1;
        black_box(school.trainer.poll());
        let key = if window.app.session.frame + 1 < frame_count() {
            Key::Period
        } else {
            Key::R
        };
        let (physical_key, pressed, repeat) = (None, true, false);
        window.frame(vec![Event::Key {
            key,
            physical_key,
            pressed,
            repeat,
            modifiers: Modifiers::NONE,
        }])
    });
}

/// A trainer with references to learn from.
#[cfg(feature = "opencv")]
struct School {
    trainer: Trainer,
    document: Document,
    _folder: tempfile::TempDir,
}

#[cfg(feature = "opencv")]
impl School {
    /// References of coloured noise, full of features.
    fn open() -> Self {
        const REFERENCES: usize = 24;
        let size = ImageSize::new(640, 360);
        let folder = tempfile::tempdir().unwrap();
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut camera = Camera::new("main".into(), size);
        let level = BaseAngles::default().base_from_world();
        camera.set_base(&CameraBase::new(
            Vec3::new(0.0, -66.0, 18.0),
            level,
            size.centre(),
        ));
        document.cameras.push(camera.into());
        for index in 0..REFERENCES {
            let grain = |x: u32, y: u32| {
                ((x / 5).wrapping_mul(2_654_435_761) ^ (y / 5 + index as u32).wrapping_mul(40_503))
                    >> 7
            };
            let picture = image::RgbImage::from_fn(size.width, size.height, |x, y| {
                image::Rgb([grain(x, y) as u8; 3])
            });
            let name = format!("{index}.png");
            picture.save(folder.path().join(&name)).unwrap();
            let mut frame = Frame::from_image(&name, "main".into(), size);
            frame.status = FrameStatus::Reference;
            frame.ptz = Some(FramePtz::new(
                Ptz::from_degrees(index as f64, -12.0, 800.0),
                None,
            ));
            document.frames.push(frame.into());
        }
        let options = TrainerOptions {
            settle: Duration::ZERO,
            ..TrainerOptions::default()
        };
        let trainer = Trainer::start(
            folder.path().join("project.json"),
            options,
            SharedPictures::none(),
            Arc::new(|| ()),
        )
        .unwrap();
        Self {
            trainer,
            document,
            _folder: folder,
        }
    }

    /// A reference is another one now.
    fn change(&self, number: usize) {
        let mut document = self.document.clone();
        document.frames[0].ptz = Some(FramePtz::new(
            Ptz::from_degrees(0.001 * number as f64, -12.0, 800.0),
            None,
        ));
        self.trainer
            .notify(TrainerOrder::Document(Box::new(document)));
    }
}

/// The list of 10,000 suggestions is open, and nothing happens.
#[divan::bench]
fn review_still(bencher: Bencher<'_, '_>) {
    let mut window = Window::review();
    bencher.bench_local(|| window.frame(Vec::new()));
}

/// From suggestion to suggestion along the list.
#[divan::bench]
fn review_step(bencher: Bencher<'_, '_>) {
    command_each_time(bencher, Window::review(), Command::NextNeedsMe);
}

/// Each time a suggestion is accepted, and the next one shown.
#[divan::bench]
fn review_accept(bencher: Bencher<'_, '_>) {
    command_each_time(bencher, Window::review(), Command::Accept);
}

/// The frame in which a batch of proposals arrives, as they do twice a second while the forest is
/// asked; the pointer is elsewhere, so that the list is put in order.
#[divan::bench]
fn review_while_proposals_stream_in(bencher: Bencher<'_, '_>) {
    stream(bencher, Pos2::new(400.0, 300.0));
}

/// The same with the pointer over the list, which holds it.
#[divan::bench]
fn held_review_while_proposals_stream_in(bencher: Bencher<'_, '_>) {
    stream(bencher, Pos2::new(1130.0, 300.0));
}

fn stream(bencher: Bencher<'_, '_>, pointer: Pos2) {
    let mut window = Window::review();
    window.frame(vec![Event::PointerMoved(pointer)]);
    window.frame(Vec::new());
    let mut batches = 0;
    let window = std::cell::RefCell::new(window);
    bencher
        .with_inputs(|| {
            batches += 1;
            let frames: Vec<usize> = (0..BATCH)
                .map(|at| (batches * BATCH + at) % (2 * frame_count()))
                .collect();
            window.borrow().proposals(&frames, 2)
        })
        .bench_local_values(|proposals| {
            let mut window = window.borrow_mut();
            window
                .app
                .update(Action::Trainer(TrainerReport::Proposals(proposals)));
            window.frame(Vec::new())
        });
}

/// The palette lies over everything.
#[divan::bench]
fn palette(bencher: Bencher<'_, '_>) {
    let mut window = Window::open();
    window.app.update(Action::Command(Command::Palette));
    bencher.bench_local(|| window.frame(Vec::new()));
}
