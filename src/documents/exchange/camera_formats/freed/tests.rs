//! Packets and tables written and read back, and damaged streams.

use super::FreeD;
use super::sample::{PACKET, Sample, checksum};
use crate::document::{Document, Frame, VideoFrame};
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::files::Files;
use crate::exchange::format::Format;
use crate::exchange::options::{ImportOptions, Zoom};
use crate::exchange::tests::{SIZE, awkward, document, export_as, reference, text_of};
use touchline_core::camera::{BaseAngles, CameraBase};
use touchline_core::geometry::Vec3;

#[test]
fn the_reference_camera_is_the_published_packet() {
    let exported = export_as(&reference(), Format::FreeD);
    let packet = exported.files.get("camera.freed").unwrap();
    let hex: Vec<String> = packet.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(
        hex.join(" "),
        "d1 01 06 40 00 fa 66 66 00 00 00 00 00 00 c5 68 00 11 94 00 00 09 6a 00 00 00 00 00 1d"
    );
    assert!(exported.worst_px < 2e-3, "{}", exported.worst_px);
}

#[test]
fn a_captured_packet_is_read_as_published() {
    let mut packet = vec![0xd1, 0x00, 0xdf, 0x78, 0xaa, 0x00, 0x47, 0xef];
    packet.extend([0; 12]);
    packet.extend([0x00, 0x40, 0x00, 0x00, 0x15, 0x01, 0xd1, 0xff, 0x12]);
    let sample = Sample::from_packet(&packet).unwrap();
    assert!(
        (sample.angles_deg[0] + 65.05731).abs() < 1e-5
            && (sample.angles_deg[1] - 0.56198).abs() < 1e-5
    );
    assert_eq!(sample.zoom_raw, 16384.0);
}

#[test]
fn awkward_cameras_come_back_within_half_a_step() {
    let exported = export_as(&awkward(), Format::FreeD);
    assert!(exported.worst_px < 7e-3, "{}", exported.worst_px);
    let table = export_as(&awkward(), Format::FreeDCsv);
    assert!(table.worst_px < 1e-6, "{}", table.worst_px);
    assert!(
        text_of(&table.files, "camera.csv")
            .lines()
            .nth(1)
            .unwrap()
            .starts_with("412,16.48,00:00:16:12,1,")
    );
}

