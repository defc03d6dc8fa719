//! Broken videos: each gets one clear line, none brings the program down.

use crate::files::{behind_path, cut, written};
use crate::parts::{Test, tests};
use std::path::Path;
use std::process::Command;
use touchline::media::{MediaError, Video};

pub const TESTS: &[Test] = tests![
    [Ffmpeg] each_broken_video_has_its_message;
    [Ffmpeg] a_video_cut_off_is_read_as_far_as_it_goes;
    [Ffmpeg] frames_behind_damaged_ones_keep_their_numbers;
];

/// What ffmpeg makes.
fn made(folder: &Path, name: &str, arguments: &str) -> Vec<u8> {
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

fn filled(mut bytes: Vec<u8>, range: std::ops::Range<usize>, with: u8) -> Vec<u8> {
    bytes[range].fill(with);
    bytes
}

/// What opening a video and reading its first, middle and last frame comes to, behind the file's
/// path.
fn said(folder: &Path, name: &str, path: &Path) -> String {
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
    const NO_FRAMES: &str = "no frame of this video can be decoded; copy it again from where it came or convert it to MP4 (H.264)";
    const TOO_WIDE: &str =
        "states 20000 × 16 px, the limit is 16384 px a side and 100 megapixels; scale it down";
    const WHOLE: &str = "read, 100 frames";

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("folder.mp4")).unwrap();
    let make = |name: &str, arguments: &str| made(folder, name, arguments);
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
        ("zeros.mp4", Some(vec![0; 100_000]), NOT_A_VIDEO),
        ("noise.mp4", Some(noise), NOT_A_VIDEO),
        ("no-index.mp4", Some(cut(&mp4, moov)), NOT_A_VIDEO),
        (
            "half-index.mp4",
            Some(cut(&mp4, moov + (mp4.len() - moov) / 2)),
            NOT_A_VIDEO,
        ),
        ("no-data.mp4", Some(cut(&fast, mdat + 8)), NO_FRAMES),
        ("type-only.mp4", Some(cut(&mp4, 24)), NOT_A_VIDEO),
        (
            "blank-data.mp4",
            Some(filled(fast.clone(), mdat + 8..fast.len(), 0)),
            NO_FRAMES,
        ),
        (
            "blank-index.mp4",
            Some(filled(mp4.clone(), moov + 8..mp4.len(), 0)),
            NOT_A_VIDEO,
        ),
        (
            "unknown-codec.mp4",
            Some(filled(fast.clone(), codec + 4..codec + 8, b'z')),
            NOT_A_VIDEO,
        ),
        ("wide.avi", Some(wide), TOO_WIDE),
        ("sound.mp4", Some(sound), NOT_A_VIDEO),
        ("sound.wav", Some(wav), NOT_A_VIDEO),
        ("header-only.mkv", Some(cut(&mkv, 40)), NOT_A_VIDEO),
        ("header-only.avi", Some(cut(&avi, 200)), NOT_A_VIDEO),
        // Not broken, only odd.
        (
            "wrong-stated-size.mp4",
            Some(filled(fast, codec + 32..codec + 36, 0xff)),
            WHOLE,
        ),
        ("picture.mp4", Some(picture()), "read, 1 frames"),
        ("other-name.jpg", Some(mp4.clone()), WHOLE),
        ("no-ending", Some(mp4.clone()), WHOLE),
        ("a:colon 100% é.mp4", Some(mp4.clone()), WHOLE),
        ("trailing.mp4", Some([mp4, vec![7; 1000]].concat()), WHOLE),
    ] {
        let path = bytes.map_or_else(|| folder.join(name), |bytes| written(folder, name, &bytes));
        assert_eq!(said(folder, name, &path), expected, "{name}");
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
    let mp4 = made(folder, "fast.mp4", &format!("{CARD} -movflags +faststart"));
    let mkv = made(folder, "a.mkv", CARD);
    let mdat = box_at(&mp4, *b"mdat");
    for (name, bytes) in [
        ("half.mp4", cut(&mp4, mdat + (mp4.len() - mdat) / 2)),
        ("first-frames.mp4", cut(&mp4, mdat + 4000)),
        ("half.mkv", cut(&mkv, mkv.len() / 2)),
    ] {
        let path = written(folder, name, &bytes);
        // How many frames are left depends on the encoder.
        let frames = Video::open(&path).unwrap().info().decoded_frames;
        assert!((1..80).contains(&frames), "{name}: {frames}");
        let notice =
            format!("{name} states 100 frames, {frames} decode. Numbering follows decoded frames.");
        assert_eq!(
            said(folder, name, &path),
            format!("read, {frames} frames; {notice}")
        );
    }
}

fn frames_behind_damaged_ones_keep_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let card = "-f lavfi -i testsrc2=size=160x90:rate=25:duration=12 -c:v libx264 -g 25 -movflags +faststart";
    let whole = made(folder, "whole.mp4", card);
    let mdat = box_at(&whole, *b"mdat");
    let data = whole.len() - mdat;
    let blanked = filled(whole.clone(), mdat + data / 2..mdat + data * 6 / 10, 0);
    let mut whole = Video::open(&written(folder, "whole.mp4", &whole)).unwrap();
    let mut blanked = Video::open(&written(folder, "blanked.mp4", &blanked)).unwrap();
    assert_eq!(
        (whole.info().decoded_frames, blanked.info().decoded_frames),
        (300, 300)
    );
    let frames: Vec<_> = (0..300)
        .rev()
        .step_by(3)
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
    assert!((1..40).contains(&damaged), "{damaged}");
}
