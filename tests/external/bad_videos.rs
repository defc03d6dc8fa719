//! Broken videos: each gets one clear line, none brings the program down.

use crate::parts::{Test, tests};
use crate::program::touchline;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use touchline::geometry::ImageSize;
use touchline::media::{MediaError, Video, VideoBackend, load_image};
use touchline_core::testing::files::{behind_path, cut, new_file};

pub const TESTS: &[Test] = tests![
    [Ffmpeg] each_broken_video_has_its_message;
    [Ffmpeg] a_video_cut_off_is_read_as_far_as_it_goes;
    [Ffmpeg] frames_behind_damaged_ones_keep_their_numbers;
    [Ffmpeg] an_ffmpeg_that_dies_or_hangs_costs_one_line_and_nothing_else;
    [Ffmpeg] a_path_that_begins_with_a_dash_is_a_path;
    [Ffmpeg] frames_of_8k_are_read;
    [Ffmpeg] json_names_what_reads_the_video;
];

/// What ffmpeg makes.
fn run_ffmpeg(folder: &Path, name: &str, arguments: &str) -> Vec<u8> {
    let path = folder.join(format!("made-{name}"));
    let status = Command::new("ffmpeg")
        .args(["-v", "error", "-y"])
        .args(arguments.split(' '))
        .arg(&path)
        .status();
    assert!(status.unwrap().success(), "ffmpeg makes {name}");
    std::fs::read(path).unwrap()
}

/// The place of a box of an MP4 file, by its four letters.
fn box_at(bytes: &[u8], kind: [u8; 4]) -> usize {
    bytes.windows(4).position(|window| *window == kind).unwrap() - 4
}

fn fill_range(mut bytes: Vec<u8>, range: std::ops::Range<usize>, with: u8) -> Vec<u8> {
    bytes[range].fill(with);
    bytes
}

/// What opening a video and reading its first, middle and last frame comes to, behind the file's
/// path.
fn outcome_of(folder: &Path, name: &str, path: &Path) -> String {
    let outcome = Video::open(path).and_then(|mut video| {
        let frames = video.info().decoded_frames;
        for index in [0, frames / 2, frames - 1] {
            video.frame(index)?;
        }
        let notices = video
            .info()
            .notices
            .iter()
            .map(|notice| format!("; {notice}"));
        Ok(format!(
            "read, {frames} frames{}",
            notices.collect::<String>()
        ))
    });
    outcome.unwrap_or_else(|error| behind_path(folder, name, &error))
}

/// A test card of 100 frames as H.264.
const CARD: &str = "-f lavfi -i testsrc2=size=160x90:rate=25:duration=4 -c:v libx264 -g 25";

