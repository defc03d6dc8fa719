//! A 3 × 3 matrix as `NumPy` writes it (`.npy`, versions 1 to 3). Object arrays, which run code when they are read, are refused.

use super::error::Problem;
use super::files::refuse_archive;
use super::values::clipped;
use touchline_core::geometry::Mat3;

const MAGIC: &[u8] = b"\x93NUMPY";
/// The longest header that is read, bytes.
const MAX_HEADER: usize = 4096;

/// The bytes that `numpy.save` writes for a matrix of float64.
#[must_use]
pub fn written(matrix: &Mat3) -> Vec<u8> {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }";
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0, 118, 0]);
    bytes.extend(format!("{header:<117}\n").bytes());
    for entry in matrix.transpose().iter() {
        bytes.extend(entry.to_le_bytes());
    }
    bytes
}

fn wrong(found: String) -> Problem {
    Problem::NotFormat { wanted: "a 3 x 3 matrix as numpy.save writes it", found }
}

/// The matrix of a file.
///
/// # Errors
/// It is none of `NumPy`'s, of another shape or type, too short, or holds NaN.
pub fn matrix(bytes: &[u8]) -> Result<Mat3, Problem> {
    if bytes.is_empty() {
        return Err(Problem::Empty);
    }
    refuse_archive(bytes)?;
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| wrong("the magic bytes are missing".to_owned()))?;
    let short = || wrong(format!("it ends after {} bytes", bytes.len()));
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        [version, ..] if *version > 3 || *version == 0 => return Err(wrong(format!("version {version}"))),
        _ => return Err(short()),
    };
    if length > MAX_HEADER {
        return Err(wrong(format!("a header of {length} bytes")));
    }
    let header = rest.get(..length).ok_or_else(short)?;
    let header = std::str::from_utf8(header).map_err(|_| wrong("a header that is not text".to_owned()))?;
    let header: String = header.chars().filter(|letter| !letter.is_whitespace()).collect();
    if header.contains("'descr':'|O'") || header.contains("'descr':\"|O\"") {
        let why = "reading it would run code; save the matrix as float64";
        return Err(Problem::Unsupported { what: "an object array".to_owned(), why });
    }
    let shape = header.split("'shape':(").nth(1).and_then(|rest| rest.split(')').next()).unwrap_or_default();
    if shape.trim_end_matches(',') != "3,3" {
        return Err(wrong(format!("the shape is ({})", clipped(shape))));
    }
    let data = &rest[length..];
    let values: Vec<f64> = if header.contains("'descr':'<f8'") {
        data.chunks_exact(8).take(9).filter_map(|chunk| Some(f64::from_le_bytes(chunk.try_into().ok()?))).collect()
    } else if header.contains("'descr':'<f4'") {
        let single = |chunk: &[u8]| Some(f64::from(f32::from_le_bytes(chunk.try_into().ok()?)));
        data.chunks_exact(4).take(9).filter_map(single).collect()
    } else {
        let kind = header.split("'descr':").nth(1).and_then(|rest| rest.split(',').next()).unwrap_or_default();
        return Err(wrong(format!("numbers of the type {}", clipped(kind))));
    };
    if values.len() != 9 {
        return Err(short());
    }
    if values.iter().any(|value| !value.is_finite()) {
        return Err(Problem::NotFinite("a number of the homography".to_owned()));
    }
    let by_rows = Mat3::from_row_slice(&values);
    Ok(if header.contains("'fortran_order':True") { by_rows.transpose() } else { by_rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_are_those_of_numpy_and_come_back() {
        let h = Mat3::new(1.5, -2.0, 3.25, 0.0, 1e-17, 5.0, 7.0, 8.0, 1.0);
        let bytes = written(&h);
        assert_eq!((bytes.len(), bytes[127]), (200, b'\n'));
        assert_eq!(matrix(&bytes).unwrap(), h);
        let mut fortran = written(&h.transpose());
        let at = bytes.windows(5).position(|window| window == b"False").unwrap();
        fortran[at..at + 5].copy_from_slice(b"True ");
        assert_eq!(matrix(&fortran).unwrap(), h);
    }

    #[test]
    fn damaged_and_hostile_files_are_named() {
        let good = written(&Mat3::identity());
        let swap = |from: &str, to: &str| {
            assert_eq!(from.len(), to.len());
            let mut bytes = good.clone();
            let at = good.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
            bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
            bytes
        };
        let mut version = good.clone();
        version[6] = 9;
        let mut huge = good.clone();
        huge[6] = 2;
        huge[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        let mut nan = good.clone();
        nan[128..136].copy_from_slice(&f64::NAN.to_le_bytes());
        let not = "not a 3 x 3 matrix as numpy.save writes it: ";
        for (bytes, wanted) in [
            (Vec::new(), "the file is empty".to_owned()),
            (b"PK\x03\x04".to_vec(), "a zip archive; unpack it and give the unpacked files".to_owned()),
            (b"\x93NUMPX".to_vec(), format!("{not}the magic bytes are missing")),
            (good[..8].to_vec(), format!("{not}it ends after 8 bytes")),
            (good[..60].to_vec(), format!("{not}it ends after 60 bytes")),
            (good[..199].to_vec(), format!("{not}it ends after 199 bytes")),
            (version, format!("{not}version 9")),
            (huge, format!("{not}a header of 4294967295 bytes")),
            (swap("(3, 3)", "(2, 3)"), format!("{not}the shape is (2,3)")),
            (swap("<f8", "<i8"), format!("{not}numbers of the type '<i8'")),
            (
                swap("'<f8'", "'|O' "),
                "an object array cannot be read: reading it would run code; save the matrix as float64".to_owned(),
            ),
            (nan, "a number of the homography is not a finite number".to_owned()),
        ] {
            assert_eq!(matrix(&bytes).unwrap_err().to_string(), wanted);
        }
    }
}
