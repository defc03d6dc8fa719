use super::mat_file::read_mat;
use super::mat_value::MatValue;
use super::writer::{CAMERA, Out, frame, mat, sequence};
use super::*;
use crate::document::FrameStatus;
use std::fs;
use std::path::Path;
use touchline_core::geometry::rotation::from_rotation_vector;
use touchline_core::geometry::{PixelBox, Vec3};

/// Every variable of these tests.
const ALL: [&str; 6] = ["numbers", "words", "all", "deep", "annotation", "meta"];

fn new_file(folder: &Path, name: &str, bytes: &[u8]) -> std::path::PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

/// The message with which a folder is not read.
fn refusal(folder: &Path) -> String {
    let read = read_authors_folder(folder, [118.0, 70.0]);
    read.unwrap_err().to_string()
}

#[test]
fn both_orders_of_bytes_and_compression_read_the_same() {
    let variables = || {
        [
            ("numbers", Out::Doubles(vec![1.5, -2.0, 1e300])),
            ("words", Out::Words("ä.jpg")),
            (
                "all",
                Out::Structures(vec![
                    vec![("a", Out::Doubles(vec![7.0]))],
                    vec![("a", Out::Words(""))],
                ]),
            ),
        ]
    };
    let plain = read_mat(&mat(&variables(), false, false), &ALL).unwrap();
    assert_eq!(
        plain[0],
        ("numbers".into(), MatValue::Numbers(vec![1.5, -2.0, 1e300]))
    );
    assert_eq!(plain[1].1.words(), Some("ä.jpg"));
    assert_eq!(
        plain[2].1.structures().unwrap()[0],
        [("a".into(), MatValue::Numbers(vec![7.0]))]
    );
    for (big, compressed) in [(true, false), (false, true), (true, true)] {
        assert_eq!(
            read_mat(&mat(&variables(), big, compressed), &ALL).unwrap(),
            plain,
            "{big} {compressed}"
        );
    }
}

#[test]
fn what_was_not_requested_stays_compressed() {
    let variables = [
        ("features", Out::Doubles(vec![0.0; 4 << 20])),
        ("meta", Out::Doubles(vec![7.0])),
    ];
    let bytes = mat(&variables, false, true);
    assert!(bytes.len() < 100_000, "32 MiB of zeros");
    let wanted = [("meta".into(), MatValue::Numbers(vec![7.0]))];
    assert_eq!(read_mat(&bytes, &["annotation", "meta"]).unwrap(), wanted);
    let error = read_mat(&bytes, &["features"]).unwrap_err().to_string();
    assert_eq!(
        error,
        "a compressed part of it cannot be decompressed: it decompresses to more than 8 MiB"
    );
    let twice = mat(
        &[
            ("meta", Out::Doubles(vec![1.0])),
            ("meta", Out::Doubles(vec![2.0])),
        ],
        false,
        true,
    );
    assert!(
        read_mat(&twice, &["meta"])
            .unwrap_err()
            .to_string()
            .ends_with("a variable occurs twice")
    );
}

#[test]
fn damaged_files_are_named_and_never_panic() {
    assert_eq!(read_mat(b"hello", &ALL).unwrap_err(), MatError::NotMat);
    assert_eq!(read_mat(b"\x89HDF\r\n", &ALL).unwrap_err(), MatError::Hdf5);
    for compressed in [false, true] {
        let whole = sequence(vec![frame("a.jpg", CAMERA)], compressed);
        // The end of an element that is not compressed may be padding; whatever it is, nothing
        // panics.
        let mut refused = 0;
        for length in 0..whole.len() {
            refused += usize::from(read_mat(&whole[..length], &ALL).is_err());
        }
        assert!(
            refused > whole.len() * 9 / 10,
            "{refused} of {}",
            whole.len()
        );
        for at in 128..whole.len() {
            for byte in [0, 1, 0x7f, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] = byte;
                let _ = read_mat(&damaged, &ALL);
            }
        }
    }
    // A structure within a structure, again and again.
    let mut deep = Out::Doubles(vec![1.0]);
    for _ in 0..100 {
        deep = Out::Structures(vec![vec![("a", deep)]]);
    }
    assert!(matches!(
        read_mat(&mat(&[("deep", deep)], false, false), &ALL),
        Err(MatError::Damaged { .. })
    ));
}