fn each_broken_video_has_its_message() {
    const MISSING: &str = "there is no such file; check whether it was moved or renamed";
    const NOT_A_FILE: &str = "this is not a file; give the path of an image or a video";
    const EMPTY: &str = "the file is empty (0 bytes); copy it again from where it came";
    const NOT_A_VIDEO: &str = "not a video that can be read; convert it to MP4 (H.264)";
    const NO_FRAMES: &str = "no frame of this video can be decoded; copy it again from where it \
                             came or convert it to MP4 (H.264)";
    const TOO_WIDE: &str =
        "states 20000 × 16 px, the limit is 16384 px a side and 100 megapixels; scale it down";
    const WHOLE: &str = "read, 100 frames";

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("folder.mp4")).unwrap();
    let make = |name: &str, arguments: &str| run_ffmpeg(folder, name, arguments);
    let mp4 = make("a.mp4", CARD);
    let fast = make("fast.mp4", &format!("{CARD} -movflags +faststart"));
    let mkv = make("a.mkv", CARD);
    let avi = make(
        "a.avi",
        "-f lavfi -i testsrc2=size=160x90:rate=25:duration=4 -c:v mjpeg",
    );
    let sound = make("sound.mp4", "-f lavfi -i sine=duration=1");
    let wav = make("sound.wav", "-f lavfi -i sine=duration=1");
    let wide = make(
        "wide.avi",
        "-f lavfi -i color=size=20000x16:duration=0.2 -c:v mjpeg",
    );
    let (moov, mdat) = (box_at(&mp4, *b"moov"), box_at(&fast, *b"mdat"));
    // The box that names the codec, the first in the table of sample descriptions; the size stands
    // 32 bytes behind.
    let codec = box_at(&fast, *b"stsd") + 16;
    let concat_list = b"ffconcat version 1.0\nfile made-a.mp4\n";
    let play_list = b"#EXTM3U\n#EXT-X-TARGETDURATION:4\n#EXTINF:4,\nmade-a.mp4\n#EXT-X-ENDLIST\n";
    // Demuxers of lists that `ffmpeg` would guess, although a byte in them is no text.
    let marked_list =
        b"#EXTM3U\n#\x01\n#EXT-X-TARGETDURATION:4\n#EXTINF:4,\nmade-a.mp4\n#EXT-X-ENDLIST\n";
    let noise = (0..100_000_u32)
        .map(|index| (index.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    for (name, bytes, expected) in [
        ("missing.mp4", None, MISSING),
        ("folder.mp4", None, NOT_A_FILE),
        ("empty.mp4", Some(Vec::new()), EMPTY),
        ("one-byte.mp4", Some(vec![0]), NOT_A_VIDEO),
        (
            "text.mp4",
            Some(b"just some words, no video".to_vec()),
            NOT_A_VIDEO,
        ),
        (
            "text.txt",
            Some("just some words, no video\n".repeat(50).into_bytes()),
            NOT_A_VIDEO,
        ),
        ("list.ffconcat", Some(concat_list.to_vec()), NOT_A_VIDEO),
        ("list.m3u8", Some(play_list.to_vec()), NOT_A_VIDEO),
        ("marked-list.mp4", Some(marked_list.to_vec()), NOT_A_VIDEO),
        ("zeros.mp4", Some(vec![0; 100_000]), NOT_A_VIDEO),
        ("noise.mp4", Some(noise), NOT_A_VIDEO),
        ("no-index.mp4", Some(cut(&mp4, moov)), NO_FRAMES),
        (
            "half-index.mp4",
            Some(cut(&mp4, moov + (mp4.len() - moov) / 2)),
            NO_FRAMES,
        ),
        ("no-data.mp4", Some(cut(&fast, mdat + 8)), NO_FRAMES),
        ("type-only.mp4", Some(cut(&mp4, 24)), NO_FRAMES),
        (
            "blank-data.mp4",
            Some(fill_range(fast.clone(), mdat + 8..fast.len(), 0)),
            NO_FRAMES,
        ),
        (
            "blank-index.mp4",
            Some(fill_range(mp4.clone(), moov + 8..mp4.len(), 0)),
            NO_FRAMES,
        ),
        (
            "unknown-codec.mp4",
            Some(fill_range(fast.clone(), codec + 4..codec + 8, b'z')),
            NO_FRAMES,
        ),
        ("wide.avi", Some(wide), TOO_WIDE),
        ("sound.mp4", Some(sound), NO_FRAMES),
        ("sound.wav", Some(wav), NOT_A_VIDEO),
        ("header-only.mkv", Some(cut(&mkv, 40)), NO_FRAMES),
        ("header-only.avi", Some(cut(&avi, 200)), NO_FRAMES),
        // Not broken, only odd.
        (
            "wrong-stated-size.mp4",
            Some(fill_range(fast, codec + 32..codec + 36, 0xff)),
            WHOLE,
        ),
        ("picture.mp4", Some(picture()), "read, 1 frames"),
        ("other-name.jpg", Some(mp4.clone()), WHOLE),
        ("no-ending", Some(mp4.clone()), WHOLE),
        ("a:colon 100% é.mp4", Some(mp4.clone()), WHOLE),
        ("trailing.mp4", Some([mp4, vec![7; 1000]].concat()), WHOLE),
    ] {
        let path = bytes.map_or_else(|| folder.join(name), |bytes| new_file(folder, name, &bytes));
        assert_eq!(outcome_of(folder, name, &path), expected, "{name}");
    }
}

fn picture() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(160, 90)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

fn a_video_cut_off_is_read_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mp4 = run_ffmpeg(folder, "fast.mp4", &format!("{CARD} -movflags +faststart"));
    let mkv = run_ffmpeg(folder, "a.mkv", CARD);
    let mdat = box_at(&mp4, *b"mdat");
    for (name, bytes) in [
        ("half.mp4", cut(&mp4, mdat + (mp4.len() - mdat) / 2)),
        ("first-frames.mp4", cut(&mp4, mdat + 4000)),
        ("half.mkv", cut(&mkv, mkv.len() / 2)),
    ] {
        let path = new_file(folder, name, &bytes);
        // How many frames are left depends on the encoder.
        let frames = Video::open(&path).unwrap().info().decoded_frames;
        assert!((1..80).contains(&frames), "{name}: {frames}");
        let notice = format!(
            "{name} announces 100 frames; only {frames} can be decoded. Frames are numbered as decoded."
        );
        assert_eq!(
            outcome_of(folder, name, &path),
            format!("read, {frames} frames; {notice}")
        );
    }
}

