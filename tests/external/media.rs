//! Videos: a frame's number means one picture, however it is reached.

use crate::parts::{Test, frames_folder, tests};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sha2::{Digest, Sha256};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use touchline::app::operations::{FoundShots, ShotSearch};
use touchline::document::ShotKind;
use touchline::geometry::ImageSize;
use touchline::media::{
    CountProgress, FrameClock, FrameReader, FrameRef, FrameSource, MediaError, Notice, Picture,
    Video, VideoBackend, VideoInfo,
};
use touchline::progress::Progress;

pub const TESTS: &[Test] = tests![
    [Ffmpeg] a_number_means_one_picture_in_every_container;
    [Ffmpeg] a_number_means_one_picture_however_the_file_was_made;
    [Ffmpeg] uneven_frames_are_numbered_as_they_decode;
    [Ffmpeg] one_frame_left_out_of_thousands_does_not_shift_those_behind_it;
    [Ffmpeg] a_video_is_examined_again_only_where_its_file_has_changed;
    [Ffmpeg] who_waits_for_a_video_is_told_and_may_give_up;
    [Ffmpeg] the_times_of_an_uneven_mp4_are_read_from_its_table;
    [Ffmpeg] a_video_cut_off_ends_where_it_is_cut;
    [Ffmpeg] a_video_on_its_side_is_turned_upright;
    [Ffmpeg] pixels_that_are_not_square_are_made_square;
    [Ffmpeg] the_cuts_of_a_video_are_found;
    [Ffmpeg] interlaced_frames_are_shown_without_a_comb;
    [Frames, Ffmpeg] a_match_without_a_cut_has_one_shot;
    [Frames, Ffmpeg] joined_clips_have_their_shots_and_transitions;
    [Ffmpeg] a_video_is_a_source_of_numbered_frames;
    [Frames, Ffmpeg] a_match_states_825_frames_and_has_817;
];

type PixelDigest = [u8; 32];

/// Every frame as one plain pass gives it, from the start to the end, without any seeking: the
/// truth that numbers are measured by.
fn play_frames(path: &Path, backend: VideoBackend, size: ImageSize) -> Vec<PixelDigest> {
    match backend {
        VideoBackend::Ffmpeg => play_with_ffmpeg(path, size),
        #[cfg(feature = "opencv-videoio")]
        VideoBackend::OpenCv => play_with_opencv(path),
        #[cfg(not(feature = "opencv-videoio"))]
        VideoBackend::OpenCv => unreachable!("it is not built in"),
    }
}

fn play_with_ffmpeg(path: &Path, size: ImageSize) -> Vec<PixelDigest> {
    let play = [
        "-map",
        "0:v:0",
        "-vsync",
        "passthrough",
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgba",
        "-",
    ];
    let output = Command::new("ffmpeg")
        .args(["-v", "quiet", "-i"])
        .arg(path)
        .args(play)
        .output()
        .unwrap();
    let bytes = 4 * size.width as usize * size.height as usize;
    output
        .stdout
        .chunks_exact(bytes)
        .map(|rgba| Sha256::digest(rgba).into())
        .collect()
}

/// A frame that does not decode is passed over: the end is where many in a row do not.
#[cfg(feature = "opencv-videoio")]
fn play_with_opencv(path: &Path) -> Vec<PixelDigest> {
    use opencv::core::{Mat, Vec3b};
    use opencv::prelude::*;
    use opencv::videoio::{CAP_FFMPEG, VideoCapture};
    let mut capture = VideoCapture::from_file(path, CAP_FFMPEG).unwrap();
    let (mut frame, mut digests) = (Mat::default(), Vec::new());
    while (0..100).any(|_| capture.read(&mut frame).unwrap()) {
        let pixels = frame.data_typed::<Vec3b>().unwrap();
        let rgba: Vec<u8> = pixels
            .iter()
            .flat_map(|bgr| [bgr[2], bgr[1], bgr[0], 255])
            .collect();
        digests.push(Sha256::digest(&rgba).into());
    }
    digests
}