#[test]
fn a_published_frame_projects_as_its_own_matrix_does() {
    let root = tempfile::tempdir().unwrap();
    new_file(
        root.path(),
        "highlights/seq3_anno.mat",
        &sequence(vec![frame("00000515.jpg", CAMERA)], true),
    );
    image::RgbImage::new(1280, 720)
        .save(new_file(root.path(), "highlights/seq3/00000515.jpg", b""))
        .unwrap();
    let size_yd = Out::Doubles(vec![70.0, 118.0]);
    new_file(
        root.path(),
        "util/highlights_model.mat",
        &mat(&[("model_size", size_yd)], false, true),
    );

    let read = read_authors_folder(&root.path().join("highlights"), [115.0, 74.0]).unwrap();
    assert_eq!(read.field_yd, [118.0, 70.0]);
    assert!(read.worst_turn.degrees() < 1e-6, "{:?}", read.worst_turn);
    let frame = &read.document.frames[0];
    assert_eq!(
        (frame.image.as_deref(), frame.status),
        (Some("seq3/00000515.jpg"), FrameStatus::Reference)
    );
    assert_eq!(
        frame.masks,
        [PixelBox {
            x: 100.0,
            y: 50.0,
            width: 100.0,
            height: 30.0
        }]
    );
    let field = read.document.field_of(frame).model(root.path()).unwrap();
    assert!((field.length_m - 107.8992).abs() < 1e-9 && (field.width_m - 64.008).abs() < 1e-9);

    let camera = read.document.ptz_camera(frame).unwrap();
    let cam_from_world = from_rotation_vector(Vec3::new(CAMERA[3], CAMERA[4], CAMERA[5]));
    for corner_world in [
        [107.8992, 64.008, 0.0],
        [60.0, 32.0, 0.0],
        [80.0, 50.0, 2.44],
        [53.9496, 64.008, 0.0],
    ] {
        let point = Vec3::from(corner_world);
        let theirs = cam_from_world * (point - Vec3::new(CAMERA[6], CAMERA[7], CAMERA[8]));
        let pixel = [0, 1].map(|axis| CAMERA[axis] + CAMERA[2] * theirs[axis] / theirs.z + 0.5);
        let ours = camera
            .image_from_world(point - Vec3::new(107.8992 / 2.0, 64.008 / 2.0, 0.0))
            .unwrap();
        assert!(
            (ours.x - pixel[0]).hypot(ours.y - pixel[1]) < 1e-6,
            "{ours:?} {pixel:?}"
        );
    }
}

#[test]
fn sequences_of_one_base_share_a_camera_and_what_is_missing_is_named() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    assert!(matches!(
        read_authors_folder(folder, [118.0, 70.0]),
        Err(AuthorsError::NoSequences { .. })
    ));
    new_file(
        folder,
        "seq1_anno.mat",
        &sequence(vec![frame("1.jpg", CAMERA)], true),
    );
    new_file(
        folder,
        "seq10_anno.mat",
        &sequence(vec![frame("3.jpg", CAMERA), frame("4.jpg", CAMERA)], false),
    );
    new_file(
        folder,
        "seq2_anno.mat",
        &sequence(vec![frame("2.jpg", CAMERA)], false),
    );
    let read = read_authors_folder(folder, [118.0, 70.0]).unwrap();
    let clips: Vec<String> = read
        .document
        .frames
        .iter()
        .map(|frame| frame.clip.as_ref().unwrap().to_string())
        .collect();
    assert_eq!(clips, ["seq1", "seq2", "seq10", "seq10"]);
    assert_eq!((read.document.cameras.len(), read.field_model), (1, None));
    assert_eq!(
        read.document.frames[0].image_size,
        touchline_core::geometry::ImageSize::new(1280, 720)
    );

    let turned = [
        640.0, 360.0, 3733.8, 1.6177, 0.46, -0.436, 114.3, 1.11, 6.38,
    ];
    let huge = [4e9, 360.0, 3733.8, 1.6177, 0.46, -0.436, 114.3, 1.11, 6.38];
    let bare = vec![vec![("image_name", Out::Words("6.jpg"))]];
    for (bytes, said) in [
        (
            sequence(vec![frame("5.jpg", turned)], true),
            "seq3_anno.mat: the camera of 5.jpg is",
        ),
        (
            sequence(vec![frame("5.jpg", huge)], true),
            "missing: a principal point in the middle of a picture in annotation 1",
        ),
        (
            sequence(vec![frame("../5.jpg", CAMERA)], true),
            "missing: an image_name within the folder in annotation 1",
        ),
        (
            sequence(bare, true),
            "missing: nine numbers of a camera in annotation 1",
        ),
        (
            b"MATLAB 5.0 MAT-file".to_vec(),
            "seq3_anno.mat: it is not a MATLAB file of level 5",
        ),
    ] {
        new_file(folder, "seq3_anno.mat", &bytes);
        let error = refusal(folder);
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn another_principal_point_is_named_as_what_differs() {
    let root = tempfile::tempdir().unwrap();
    let mut moved = CAMERA;
    moved[0] += 3.0;
    let frames = vec![frame("1.jpg", CAMERA), frame("2.jpg", moved)];
    new_file(root.path(), "seq1_anno.mat", &sequence(frames, true));
    let error = refusal(root.path());
    assert!(
        error.contains("seq1_anno.mat: the principal point of 2.jpg is 3.0 px away"),
        "{error}"
    );
}
