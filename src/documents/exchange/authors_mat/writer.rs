//! A tiny writer of MAT files in the authors' layout, for tests.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write as _;

/// Where the published base of `soccer2_seq2` stands, m.
pub const CC: [f64; 3] = [114.32318, 1.114215, 6.375646];
/// Its rotation.
pub const BASE_ROTATION: [f64; 3] = [1.230319, 1.129962, -1.157628];
/// Pan and tilt, degrees, focal length, px.
pub const PTZ: [f64; 3] = [53.3648337246351, -5.866202476869829, 3733.765356];
/// The full camera.
pub const CAMERA: [f64; 9] = [
    640.0,
    360.0,
    3733.765356,
    1.6177358624358056,
    0.4455673655245743,
    -0.4361925714515834,
    114.32318,
    1.114215,
    6.375646,
];

/// What is written.
pub enum Out {
    /// Numbers.
    Doubles(Vec<f64>),
    /// Text.
    Words(&'static str),
    /// Structures with the same fields.
    Structures(Vec<Vec<(&'static str, Out)>>),
}

fn element(kind: u32, bytes: &[u8], big: bool) -> Vec<u8> {
    if (1..=4).contains(&bytes.len()) {
        let mut out = word(kind | (bytes.len() as u32) << 16, big).to_vec();
        out.extend_from_slice(bytes);
        out.resize(8, 0);
        return out;
    }
    let mut out = [word(kind, big), word(bytes.len() as u32, big)].concat();
    out.extend_from_slice(bytes);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

fn matrix(name: &str, value: &Out, big: bool) -> Vec<u8> {
    let (class, count) = match value {
        Out::Doubles(numbers) => (6, numbers.len()),
        Out::Words(words) => (4, words.chars().count()),
        Out::Structures(all) => (2, all.len()),
    };
    let mut inner = element(6, &ints(&[class, 0], big), big);
    inner.extend(element(5, &ints(&[1, count as i32], big), big));
    inner.extend(element(1, name.as_bytes(), big));
    match value {
        Out::Doubles(numbers) => {
            let bytes: Vec<u8> = numbers
                .iter()
                .flat_map(|n| {
                    if big {
                        n.to_be_bytes()
                    } else {
                        n.to_le_bytes()
                    }
                })
                .collect();
            inner.extend(element(9, &bytes, big));
        }
        Out::Words(words) => {
            let letters: Vec<u8> = words
                .encode_utf16()
                .flat_map(|n| {
                    if big {
                        n.to_be_bytes()
                    } else {
                        n.to_le_bytes()
                    }
                })
                .collect();
            inner.extend(element(4, &letters, big));
        }
        Out::Structures(all) => {
            inner.extend(element(5, &ints(&[32], big), big));
            let names: Vec<u8> = all[0]
                .iter()
                .flat_map(|(name, _)| {
                    let mut name = name.as_bytes().to_vec();
                    name.resize(32, 0);
                    name
                })
                .collect();
            inner.extend(element(1, &names, big));
            for (_, value) in all.iter().flatten() {
                inner.extend(matrix("", value, big));
            }
        }
    }
    let (kind, length) = (word(14, big), word(inner.len() as u32, big));
    [kind.to_vec(), length.to_vec(), inner].concat()
}

/// The bytes of a number, the highest first if `big`.
fn word(number: u32, big: bool) -> [u8; 4] {
    if big {
        number.to_be_bytes()
    } else {
        number.to_le_bytes()
    }
}

/// The bytes of numbers one after the other.
fn ints(numbers: &[i32], big: bool) -> Vec<u8> {
    numbers
        .iter()
        .flat_map(|number| word(*number as u32, big))
        .collect()
}

/// A file with these variables.
pub fn mat(variables: &[(&str, Out)], big: bool, compressed: bool) -> Vec<u8> {
    let mut file = vec![b' '; 124];
    file.extend_from_slice(if big { &[1, 0] } else { &[0, 1] });
    file.extend_from_slice(if big { b"MI" } else { b"IM" });
    for (name, value) in variables {
        let plain = matrix(name, value, big);
        if !compressed {
            file.extend(plain);
            continue;
        }
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&plain).unwrap();
        let folded = encoder.finish().unwrap();
        file.extend([word(15, big), word(folded.len() as u32, big)].concat());
        file.extend(folded);
    }
    file
}

/// A frame as the authors write it.
pub fn frame(image: &'static str, camera: [f64; 9]) -> Vec<(&'static str, Out)> {
    vec![
        ("image_name", Out::Words(image)),
        ("camera", Out::Doubles(camera.to_vec())),
        ("ptz", Out::Doubles(PTZ.to_vec())),
    ]
}

/// A sequence of frames with its base.
pub fn sequence(frames: Vec<Vec<(&'static str, Out)>>, compressed: bool) -> Vec<u8> {
    let meta = vec![
        ("cc", Out::Doubles(CC.to_vec())),
        ("base_rotation", Out::Doubles(BASE_ROTATION.to_vec())),
        ("seq", Out::Words("soccer2_seq2")),
        ("base_dir", Out::Words("/Users/somebody/data/elsewhere")),
        ("logo_bbox", Out::Doubles(vec![101.0, 51.0, 99.0, 29.0])),
    ];
    mat(
        &[
            ("annotation", Out::Structures(frames)),
            ("meta", Out::Structures(vec![meta])),
        ],
        false,
        compressed,
    )
}