fn frame(video: &mut Video, index: usize) -> PixelDigest {
    let picture = video.frame(index).unwrap();
    assert_eq!(picture.size(), video.info().size);
    Sha256::digest(picture.rgba()).into()
}

/// In each backend the numbers hold, and all backends agree on how many frames there are and when
/// they are shown.
fn assert_numbers_hold(path: &Path, random_frames: usize) -> Video {
    let mut videos: Vec<Video> = VideoBackend::available()
        .map(|backend| {
            let video = Video::open_with(path, backend, &Progress::default()).unwrap();
            assert_numbers_hold_in(video, backend, random_frames)
        })
        .collect();
    let mut first = videos.remove(0);
    for mut other in videos {
        let middle = first.info().decoded_frames / 2;
        let off = mean_difference(&first.frame(middle).unwrap(), &other.frame(middle).unwrap());
        assert!(off < 1.0, "{}: {off} levels", path.display());

        let [ours, theirs] = [first.info(), other.info()];
        let stated = |info: &VideoInfo| {
            (
                info.size,
                info.rotation_deg,
                info.decoded_frames,
                info.interlaced,
            )
        };
        assert_eq!(stated(ours), stated(theirs), "{}", path.display());
        // One of the backends does not tell the times of the last frames.
        for index in 0..ours.decoded_frames.saturating_sub(20) {
            let [ours_s, theirs_s] = [ours.pts_s(index).unwrap(), theirs.pts_s(index).unwrap()];
            assert!(
                (ours_s - theirs_s).abs() < 1.1e-3,
                "{}: {index}: {ours_s} {theirs_s} s",
                path.display()
            );
        }
    }
    first
}

/// How far two pictures differ, levels of 255.
fn mean_difference(one: &Picture, other: &Picture) -> f64 {
    let off: f64 = one
        .rgba()
        .iter()
        .zip(other.rgba())
        .map(|(a, b)| f64::from(a.abs_diff(*b)))
        .sum();
    off / one.rgba().len() as f64
}

/// Frames forward, backward, twice, and at random: each must be the one that playing gives.
fn assert_numbers_hold_in(mut video: Video, backend: VideoBackend, random_frames: usize) -> Video {
    let path = Arc::clone(&video.info().path);
    let path = &*path;
    let truth = play_frames(path, backend, video.info().size);
    let count = video.info().decoded_frames;
    assert_eq!(count, truth.len(), "{backend}: {}", path.display());
    let mut random = Pcg64Mcg::seed_from_u64(0x6e75_6d62_6572_7321);
    let mut order: Vec<usize> = (0..count.min(8)).chain([count - 1, count - 1, 0]).collect();
    order.extend((count.saturating_sub(6)..count).rev());
    order.extend((0..random_frames).map(|_| random.random_range(0..count)));
    order.extend((count / 2..(count / 2 + 60).min(count)).step_by(14).rev());
    for index in order {
        assert_eq!(
            frame(&mut video, index),
            truth[index],
            "{backend}: {}: frame {index} of {count}",
            path.display()
        );
    }
    assert_eq!(
        video.frame(count).unwrap_err(),
        MediaError::NoSuchFrame {
            path: path.to_path_buf(),
            index: count,
            frames: count
        }
    );
    video
}

/// Runs ffmpeg in a folder; whether it could do what was asked.
fn ffmpeg_can(folder: &Path, arguments: &str) -> bool {
    let arguments = arguments.split(' ').map(|word| word.replace('~', " "));
    let ran = Command::new("ffmpeg")
        .args(["-v", "error", "-y"])
        .args(arguments)
        .current_dir(folder)
        .status();
    ran.unwrap().success()
}

fn ffmpeg(folder: &Path, arguments: &str) {
    assert!(ffmpeg_can(folder, arguments), "ffmpeg {arguments}");
}