#[test]
fn a_wide_picture_moves_by_more_than_a_step_at_its_border_and_is_written() {
    let base = CameraBase::new(
        Vec3::new(0.0, -60.0, 18.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let wide = document(&base, &[(-10.0000137, -11.2, 700.0)]);
    let exported = export_as(&wide, Format::FreeD);
    assert!(exported.worst_px < 1e-2, "{}", exported.worst_px);
}

#[test]
fn the_zoom_follows_a_table_either_way() {
    let zoom = Zoom::Table(vec![(0.0, 1000.0), (4096.0, 9192.0)]);
    assert_eq!(zoom.raw(3048.0, SIZE, None), Ok(1024.0));
    assert_eq!(zoom.focal_px(1024.0, SIZE, None), Ok(3048.0));
    assert!(zoom.raw(900.0, SIZE, None).is_err() && zoom.focal_px(5000.0, SIZE, None).is_err());
    assert_eq!(Zoom::FocalMmX100.raw(2410.0, SIZE, Some(9.6)), Ok(1205.0));
}

#[test]
fn a_broken_packet_costs_itself_alone() {
    let good = export_as(&awkward(), Format::FreeD).files;
    let good = good.get("camera.freed").unwrap().to_vec();
    let options = ImportOptions {
        size: Some(SIZE),
        zoom: Some(Zoom::FocalPx),
        ..ImportOptions::default()
    };
    let read = |bytes: Vec<u8>| {
        let read = FreeD.read(&Files::one("a.freed", bytes), &options).unwrap();
        let unread = read.iter().filter_map(|frame| frame.unreadable.as_ref());
        let unread: Vec<String> = unread.map(|unread| unread.problem.clone()).collect();
        (read.len(), unread.join("; "))
    };
    let mut broken = good.clone();
    broken[2 * 29 + 5] ^= 0xff;
    let (count, said) = read(broken);
    assert_eq!(count, 12);
    assert!(
        said.starts_with("packet 3: ") && said.contains("checksum"),
        "{said}"
    );
    // A byte is lost: those behind it are whole packets again.
    let mut lost = good.clone();
    lost.remove(4 * 29 + 7);
    let (count, said) = read(lost);
    assert_eq!(count, 12);
    assert!(
        said.starts_with("packet 5: ") && !said.contains("packet 6"),
        "{said}"
    );
    let (count, said) = read([good, vec![1, 2]].concat());
    assert_eq!(count, 13);
    assert!(said.ends_with(": 2 bytes are left at the end"), "{said}");
}

#[test]
fn damaged_streams_are_named_in_one_line() {
    let good = export_as(&reference(), Format::FreeD)
        .files
        .get("camera.freed")
        .unwrap()
        .to_vec();
    let with = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    let options = ImportOptions {
        size: Some(SIZE),
        zoom: Some(Zoom::FocalPx),
        ..ImportOptions::default()
    };
    let read = |bytes: Vec<u8>, options: &ImportOptions| {
        FreeD
            .read(&Files::one("a.freed", bytes), options)
            .unwrap_err()
            .to_string()
    };
    let wanted = "not a FreeD D1 packet:";
    assert_eq!(read(Vec::new(), &options), "a.freed: the file is empty");
    assert_eq!(
        read(with(0, 0xd0), &options),
        format!("a.freed: packet 1: {wanted} it begins with 0xd0")
    );
    assert_eq!(
        read(with(28, 0), &options),
        format!("a.freed: packet 1: {wanted} the checksum is 0x00, not 0x1d")
    );
    let silent = ImportOptions {
        zoom: None,
        ..options.clone()
    };
    assert_eq!(
        read(good.clone(), &silent),
        "freed does not say what its zoom value means; give --zoom"
    );
    let silent = ImportOptions {
        size: None,
        ..options
    };
    assert_eq!(
        read(good, &silent),
        "freed does not say the size of its pictures; give --size WIDTHxHEIGHT"
    );
}

#[test]
fn a_camera_beyond_the_range_is_an_error() {
    let mut document = reference();
    document.cameras[0].position_m = Some(Vec3::new(0.0, -140.0, 18.0));
    let error = crate::exchange::export(
        document.at(std::path::Path::new("/")),
        Format::FreeD,
        &crate::exchange::ExportOptions::default(),
    );
    let said = error.unwrap_err().to_string();
    assert_eq!(
        said,
        "images/0001.jpg cannot be written as freed: -8960000 steps (m) are more than 24 bits hold (±131 m)"
    );
}

#[test]
fn two_cameras_in_one_stream_are_said_when_it_is_written() {
    let mut document = awkward();
    let mut other = (*document.cameras[0]).clone();
    other.id = "other".into();
    document.cameras.push(other.into());
    document.frames[3].camera = "other".into();
    for format in [Format::FreeD, Format::FreeDCsv, Format::Chan, Format::Fifa] {
        let notes = export_as(&document, format).notes.concat();
        assert!(
            notes.contains("frames of 2 cameras are in one track"),
            "{notes}"
        );
    }
}

/// Frames of the reference camera, each of a video and its number there.
fn frames_of_videos(frames: &[(&str, u64)]) -> Document {
    let mut document = reference();
    let frame = (*document.frames[0]).clone();
    let frames = frames.iter().map(|(video, number)| {
        let of_video =
            Frame::from_video(VideoFrame::new(video, *number, None), "main".into(), SIZE);
        let solved = Frame {
            id: of_video.id,
            image: None,
            video: of_video.video,
            ..frame.clone()
        };
        solved.into()
    });
    document.frames = frames.collect();
    document
}

#[test]
fn two_videos_or_folders_are_never_one_sequence() {
    let export = |document: &Document, format| {
        crate::exchange::export(
            document.at(std::path::Path::new("/")),
            format,
            &crate::exchange::ExportOptions::default(),
        )
    };
    let videos = frames_of_videos(&[("a/match.mp4", 1), ("b/match.mp4", 2)]);
    let mut images = videos.clone();
    for (frame, image) in images.frames.iter_mut().zip(["a/1.jpg", "b/2.jpg"]) {
        let of_image = Frame::from_image(image, "main".into(), SIZE);
        (frame.id, frame.image, frame.video) = (of_image.id, of_image.image, None);
    }
    let sequences = [
        Format::FreeD,
        Format::FreeDCsv,
        Format::Chan,
        Format::Fifa,
        Format::Usda,
    ];
    let with_videos = sequences.into_iter().chain([Format::Csv]);
    let cases = with_videos
        .map(|format| (&videos, format, "a/match.mp4#1 and b/match.mp4#2"))
        .chain(sequences.map(|format| (&images, format, "a/1.jpg and b/2.jpg")));
    for (document, format, frames) in cases {
        let refusal = export(document, format).unwrap_err().to_string();
        assert_eq!(
            refusal,
            format!(
                "{frames} would be in one sequence, and {format} names neither video nor folder; \
                 export them one camera or folder at a time"
            )
        );
    }
    let mut cameras = images;
    let mut other = (*cameras.cameras[0]).clone();
    other.id = "other".into();
    cameras.cameras.push(other.into());
    cameras.frames[1].camera = "other".into();
    cameras.frames[1].image = Some("a/2.jpg".to_owned());
    assert!(export(&cameras, Format::FreeD).is_err());
    assert_eq!(export(&cameras, Format::Usda).unwrap().frames, 2);
}

#[test]
fn a_gap_in_packets_without_numbers_is_noted() {
    let gaps = frames_of_videos(&[("match.mp4", 1), ("match.mp4", 3), ("match.mp4", 7)]);
    let notes = export_as(&gaps, Format::FreeD).notes.concat();
    assert!(
        notes.contains("frame 3 follows frame 1 as if nothing were between them"),
        "{notes}"
    );
    let whole = frames_of_videos(&[("match.mp4", 7), ("match.mp4", 8)]);
    let notes = export_as(&whole, Format::FreeD).notes.concat();
    assert!(!notes.contains("frame numbers"), "{notes}");
}

#[test]
fn a_second_camera_of_a_stream_is_named() {
    let files = export_as(&reference(), Format::FreeD).files;
    let mut bytes = files.get("camera.freed").unwrap().to_vec();
    assert_eq!(FreeD.unread(&files), [""; 0]);
    let mut second = bytes.clone();
    second[1] = 2;
    second[PACKET - 1] = checksum(&second);
    bytes.extend(second);
    let said = FreeD.unread(&Files::one("a.freed", bytes)).concat();
    assert!(
        said.starts_with("camera ids 1, 2 are in one stream"),
        "{said}"
    );
}