fn frames_behind_damaged_ones_keep_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let card = "-f lavfi -i testsrc2=size=160x90:rate=25:duration=12 -c:v libx264 -g 25 \
                -movflags +faststart";
    let whole = run_ffmpeg(folder, "whole.mp4", card);
    let mdat = box_at(&whole, *b"mdat");
    let data = whole.len() - mdat;
    let blanked = fill_range(whole.clone(), mdat + data / 2..mdat + data * 6 / 10, 0);
    let mut whole = Video::open(&new_file(folder, "whole.mp4", &whole)).unwrap();
    let mut blanked = Video::open(&new_file(folder, "blanked.mp4", &blanked)).unwrap();
    assert_eq!(
        (whole.info().decoded_frames, blanked.info().decoded_frames),
        (300, 300)
    );
    let frames: Vec<_> = (0..300)
        .rev()
        .step_by(7)
        .map(|index| (index, blanked.frame(index)))
        .collect();
    let mut damaged = 0;
    for (index, picture) in frames {
        match picture {
            // Until the next key frame a decoder makes up what is missing.
            Ok(picture) if !(100..=220).contains(&index) => {
                assert_eq!(picture, whole.frame(index).unwrap(), "{index}");
            }
            Ok(_) => {}
            Err(MediaError::DamagedFrame { index: named, .. }) => {
                assert_eq!(named, index);
                assert!((100..=220).contains(&index), "{index}");
                damaged += 1;
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert!((1..18).contains(&damaged), "{damaged}");
}

/// The path of a program, as a shell finds it.
fn path_of(program: &str) -> String {
    let script = format!("command -v {program}");
    let found = Command::new("sh").args(["-c", &script]).output().unwrap();
    String::from_utf8(found.stdout).unwrap().trim().to_owned()
}

/// Starts the program in a folder, with a shell script in place of `ffmpeg` or `ffprobe`. In it
/// `REAL "$@"` does what the replaced program would do; its version is stated as ever.
#[cfg(unix)]
fn start_with(folder: &Path, replaced: &str, script: &str, arguments: &str) -> Child {
    use std::os::unix::fs::PermissionsExt as _;
    let real = path_of(replaced);
    let script = script.replace("REAL", &real);
    let text =
        format!("#!/bin/sh\nif [ \"$1\" = -version ]; then exec {real} \"$@\"; fi\n{script}\n");
    let bin = tempfile::tempdir_in(folder).unwrap().keep();
    let file = new_file(&bin, replaced, text.as_bytes());
    std::fs::set_permissions(file, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var("PATH").unwrap();
    Command::new(env!("CARGO_BIN_EXE_touchline"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", bin.display()))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The command lines of running programs that name a folder.
#[cfg(target_os = "linux")]
fn find_running(folder: &Path) -> Vec<String> {
    let processes = std::fs::read_dir("/proc").unwrap();
    processes
        .filter_map(|process| std::fs::read(process.ok()?.path().join("cmdline")).ok())
        .map(|line| String::from_utf8_lossy(&line).replace('\0', " "))
        .filter(|line| line.contains(&*folder.to_string_lossy()))
        .collect()
}

/// The decoder hangs before its first frame, after 40 frames, or where it describes the video, and
/// dies at the same places. All at once, because each hanging one is given 30 s.
fn an_ffmpeg_that_dies_or_hangs_costs_one_line_and_nothing_else() {
    #[cfg(unix)]
    {
        const HANG: &str = "exec sleep 1000";
        const DIE: &str = "kill -9 $$";
        const SILENT: &str = "it gave nothing for 30 s";
        const KILLED: &str = "it was ended: signal: 9 (SIGKILL)";
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        new_file(folder, "a.mp4", &run_ffmpeg(folder, "a.mp4", CARD));
        // 40 frames of 160 × 90 px, RGBA.
        let some_frames = format!("REAL \"$@\" | head -c {}", 40 * 160 * 90 * 4);
        let cases = [
            ("ffmpeg", HANG.to_owned(), SILENT),
            ("ffmpeg", format!("{some_frames}; {HANG}"), SILENT),
            ("ffprobe", HANG.to_owned(), SILENT),
            ("ffmpeg", DIE.to_owned(), KILLED),
            ("ffmpeg", format!("{some_frames}; {DIE}"), KILLED),
            ("ffprobe", DIE.to_owned(), KILLED),
        ];
        // Each into a project of its own, which it would replace.
        let projects: Vec<(PathBuf, Vec<u8>)> = (0..cases.len())
            .map(|case| {
                let new = format!("new made{case} --field soccer --frames a.mp4");
                touchline(folder, &new).done();
                let file = folder.join(format!("made{case}/project.json"));
                let bytes = std::fs::read(&file).unwrap();
                (file, bytes)
            })
            .collect();
        let children: Vec<Child> = cases
            .iter()
            .enumerate()
            .map(|(case, (replaced, script, _))| {
                let calibrate = format!("calibrate a.mp4 -o made{case} --force");
                start_with(folder, replaced, script, &calibrate)
            })
            .collect();
        for ((replaced, script, reason), child) in cases.iter().zip(children) {
            let output = child.wait_with_output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            let expected = format!(
                "touchline: a.mp4: {replaced} broke down while reading it ({reason}); \
                 open the video again\n"
            );
            assert_eq!(
                (output.status.code(), said),
                (Some(2), expected),
                "{script}"
            );
        }
        for (file, before) in projects {
            assert_eq!(before, std::fs::read(file).unwrap());
        }
        #[cfg(target_os = "linux")]
        assert_eq!(find_running(folder), [""; 0]);
    }
}

fn a_path_that_begins_with_a_dash_is_a_path() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    new_file(folder, "-a.mp4", &run_ffmpeg(folder, "a.mp4", CARD));
    std::fs::create_dir(folder.join("-pictures")).unwrap();
    new_file(folder, "-pictures/-1.png", &picture());
    for (frames, count) in [
        ("-a.mp4", "100 frames"),
        ("-pictures", "1 frame"),
        ("-pictures/-1.png", "1 frame"),
    ] {
        let ran = touchline(
            folder,
            &format!("new --field soccer --frames={frames} --force -- -made"),
        );
        assert_eq!(ran.code, 0, "{frames}: {}", ran.stderr);
        assert!(
            ran.stderr.ends_with(&format!(": {count}\n")),
            "{}",
            ran.stderr
        );
    }
}

fn frames_of_8k_are_read() {
    const SIZE: ImageSize = ImageSize::new(7680, 4320);
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let card = "-f lavfi -i testsrc2=size=7680x4320:rate=25 -frames:v";
    run_ffmpeg(
        folder,
        "8k.mp4",
        &format!("{card} 3 -c:v libx264 -preset ultrafast -pix_fmt yuv420p"),
    );
    run_ffmpeg(folder, "8k.jpg", &format!("{card} 1 -update 1"));
    let mut video = Video::open(&folder.join("made-8k.mp4")).unwrap();
    assert_eq!((video.info().decoded_frames, video.info().size), (3, SIZE));
    assert_eq!(video.frame(2).unwrap().size(), SIZE);
    let image = load_image(&folder.join("made-8k.jpg")).unwrap();
    assert_eq!(image.size(), SIZE);
    // A test card shows no field: one line says so, and no project is made.
    let ran = touchline(folder, "calibrate made-8k.mp4 -o found");
    ran.assert_refused(1);
    assert!(!folder.join("found").exists());
}

fn json_names_what_reads_the_video() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    new_file(folder, "a.mp4", &run_ffmpeg(folder, "a.mp4", CARD));
    let backend = VideoBackend::available().next().unwrap();
    let line = format!(r#"{{"level":"note","message":"videos are read by {backend}"}}"#);
    let ran = touchline(folder, "--json new made --field soccer --frames a.mp4").done();
    assert!(
        ran.stderr.lines().any(|said| said == line),
        "{}",
        ran.stderr
    );
    let text = touchline(folder, "new made --field soccer --frames a.mp4 --force");
    assert!(!text.stderr.contains("read by"), "{}", text.stderr);
}