/// Six seconds of a moving test card, and what becomes of it.
const CARD: &str = "-f lavfi -i testsrc2=size=160x90:rate=25:duration=6";

fn a_number_means_one_picture_in_every_container() {
    let folder = tempfile::tempdir().unwrap();
    for (name, how) in [
        ("even.mp4", "-c:v libx264 -g 50 -bf 2"),
        ("even.mkv", "-c:v libx264 -g 50"),
        (
            "open-gop.mp4",
            "-c:v libx264 -g 50 -x264-params open-gop=1:bframes=3",
        ),
        ("stream.ts", "-c:v libx264 -g 50"),
        ("programme.mpg", "-c:v mpeg2video -g 12 -bf 2"),
        ("motion-jpeg.avi", "-c:v mjpeg"),
        ("one.mp4", "-c:v libx264 -frames:v 1"),
    ] {
        ffmpeg(folder.path(), &format!("{CARD} {how} {name}"));
        let video = assert_numbers_hold(&folder.path().join(name), 5);
        // A programme stream states no count, only a duration that is not exact.
        let notices = video.info().notices.iter();
        let others = notices.filter(|notice| {
            name != "programme.mpg" || !matches!(notice, Notice::FramesStated { .. })
        });
        assert_eq!(others.count(), 0, "{name}: {:?}", video.info().notices);
        assert!((video.info().pts_s(10).unwrap_or(0.4) - 0.4).abs() < 1e-3);
    }
}

/// Files as encoders, cutters and recorders leave them: no index, late starts, edit lists,
/// reordered frames, odd rates.
fn a_number_means_one_picture_however_the_file_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let whole = "-c:v libx264 -g 50 -bf 3 -x264-params b-pyramid=normal";
    ffmpeg(folder.path(), &format!("{CARD} {whole} whole.mp4"));
    // The name, how it is made, and how many frames it has.
    let table = [
        ("hierarchical-b.mp4", format!("{CARD} {whole}"), 150),
        (
            "one-key-frame.mp4",
            format!("{CARD} -c:v libx264 -g 1000 -bf 2"),
            150,
        ),
        (
            "every-frame-a-key.mp4",
            format!("{CARD} -c:v libx264 -g 1"),
            150,
        ),
        (
            "hevc.mp4",
            format!("{CARD} -c:v libx265 -x265-params log-level=error -g 50"),
            150,
        ),
        ("mpeg4.avi", format!("{CARD} -c:v mpeg4 -g 50 -bf 2"), 150),
        (
            "fragmented.mp4",
            "-i whole.mp4 -c copy -movflags frag_keyframe+empty_moov".to_owned(),
            150,
        ),
        (
            "late.mp4",
            "-i whole.mp4 -c copy -output_ts_offset 3.2".to_owned(),
            150,
        ),
        (
            "late.mkv",
            "-i whole.mp4 -c copy -output_ts_offset 3.2".to_owned(),
            150,
        ),
        (
            "late.ts",
            "-i whole.mp4 -c copy -output_ts_offset 3.2".to_owned(),
            150,
        ),
        (
            "no-index.mkv",
            "-i whole.mp4 -c copy -f matroska -live 1".to_owned(),
            150,
        ),
        (
            "elementary.h264",
            "-i whole.mp4 -c copy -bsf:v h264_mp4toannexb".to_owned(),
            150,
        ),
        (
            "ntsc.mp4",
            format!("{} {whole}", CARD.replace("rate=25", "rate=30000/1001")),
            180,
        ),
        (
            "ntsc.mkv",
            format!("{} {whole}", CARD.replace("rate=25", "rate=30000/1001")),
            180,
        ),
        (
            "slow.mp4",
            format!("{} {whole}", CARD.replace("rate=25", "rate=8")),
            48,
        ),
    ];
    for (name, how, count) in table {
        ffmpeg(folder.path(), &format!("{how} {name}"));
        let video = assert_numbers_hold(&folder.path().join(name), 5);
        assert_eq!(video.info().decoded_frames, count, "{name}");
        let spacing = video.info().pts_s(11).unwrap() - video.info().pts_s(10).unwrap();
        assert!(
            (spacing - 1.0 / video.info().fps).abs() < 1.1e-3,
            "{name}: {spacing} s at {}",
            video.info().fps
        );
    }
    // Cut out of the middle without encoding again: an edit list hides what lies before the cut.
    ffmpeg(
        folder.path(),
        "-ss 1.3 -i whole.mp4 -t 3 -c copy cut-out.mp4",
    );
    assert_numbers_hold(&folder.path().join("cut-out.mp4"), 30);
}

