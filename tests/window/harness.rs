//! A window on a small project in a temporary folder.

use eframe::egui_wgpu::WgpuSetup;
use egui_kittest::kittest::Queryable as _;
use egui_kittest::wgpu::default_wgpu_setup;
use egui_kittest::{Harness, SnapshotOptions};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use touchline::app::session::PictureView;
use touchline::app::{Action, App, TrainerReport};
use touchline::camera::{CameraBase, PtzCamera};
use touchline::document::{
    Click, FramePtz, FrameStatus, Solution, SolutionSource, SolutionWarning,
};
use touchline::geometry::{ImagePoint, ImageSize, Mat3};
use touchline::proposals::{Answer, FrameRequest, Proposal, Timings};
use touchline::render::{Layer, Offscreen, View};
use touchline::scene::OverlayStyle;
use touchline::scene::drawing::Colour;
use touchline::scene::overlay::{OverlayScene, field_overlay};
use touchline::ui::Shell;
use touchline_core::testing::{TestBase, base_at, ground_landmarks, landmark_in, soccer};
use touchline_documents::testing::{match_from, new_frame, save, solved_by};

/// The size of every frame.
pub const SIZE: ImageSize = ImageSize::new(640, 360);
/// How long the background may take for a small picture.
const PATIENCE: Duration = Duration::from_mins(1);

fn base() -> CameraBase {
    base_at([1.5, -66.0, 18.0], SIZE)
}

/// The camera that drew a frame.
pub fn truth(frame: usize) -> PtzCamera {
    base().aim(-18.0 + 1.5 * frame as f64, -13.0, 760.0)
}

/// Writes a project of plain frames: white lines on green.
fn write_project(folder: &Path, frames: usize) {
    let mut offscreen = Offscreen::new().unwrap();
    let mut document = match_from(&base(), SIZE);
    let style = OverlayStyle {
        colour: [235, 240, 235],
        width: 1.5,
        opacity: 1.0,
        outline: 0.0,
        landmarks: false,
        ..OverlayStyle::default()
    };
    for index in 0..frames {
        let (field, camera) = (soccer(), truth(index));
        let scene = OverlayScene {
            camera: Some(&camera),
            ..OverlayScene::new(&field, SIZE, &style)
        };
        let lines = Layer::Drawing(Arc::new(field_overlay(&scene)));
        let view = View::one_to_one([SIZE.width, SIZE.height]);
        let picture = offscreen
            .render(&view, Colour::rgb(62, 118, 66), &[lines])
            .unwrap();
        let name = format!("{index:04}.png");
        picture.save(folder.join(&name)).unwrap();
        document.frames.push(new_frame(&name, SIZE).into());
    }
    save(folder.join("project.json"), &document);
}

/// A folder with a project of plain frames.
fn new_project(frames: usize) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_project(folder.path(), frames);
    folder
}

/// Exact points on every landmark that a frame shows on the ground.
pub fn seen_landmarks(frame: usize) -> Vec<Click> {
    let (field, camera) = (soccer(), truth(frame));
    ground_landmarks(&field, &camera)
        .filter(|(_, _, at)| SIZE.contains(*at))
        .map(|(_, landmark, at)| Click::landmark(landmark.id.clone(), at))
        .collect()
}

/// An adapter as the toolkit's tests choose it, but no OpenGL unasked: Mesa's can end the process
/// with a fault when it exits.
fn graphics() -> WgpuSetup {
    let mut setup = default_wgpu_setup();
    if let WgpuSetup::CreateNew(new) = &mut setup {
        new.instance_descriptor.backends =
            wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
    }
    setup
}

/// A window on a project.
pub struct Window {
    /// The window.
    pub harness: Harness<'static, Shell>,
    /// The project's folder; it goes with the window.
    pub folder: TempDir,
    _settings: TempDir,
}

impl Window {
    /// Opens a project of plain frames.
    pub fn open(frames: usize, size: [f32; 2], pixels_per_point: f32) -> Self {
        Self::on(new_project(frames), size, pixels_per_point)
    }

    /// Opens a project of plain frames in a folder of this name.
    pub fn open_in(name: &str, frames: usize, size: [f32; 2]) -> Self {
        let around = tempfile::tempdir().unwrap();
        let folder = around.path().join(name);
        std::fs::create_dir(&folder).unwrap();
        write_project(&folder, frames);
        Self::at(around, folder, size, 1.0)
    }

