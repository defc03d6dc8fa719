//! Frames of a 1080p video and of image files: what a step costs, prefetched or not.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a bench says what failed by failing"
)]

use divan::Bencher;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, OnceLock};
use tempfile::TempDir;
use touchline::jobs::{Decoder, FrameState};
use touchline::media::{
    FrameRef, Picture, PrefetchOptions, StepDirection, THUMBNAIL_SIZE, Video, letterbox,
    load_image, prefetch_plan,
};

fn main() {
    divan::main();
}

/// The video that `TOUCHLINE_VIDEO` names; else a 1080p H.264 video with a key frame every 125
/// frames: a broadcast match scaled up where there is one (`TOUCHLINE_DATA` or `../shared/data`),
/// else a test card.
fn video() -> &'static Path {
    static VIDEO: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, path) = VIDEO.get_or_init(|| {
        if let Some(given) = std::env::var_os("TOUCHLINE_VIDEO") {
            return (
                tempfile::tempdir().unwrap(),
                std::path::absolute(given).unwrap(),
            );
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("1080p.mp4");
        let data = std::env::var_os("TOUCHLINE_DATA").map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"),
            PathBuf::from,
        );
        let game = data.join("video-soccer/match.mp4");
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-y"]);
        if game.is_file() {
            command
                .arg("-i")
                .arg(game)
                .args(["-frames:v", "400", "-vf", "scale=1920:1080", "-an"]);
        } else {
            command.args([
                "-f",
                "lavfi",
                "-i",
                "testsrc2=size=1920x1080:rate=25:duration=16",
            ]);
        }
        command
            .args([
                "-c:v", "libx264", "-preset", "veryfast", "-g", "125", "-b:v", "6M",
            ])
            .arg(&path);
        assert!(
            command.status().is_ok_and(|status| status.success()),
            "this bench needs ffmpeg to make its video"
        );
        (folder, path)
    });
    path
}

/// A decoder with its wake calls, as a window has it.
struct Stepper {
    decoder: Decoder,
    woken: Receiver<()>,
    frames: usize,
    at: usize,
}

impl Stepper {
    fn new(at: usize) -> Self {
        let frames = Video::open(video()).unwrap().info().decoded_frames;
        let (wake, woken) = channel();
        let wake = Arc::new(move || wake.send(()).unwrap_or_default());
        let decoder = Decoder::spawn(512 << 20, wake).unwrap();
        let mut stepper = Self {
            decoder,
            woken,
            frames,
            at,
        };
        stepper.request(StepDirection::Unknown);
        stepper.wait_for(at);
        stepper
    }

    fn request(&mut self, direction: StepDirection) {
        let options = PrefetchOptions {
            in_blocks: true,
            ..PrefetchOptions::default()
        }
        .within(self.decoder.cache_bytes(), 4 * 1920 * 1080);
        let neighbours: Vec<_> = prefetch_plan(self.at, self.frames, direction, options)
            .into_iter()
            .map(frame)
            .collect();
        self.decoder.request(&frame(self.at), &neighbours);
    }

    /// What a window does when a key is pressed, up to the pixels in hand.
    fn step(&mut self, to: usize) -> Option<Picture> {
        let direction = StepDirection::from_step(self.at, to);
        self.at = to;
        self.request(direction);
        self.decoder.poll();
        self.decoder.picture(&frame(to))
    }

    fn wait_for(&mut self, index: usize) {
        while !matches!(self.decoder.state(&frame(index)), FrameState::Ready(_)) {
            self.woken.recv().unwrap();
            self.decoder.poll();
        }
    }
}

fn frame(index: usize) -> FrameRef {
    FrameRef::video(video(), index)
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn step_to_a_prefetched_neighbour(bencher: Bencher) {
    let mut stepper = Stepper::new(20);
    let mut next = 20;
    let stepper = std::cell::RefCell::new(&mut stepper);
    bencher
        .with_inputs(|| {
            next += 1;
            stepper.borrow_mut().wait_for(next);
            next
        })
        .bench_local_values(|next| stepper.borrow_mut().step(next).unwrap());
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn play_forward_a_frame(bencher: Bencher) {
    let mut stepper = Stepper::new(20);
    bencher.bench_local(|| {
        let next = stepper.at + 1;
        stepper.step(next);
        stepper.wait_for(next);
    });
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn play_backward_a_frame(bencher: Bencher) {
    let mut stepper = Stepper::new(350);
    bencher.bench_local(|| {
        let next = stepper.at - 1;
        stepper.step(next);
        stepper.wait_for(next);
    });
}

#[divan::bench(sample_count = 30, sample_size = 1)]
fn jump_without_prefetching(bencher: Bencher) {
    let mut video = Video::open(video()).unwrap();
    let frames = video.info().decoded_frames;
    let mut index = 0;
    bencher.bench_local(|| {
        index = (index + frames * 157 / 400) % frames;
        video.frame(index).unwrap()
    });
}

#[divan::bench(sample_count = 100, sample_size = 1)]
fn next_frame_without_prefetching(bencher: Bencher) {
    let mut video = Video::open(video()).unwrap();
    let mut index = 0;
    bencher.bench_local(|| {
        index += 1;
        video.frame(index).unwrap()
    });
}

/// A file by a name that nobody has asked for yet.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn open_a_video_for_the_first_time(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let mut names = 0..;
    let anew = || {
        let path = folder.path().join(format!("{}.mp4", names.next().unwrap()));
        std::os::unix::fs::symlink(video(), &path).unwrap();
        path
    };
    bencher
        .with_inputs(anew)
        .bench_local_values(|path| Video::open(&path).unwrap());
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn open_a_video_again(bencher: Bencher) {
    let known = Video::open(video()).unwrap();
    bencher.bench_local(|| Video::open(&known.info().path).unwrap());
}

#[divan::bench(sample_count = 30, sample_size = 1)]
fn load_a_1080p_jpeg(bencher: Bencher) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.jpg");
    let picture = Video::open(video()).unwrap().frame(30).unwrap();
    let rgb: Vec<u8> = picture
        .rgba()
        .chunks_exact(4)
        .flat_map(|pixel| pixel[..3].to_vec())
        .collect();
    image::RgbImage::from_raw(1920, 1080, rgb)
        .unwrap()
        .save(&path)
        .unwrap();
    bencher.bench_local(|| load_image(&path).unwrap());
}

#[divan::bench(sample_count = 30, sample_size = 1)]
fn thumbnail_of_a_1080p_frame(bencher: Bencher) {
    let picture = Video::open(video()).unwrap().frame(30).unwrap();
    bencher.bench_local(|| letterbox(&picture, THUMBNAIL_SIZE));
}