fn uneven_frames_are_numbered_as_they_decode() {
    let folder = tempfile::tempdir().unwrap();
    let gap = "-vf select='not(between(n,90,94))' -vsync vfr -c:v libx264 -g 50";
    let wavering =
        "-vf setpts='PTS+if(gt(N,50),0.5/TB,0)+0.006*sin(N)/TB' -vsync vfr -c:v libx264 -g 50";
    for (name, how, count) in [
        ("gap.mp4", gap, 145),
        ("gap.mkv", gap, 145),
        ("wavering.mp4", wavering, 150),
        ("wavering.mkv", wavering, 150),
    ] {
        ffmpeg(folder.path(), &format!("{CARD} {how} {name}"));
        let video = assert_numbers_hold(&folder.path().join(name), 5);
        assert_eq!(video.info().decoded_frames, count, "{name}");
        assert!(
            matches!(video.info().clock, FrameClock::Listed(_)),
            "{name}"
        );
        assert!(
            video
                .info()
                .notices
                .iter()
                .any(|notice| matches!(notice, Notice::UnevenFrameTimes { .. }))
        );
        if how == gap {
            let at = |index| video.info().pts_s(index).unwrap();
            assert!(
                (at(89) - 3.56).abs() < 1e-3 && (at(90) - 3.80).abs() < 1e-3,
                "{} {}",
                at(89),
                at(90)
            );
        }
    }
}

/// So long a video that the mean rate is all but that of its first frames.
fn one_frame_left_out_of_thousands_does_not_shift_those_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    let card = "-f lavfi -i testsrc2=size=64x48:rate=25:duration=120";
    for name in ["gap.mp4", "gap.mkv"] {
        ffmpeg(
            folder.path(),
            &format!("{card} -vf select='not(eq(n,2000))' -vsync vfr -c:v libx264 -g 50 {name}"),
        );
        let video = assert_numbers_hold(&folder.path().join(name), 5);
        let at = |index| video.info().pts_s(index).unwrap();
        assert_eq!(video.info().decoded_frames, 2999, "{name}");
        assert!(
            (at(1999) - 79.96).abs() < 2e-3 && (at(2000) - 80.04).abs() < 2e-3,
            "{} {}",
            at(1999),
            at(2000)
        );
    }
}

/// A progress that goes on, and the number of its reports.
fn count_reports() -> (Progress<'static, CountProgress>, Arc<AtomicUsize>) {
    let reports = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&reports);
    let progress = Progress::new(move |_| {
        counted.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    (progress, reports)
}

fn a_video_is_examined_again_only_where_its_file_has_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gap.mkv");
    let gap = "-vf select='not(between(n,40,44))' -vsync vfr -c:v libx264 -g 50";
    ffmpeg(folder.path(), &format!("{CARD} {gap} gap.mkv"));
    // Every frame of an uneven video is visited, and that is told.
    let open = || {
        let (counting, told) = count_reports();
        (
            Video::open_with_progress(&path, &counting).unwrap(),
            told.load(Ordering::Relaxed),
        )
    };
    let (first, told) = open();
    let info = first.info().clone();
    assert!(told > 0 && info.decoded_frames == 145, "{told} {info:?}");
    let (mut again, told) = open();
    assert_eq!((told, again.info()), (0, &info));
    let backend = VideoBackend::available().next().unwrap();
    assert_eq!(
        frame(&mut again, 100),
        play_frames(&path, backend, info.size)[100]
    );
    // Whoever ends it leaves nothing half known.
    ffmpeg(
        folder.path(),
        &format!("{CARD} {gap} -frames:v 120 gap.mkv"),
    );
    let impatient = Progress::new(|_| ControlFlow::Break(()));
    assert!(matches!(
        Video::open_with_progress(&path, &impatient),
        Err(MediaError::Stopped { .. })
    ));
    assert_eq!(open().0.info().decoded_frames, 120);
}