    /// Opens a queue of two projects of plain frames and a third that is missing.
    pub fn open_queue(size: [f32; 2]) -> Self {
        let around = tempfile::tempdir().unwrap();
        let mut entries = Vec::new();
        for (name, frames) in [("final", 3), ("semifinal", 2), ("lost", 0)] {
            let folder = around.path().join(name);
            if frames > 0 {
                std::fs::create_dir(&folder).unwrap();
                write_project(&folder, frames);
            }
            entries.push(format!(
                r#"{{"match": "{name}", "project": "{name}/project.json"}}"#
            ));
        }
        let text = format!(
            r#"{{ "format": "touchline queue", "version": 1, "matches": [{}] }}"#,
            entries.join(", ")
        );
        let queue = around.path().join("queue.json");
        std::fs::write(&queue, text).unwrap();
        Self::at(around, queue, size, 1.0)
    }

    /// Opens a project of plain frames whose camera is not known, with exact points on every
    /// landmark of each.
    pub fn open_clicked(frames: usize, size: [f32; 2]) -> Self {
        let folder = new_project(frames);
        let (_, mut document, _) = touchline::store::read(folder.path()).unwrap();
        let camera = &mut document.cameras[0];
        (camera.position_m, camera.base_from_world) = (None, None);
        for (index, frame) in document.frames.iter_mut().enumerate() {
            frame.clicks = seen_landmarks(index);
            frame.status = FrameStatus::Draft;
        }
        save(folder.path().join("project.json"), &document);
        Self::on(folder, size, 1.0)
    }

    /// Opens a project of plain references with exact points on every landmark of each, save one
    /// point of the fourth.
    pub fn open_referenced(frames: usize, size: [f32; 2]) -> Self {
        let folder = new_project(frames);
        let (_, mut document, _) = touchline::store::read(folder.path()).unwrap();
        for (index, frame) in document.frames.iter_mut().enumerate() {
            frame.clicks = seen_landmarks(index);
            frame.ptz = Some(FramePtz::new(truth(index).ptz(), None));
            frame.solution = solved_by(SolutionSource::Clicks);
            frame.status = FrameStatus::Reference;
        }
        if let Some(click) = document
            .frames
            .get_mut(3)
            .and_then(|frame| frame.clicks.first_mut())
        {
            click.image.x += 9.0;
        }
        save(folder.path().join("project.json"), &document);
        Self::on(folder, size, 1.0)
    }

    /// Opens a project of plain frames with a camera proposed for each, as certain as this; none:
    /// no answer.
    pub fn open_suggested(confidences: &[Option<f64>], size: [f32; 2]) -> Self {
        let folder = new_project(confidences.len());
        let (_, mut document, _) = touchline::store::read(folder.path()).unwrap();
        for (index, (frame, confidence)) in document.frames.iter_mut().zip(confidences).enumerate()
        {
            let mut solution = Solution {
                source: Some(SolutionSource::Forest),
                confidence: *confidence,
                ..Solution::default()
            };
            if confidence.is_some() {
                frame.ptz = Some(FramePtz::new(truth(index).ptz(), None));
                frame.status = FrameStatus::Suggested;
            } else {
                let reason = "3 features look like the references, 12 are needed".to_owned();
                solution
                    .warnings
                    .push(SolutionWarning::new("coverage", reason));
            }
            frame.solution = Some(solution);
        }
        save(folder.path().join("project.json"), &document);
        Self::on(folder, size, 1.0)
    }

    /// Opens a project that is there.
    pub fn on(folder: TempDir, size: [f32; 2], pixels_per_point: f32) -> Self {
        let path = folder.path().to_path_buf();
        Self::at(folder, path, size, pixels_per_point)
    }