fn who_waits_for_a_video_is_told_and_may_give_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gap.mkv");
    ffmpeg(
        folder.path(),
        &format!("{CARD} -vf select='not(between(n,40,44))' -vsync vfr -c:v libx264 gap.mkv"),
    );
    let (counting, begun) = channel();
    let (go_on, paused) = channel::<()>();
    let path = path.as_path();
    std::thread::scope(|threads| {
        let first = threads.spawn(move || {
            let paused = Mutex::new(paused);
            let progress = Progress::new(move |_| {
                counting.send(()).unwrap();
                paused.lock().unwrap().recv().unwrap_or_default();
                ControlFlow::Continue(())
            });
            Video::open_with_progress(path, &progress).map(|video| video.info().decoded_frames)
        });
        begun.recv().unwrap();
        let told = Mutex::new(Vec::new());
        let impatient = Progress::new(|step: CountProgress| {
            told.lock().unwrap().push(step.counted);
            ControlFlow::Break(())
        });
        let waiting = Video::open_with_progress(path, &impatient);
        assert!(matches!(waiting, Err(MediaError::Stopped { .. })));
        let told = told.lock().unwrap();
        assert!(told.len() == 1 && told[0] > 0, "{told:?}");
        drop(go_on);
        assert_eq!(first.join().unwrap().unwrap(), 145);
    });
    let known = Video::open_with_progress(path, &Progress::new(|_| panic!("examined again")));
    assert_eq!(known.unwrap().info().decoded_frames, 145);
}

fn the_times_of_an_uneven_mp4_are_read_from_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let gap = "-vf select='not(between(n,90,94))' -vsync vfr -c:v libx264 -g 50";
    ffmpeg(folder.path(), &format!("{CARD} {gap} gap.mp4"));
    ffmpeg(
        folder.path(),
        "-i gap.mp4 -c copy -movflags frag_keyframe+empty_moov fragmented.mp4",
    );
    ffmpeg(folder.path(), "-i gap.mp4 -c copy gap.mkv");
    let visited = |name: &str| {
        let (counting, told) = count_reports();
        let video = Video::open_with_progress(&folder.path().join(name), &counting);
        (video.unwrap().info().clone(), told.load(Ordering::Relaxed))
    };
    let (by_table, told) = visited("gap.mp4");
    assert_eq!((by_table.decoded_frames, told), (145, 0));
    let (played, told) = visited("gap.mkv");
    assert!(told > 0, "every frame is visited");
    // The decoder does not tell the times of the last frames.
    for index in 0..140 {
        let [by_table, played] = [&by_table, &played].map(|info| info.pts_s(index).unwrap());
        assert!(
            (by_table - played).abs() < 2e-3,
            "{index}: {by_table} {played}"
        );
    }
    assert!(
        visited("fragmented.mp4").1 > 0,
        "a fragmented file has no table of all its samples"
    );
    assert_numbers_hold(&folder.path().join("gap.mp4"), 30);
}

fn a_video_cut_off_ends_where_it_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    ffmpeg(
        folder.path(),
        &format!("{CARD} -c:v libx264 -g 50 -movflags +faststart whole.mp4"),
    );
    let bytes = std::fs::read(folder.path().join("whole.mp4")).unwrap();
    let path = folder.path().join("half.mp4");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let video = assert_numbers_hold(&path, 20);
    let decoded = video.info().decoded_frames;
    assert!((40..120).contains(&decoded), "{decoded}");
    let expected = format!(
        "half.mp4 announces 150 frames; only {decoded} can be decoded. Frames are numbered as decoded."
    );
    assert_eq!(video.info().notices[0].to_string(), expected);
}

fn a_video_on_its_side_is_turned_upright() {
    let folder = tempfile::tempdir().unwrap();
    ffmpeg(folder.path(), &format!("{CARD} -c:v libx264 even.mp4"));
    // Since version 6, and before it.
    let turned = ffmpeg_can(
        folder.path(),
        "-display_rotation:v:0 -90 -i even.mp4 -c copy turned.mp4",
    ) || ffmpeg_can(
        folder.path(),
        "-i even.mp4 -c copy -metadata:s:v:0 rotate=90 turned.mp4",
    );
    assert!(turned);
    // OpenCV before 4.7 turns what ffmpeg 5 writes the other way, against every player.
    let path = folder.path().join("turned.mp4");
    let turned = Video::open_with(&path, VideoBackend::Ffmpeg, &Progress::default()).unwrap();
    let mut turned = assert_numbers_hold_in(turned, VideoBackend::Ffmpeg, 5);
    assert_eq!(turned.info().size, ImageSize::new(90, 160));
    // Which way it is turned differs between the versions of ffmpeg that make it; the picture has
    // to agree with what is said.
    let even = Video::open(&folder.path().join("even.mp4"))
        .unwrap()
        .frame(40)
        .unwrap();
    let picture = turned.frame(40).unwrap();
    for (x, y) in [(3, 5), (80, 20), (40, 150)] {
        let (stored_x, stored_y) = match turned.info().rotation_deg {
            90 => (y, 89 - x),
            270 => (159 - y, x),
            other => panic!("turned by {other}°"),
        };
        let pairs = picture
            .pixel(x, y)
            .unwrap()
            .into_iter()
            .zip(even.pixel(stored_x, stored_y).unwrap());
        assert!(
            pairs
                .into_iter()
                .all(|(turned, even)| turned.abs_diff(even) <= 40),
            "({x}, {y})"
        );
    }
}

fn pixels_that_are_not_square_are_made_square() {
    let folder = tempfile::tempdir().unwrap();
    for (name, aspect) in [
        ("even", "1"),
        ("wide", "4/3"),
        ("high", "3/4"),
        ("absurd", "99"),
    ] {
        let filter = format!("{CARD} -vf setsar={aspect} -c:v libx264 {name}.mp4");
        ffmpeg(folder.path(), &filter);
    }
    let open = |name: &str| Video::open(&folder.path().join(name)).unwrap();
    let mut even = open("even.mp4");
    let stored = even.frame(3).unwrap();
    for (name, size) in [
        ("wide.mp4", ImageSize::new(213, 90)),
        ("high.mp4", ImageSize::new(160, 120)),
        ("absurd.mp4", ImageSize::new(160, 90)),
    ] {
        let mut video = open(name);
        assert_eq!(video.info().size, size, "{name}");
        let picture = video.frame(3).unwrap();
        assert_eq!(picture.size(), size, "{name}");
        let [wider, higher] = [size.width as f32 / 160.0, size.height as f32 / 90.0];
        for (x, y) in [(8_u32, 8_u32), (75, 40), (150, 80)] {
            let shown = [x as f32 * wider, y as f32 * higher].map(|px| px.round() as u32);
            let shown = picture.pixel(shown[0], shown[1]).unwrap();
            let same = stored.pixel(x, y).unwrap();
            let is_same = shown
                .into_iter()
                .zip(same)
                .all(|(a, b)| a.abs_diff(b) <= 40);
            assert!(is_same, "{name} ({x}, {y}): {shown:?} for {same:?}");
        }
    }
    let wide = open("wide.mp4");
    assert_eq!(
        wide.info().notices[0].to_string(),
        "wide.mp4: its pixels are not square. Frames of 160 × 90 px are used as 213 × 90 px, and all coordinates are of these."
    );
}