    fn at(folder: TempDir, path: PathBuf, size: [f32; 2], pixels_per_point: f32) -> Self {
        let settings = tempfile::tempdir().unwrap();
        let kept = settings.path().join("settings.json");
        // The points of these tests are exact, the paint of their small pictures is not.
        std::fs::write(&kept, r#"{"snap_points": false}"#).unwrap();
        let harness = Harness::builder()
            .with_size(size)
            .with_pixels_per_point(pixels_per_point)
            .wgpu_setup(graphics())
            .build_eframe(move |creation| Shell::new(creation, Some(kept), vec![path]).unwrap());
        let mut window = Self {
            harness,
            folder,
            _settings: settings,
        };
        window.wait_for(|shell| shell.app().open().is_some() && shell.has_picture());
        window.harness.run_steps(3);
        window
    }

    /// The application behind the window.
    pub fn app(&self) -> &App {
        self.harness.state().app()
    }

    /// The forest proposes the true camera of a frame, as certain as this.
    pub fn propose(&mut self, frame: usize, confidence: f64) {
        let document = &self.app().open().unwrap().document;
        let answer = Answer {
            ptz: FramePtz::new(truth(frame).ptz(), None),
            covariance: Mat3::identity(),
            own_covariance: Mat3::identity(),
            rms_px: 0.5,
            worst_corner_sigma_px: 1.0,
            confidence,
            inliers: 100,
            places: 20,
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
        let proposal = Proposal {
            frame: document.frames[frame].id.clone(),
            request: FrameRequest::from_frame(document, &document.frames[frame]),
            generation: 1,
            outcome: Ok(answer),
            timings: Timings::default(),
        };
        self.apply(Action::Trainer(TrainerReport::Proposals(vec![proposal])));
        self.harness.run_steps(2);
    }

    /// Lets the window run until something holds.
    pub fn wait_for(&mut self, wanted: impl Fn(&Shell) -> bool) {
        let start = Instant::now();
        while !wanted(self.harness.state()) {
            assert!(start.elapsed() < PATIENCE, "the window waits for ever");
            std::thread::sleep(Duration::from_millis(5));
            self.harness.step();
        }
        self.harness.step();
    }

    /// Where a point of the picture is on the screen.
    pub fn on_screen(&self, at: ImagePoint) -> egui::Pos2 {
        let rect = self.harness.get_by_label("Picture").rect();
        let per_point = f64::from(self.harness.ctx.pixels_per_point());
        let (scale, centre) = match self.app().session.picture.view {
            PictureView::Fit => (self.app().session.picture.fit_scale, SIZE.centre()),
            PictureView::Zoomed { scale, centre } => (scale, centre),
        };
        let way = at.offset_from(centre) * (scale / per_point);
        rect.center() + egui::vec2(way.x as f32, way.y as f32)
    }

    /// Where a landmark is in the shown frame, by the truth.
    pub fn image_of(&self, landmark: &str) -> ImagePoint {
        landmark_in(&truth(self.app().session.frame), &soccer(), landmark)
    }

    /// Presses and releases the button at a point of the picture.
    pub fn click(&mut self, at: ImagePoint) {
        let at = self.on_screen(at);
        self.press(at);
        self.release(at);
    }

    /// The button goes down.
    pub fn press(&mut self, at: egui::Pos2) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.drag_at(at);
        self.harness.step();
    }

    /// Clicks what has this label.
    pub fn press_label(&self, label: &str) {
        self.harness.get_by_label(label).click();
    }

    /// Does this, whatever is shown.
    pub fn apply(&mut self, action: Action) {
        self.harness.state_mut().apply([action]);
    }

    /// The pointer moves.
    pub fn drag(&mut self, to: egui::Pos2) {
        self.harness.hover_at(to);
        self.harness.step();
    }

    /// The button goes up.
    pub fn release(&mut self, at: egui::Pos2) {
        self.harness.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed: false,
            modifiers: egui::Modifiers::NONE,
        });
        self.harness.run_steps(2);
    }

    /// A text is typed, letter by letter.
    pub fn type_text(&mut self, text: &str) {
        for letter in text.chars() {
            self.harness.event(egui::Event::Text(letter.to_string()));
            self.harness.step();
        }
    }

    /// A key is pressed.
    pub fn key(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.harness.run_steps(2);
    }

    /// The window around a point of the picture as it looks, compared with the kept picture.
    pub fn snapshot(&mut self, name: &str, around: ImagePoint, size: [f32; 2]) {
        let viewport = self.harness.get_by_label("Picture").rect();
        let part =
            egui::Rect::from_center_size(self.on_screen(around), size.into()).intersect(viewport);
        self.snapshot_of(name, part);
    }

    /// A part of the window as it looks, compared with the kept picture.
    pub fn snapshot_of(&mut self, name: &str, part: egui::Rect) {
        let per_point = self.harness.ctx.pixels_per_point();
        let whole = self.harness.render().unwrap();
        let px = |points: f32| (points * per_point).round().max(0.0) as u32;
        let (x, y, width, height) = (
            px(part.left()),
            px(part.top()),
            px(part.width()),
            px(part.height()),
        );
        let cut = image::imageops::crop_imm(&whole, x, y, width, height).to_image();
        let options = SnapshotOptions::new()
            .output_path("tests/window/snapshots")
            .max_failed_pixels(40);
        egui_kittest::image_snapshot_options(&cut, name, &options);
    }
}