/// The cuts of a video, as the window looks for them.
fn cuts(path: &Path) -> FoundShots {
    let search = ShotSearch {
        video: "match.mp4".to_owned(),
        path: path.to_path_buf(),
        num_below: 0,
        known: Vec::new(),
    };
    search
        .look(&mut FrameReader::new(), &Progress::default())
        .unwrap()
}

fn the_cuts_of_a_video_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = "-f lavfi -i testsrc2=size=160x90:rate=25:duration=2 -f lavfi -i testsrc=size=160x90:rate=25 \
                  -f lavfi -i smptehdbars=size=160x90:rate=25:duration=2";
    let joined = "[1:v]trim=duration=2,setpts=PTS-STARTPTS[b];[0:v][b]concat,settb=1/25[c];[c][2:v]xfade=duration=0.6:offset=3.4";
    ffmpeg(
        folder.path(),
        &format!("{scenes} -filter_complex {joined} -c:v libx264 -g 50 -pix_fmt yuv420p cuts.mp4"),
    );
    let found = cuts(&folder.path().join("cuts.mp4"));
    let [
        (50, ShotKind::Cut),
        (from, ShotKind::Transition),
        (fade, ShotKind::Fade),
    ] = found.cuts[..]
    else {
        panic!("{found:?}")
    };
    // It begins with frame 85 and lasts 15.
    assert!(
        from.abs_diff(85) <= 3 && fade.abs_diff(100) <= 3,
        "{from}..{fade}"
    );
    assert_eq!(found.last, 134);
}

fn joined_clips_have_their_shots_and_transitions() {
    use ShotKind::{Cut, Fade, Transition};
    let folder = tempfile::tempdir().unwrap();
    let data = frames_folder();
    let inputs = [
        "video-soccer/match.mp4",
        "wild/two-shots-360p.mp4",
        "wild/chelsea-milan.mp4",
    ]
    .map(|name| format!("-i {}", data.join(name).display()))
    .join(" ");
    // A shot of the main camera, a cut to a close-up, a dissolve to the main camera, a cut to
    // another stadium, a wipe to the first one.
    let same = "setpts=PTS-STARTPTS,scale=640:360,fps=25,format=yuv420p,settb=1/25,setsar=1";
    let part = |from: &str, frames: [usize; 2], to: &str| {
        let [start, end] = frames;
        format!("[{from}]trim=start_frame={start}:end_frame={end},{same}[{to}];")
    };
    let parts = [
        "[0:v]split=3[m1][m2][m3];".to_owned(),
        part("m1", [0, 150], "a"),
        part("1:v", [484, 580], "b"),
        part("m2", [400, 560], "c"),
        part("2:v", [0, 100], "d"),
        part("m3", [640, 800], "e"),
    ]
    .concat();
    let joined = "[a][b]concat,settb=1/25[ab];\
                  [ab][c]xfade=transition=fade:duration=0.6:offset=8[abc];\
                  [abc][d]concat,settb=1/25[abcd];\
                  [abcd][e]xfade=transition=wipeleft:duration=0.6:offset=17.12[o]";
    ffmpeg(
        folder.path(),
        &format!("{inputs} -filter_complex {parts}{joined} -map [o] -c:v libx264 joined.mp4"),
    );
    let found = cuts(&folder.path().join("joined.mp4")).cuts;
    let kinds: Vec<ShotKind> = found.iter().map(|(_, kind)| *kind).collect();
    assert_eq!(
        kinds,
        [Cut, Transition, Fade, Cut, Transition, Fade],
        "{found:?}"
    );
    for ((frame, _), joined) in found.iter().zip([150, 200, 215, 360, 428, 443]) {
        assert!(frame.abs_diff(joined) <= 3, "{found:?}");
    }
}

fn a_match_without_a_cut_has_one_shot() {
    // The second one has two flashes of photographers and a fast zoom.
    for (video, last) in [
        ("video-soccer/match.mp4", 816),
        ("video-basketball/clip.mp4", 308),
    ] {
        assert_eq!(
            cuts(&frames_folder().join(video)),
            FoundShots {
                last,
                cuts: Vec::new()
            },
            "{video}"
        );
    }
}

fn interlaced_frames_are_shown_without_a_comb() {
    let folder = tempfile::tempdir().unwrap();
    let card = "-f lavfi -i testsrc2=size=320x576:rate=50:duration=4 -vf scroll=horizontal=0.01";
    ffmpeg(
        folder.path(),
        &format!("{card},interlace=lowpass=0 -c:v libx264 -flags +ildct+ilme interlaced.mp4"),
    );
    ffmpeg(
        folder.path(),
        &format!("{card} -c:v libx264 progressive.mp4"),
    );
    let mut progressive = Video::open(&folder.path().join("progressive.mp4")).unwrap();
    assert!(!progressive.info().interlaced && progressive.info().notices.is_empty());
    let mut video = Video::open(&folder.path().join("interlaced.mp4")).unwrap();
    assert!(video.info().interlaced);
    assert_eq!(
        video.info().notices[0].to_string(),
        "interlaced.mp4 is interlaced: only the first field of each picture is used, which has half of its lines."
    );
    // The first field is that of every other frame, before it was interlaced.
    let (shown, truth) = (video.frame(40).unwrap(), progressive.frame(80).unwrap());
    // Colours are stored coarser: the brightness is compared.
    let grey = |picture: &Picture, x: u32, y: u32| {
        let [red, green, blue, _] = picture.pixel(x, y).unwrap().map(f64::from);
        0.299 * red + 0.587 * green + 0.114 * blue
    };
    let places = (0..576)
        .step_by(2)
        .flat_map(|y| (0..320).map(move |x| (x, y)));
    let off: f64 = places
        .map(|(x, y)| (grey(&shown, x, y) - grey(&truth, x, y)).abs())
        .sum();
    let mean_off = off / (320.0 * 288.0);
    assert!(mean_off < 3.0, "{mean_off}");
}

/// A video whose every frame is of one grey: twice its number, from black on.
fn grey_video(folder: &Path, frames: usize) -> PathBuf {
    let path = folder.join("grey é.avi");
    let shades = "-f lavfi -i color=black:size=64x48:rate=25,format=gray,geq=lum='2*N'";
    ffmpeg(
        folder,
        &format!(
            "{shades} -frames:v {frames} -c:v mjpeg -q:v 2 {}",
            "grey~é.avi"
        ),
    );
    path
}

fn a_video_is_a_source_of_numbered_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = grey_video(folder.path(), 100);
    let source = FrameSource::open(&path).unwrap();
    assert_eq!((source.len(), source.notices()), (100, [].as_slice()));
    assert_eq!(source.frame(99), Some(FrameRef::video(path.as_path(), 99)));
    assert_eq!(source.frame(100), None);
    let mut video = assert_numbers_hold(&path, 20);
    let shade = video.frame(70).unwrap().pixel(20, 20).unwrap()[0];
    assert!(shade.abs_diff(140) <= 2, "{shade}");
}

fn a_match_states_825_frames_and_has_817() {
    let data = frames_folder();
    let path = data.join("video-soccer/match.mp4");
    let video = assert_numbers_hold(&path, 12);
    let info = video.info();
    assert_eq!(
        (info.stated_frames, info.decoded_frames, info.fps),
        (825, 817, 25.0)
    );
    assert_eq!(info.size, ImageSize::new(1280, 720));
    assert_eq!(
        (info.pts_s(412), info.pts_s(816), info.pts_s(817)),
        (Some(16.48), Some(32.64), None)
    );
    assert_eq!(
        info.notices
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>(),
        [
            "match.mp4 announces 825 frames; only 817 can be decoded. Frames are numbered as decoded."
        ]
    );
}
