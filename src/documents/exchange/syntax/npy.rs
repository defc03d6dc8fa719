//! Arrays as `NumPy` writes them (`.npy`, versions 1 to 3). Object arrays are rejected, because
//! reading them would run code.

use super::values::shorten;
use crate::exchange::error::Problem;
use crate::exchange::files::refuse_archive;
use touchline_core::geometry::Mat3;

const MAGIC: &[u8] = b"\x93NUMPY";
/// The longest header that is read, bytes.
const MAX_HEADER: usize = 4096;
/// Headers are padded with blanks so that the numbers begin at a multiple of this, bytes.
const ALIGNMENT: usize = 64;
/// The bytes before the header: the magic ones, the version and the header's length.
const BEFORE_HEADER: usize = 10;

/// An array of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its length along each axis.
    pub shape: Vec<usize>,
    /// Its numbers, the last axis running fastest.
    pub values: Vec<f64>,
}

impl Array {
    /// The bytes that `numpy.save` writes for it as float64.
    pub fn to_bytes(&self) -> Vec<u8> {
        let sides: Vec<String> = self.shape.iter().map(ToString::to_string).collect();
        // The header is a literal of Python (NumPy, `numpy.lib.format`): a tuple of one has a comma
        // behind it.
        let comma = if sides.len() == 1 { "," } else { "" };
        let shape = format!("({}{comma})", sides.join(", "));
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        // Blanks and a line break fill the header, so that the numbers begin at a multiple of 64.
        let length = (BEFORE_HEADER + header.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE_HEADER;
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
        bytes.extend(self.values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }

    /// The numbers of one entry along the first axis.
    pub fn row(&self, index: usize) -> &[f64] {
        let length: usize = self.shape.iter().skip(1).product();
        self.values
            .get(index * length..(index + 1) * length)
            .unwrap_or_default()
    }
}

/// The bytes that `numpy.save` writes for a matrix of float64.
pub fn matrix_to_bytes(matrix: &Mat3) -> Vec<u8> {
    Array {
        shape: vec![3, 3],
        values: matrix.transpose().iter().copied().collect(),
    }
    .to_bytes()
}

/// The matrix of a file.
///
/// # Errors
/// It is none of `NumPy`'s, of another shape or type, too short, or holds NaN.
pub fn matrix(bytes: &[u8]) -> Result<Mat3, Problem> {
    let wanted = "a 3 x 3 matrix as numpy.save writes it";
    let header = Header::read(bytes, wanted)?;
    if header.shape != "3,3" {
        return Err(wrong_shape(wanted, &header.shape));
    }
    let array = header.array(wanted)?;
    if array.values.iter().any(|value| !value.is_finite()) {
        return Err(Problem::NotFinite("a number of the homography".to_owned()));
    }
    Ok(Mat3::from_row_slice(&array.values))
}

/// The array of a file.
///
/// # Errors
/// It is none of `NumPy`'s, of another type, or too short.
pub fn array(bytes: &[u8]) -> Result<Array, Problem> {
    let wanted = "an array as numpy.save writes it";
    Header::read(bytes, wanted)?.array(wanted)
}

/// The supported types of numbers: name, length in bytes, and decoder.
type NumberType = (&'static str, usize, fn(&[u8]) -> Option<f64>);
const NUMBER_TYPES: [NumberType; 4] = [
    ("'<f8'", 8, |bytes| {
        Some(f64::from_le_bytes(bytes.try_into().ok()?))
    }),
    ("'<f4'", 4, |bytes| {
        Some(f64::from(f32::from_le_bytes(bytes.try_into().ok()?)))
    }),
    ("'<i8'", 8, |bytes| {
        Some(i64::from_le_bytes(bytes.try_into().ok()?) as f64)
    }),
    ("'<i4'", 4, |bytes| {
        Some(f64::from(i32::from_le_bytes(bytes.try_into().ok()?)))
    }),
];

/// The header of a file, and the numbers as bytes.
struct Header<'a> {
    /// The file's length, bytes.
    length: usize,
    /// The type of the numbers, in quotes.
    kind: String,
    /// The lengths along the axes without blanks, with commas between them.
    shape: String,
    is_fortran: bool,
    data: &'a [u8],
}

impl<'a> Header<'a> {
    fn read(bytes: &'a [u8], wanted: &'static str) -> Result<Self, Problem> {
        if bytes.is_empty() {
            return Err(Problem::Empty);
        }
        refuse_archive(bytes)?;
        let rest = bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| Problem::not_format(wanted, "the magic bytes are missing"))?;
        // Version 1 has a length of two bytes, versions 2 and 3 of four; the minor version does not
        // matter.
        let (length, rest) = match rest {
            [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
            [2 | 3, _, a, b, c, d, rest @ ..] => {
                (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest)
            }
            [version, ..] if *version > 3 || *version == 0 => {
                return Err(Problem::not_format(wanted, format!("version {version}")));
            }
            _ => return Err(too_short(wanted, bytes.len())),
        };
        if length > MAX_HEADER {
            return Err(Problem::not_format(
                wanted,
                format!("a header of {length} bytes"),
            ));
        }
        let text = rest
            .get(..length)
            .ok_or_else(|| too_short(wanted, bytes.len()))?;
        let text = std::str::from_utf8(text)
            .map_err(|_| Problem::not_format(wanted, "a header that is not text"))?;
        // Without blanks the keys can be searched for in any order and spacing; no value that is
        // read here has a blank of its own.
        let text: String = text
            .chars()
            .filter(|letter| !letter.is_whitespace())
            .collect();
        // An array of Python objects is a pickle, which names functions that are called when it is
        // read.
        if text.contains("'descr':'|O'") || text.contains("'descr':\"|O\"") {
            let why = "reading it would run code; save the matrix as float64";
            return Err(Problem::not_supported("an object array", why));
        }
        let shape = text
            .split("'shape':(")
            .nth(1)
            .and_then(|rest| rest.split(')').next())
            .unwrap_or_default();
        let kind = text
            .split("'descr':")
            .nth(1)
            .and_then(|rest| rest.split(',').next())
            .unwrap_or_default();
        Ok(Self {
            length: bytes.len(),
            kind: kind.to_owned(),
            shape: shape.trim_end_matches(',').to_owned(),
            is_fortran: text.contains("'fortran_order':True"),
            data: &rest[length..],
        })
    }

    /// The numbers behind it. A shape larger than the data is rejected before anything is
    /// allocated.
    fn array(&self, wanted: &'static str) -> Result<Array, Problem> {
        let Some((_, bytes, value)) = NUMBER_TYPES
            .into_iter()
            .find(|(name, _, _)| *name == self.kind)
        else {
            let found = format!("numbers of the type {}", shorten(&self.kind));
            return Err(Problem::not_format(wanted, found));
        };
        // A trailing comma, as in `(5,)`, leaves an empty part. No side at all is a single number.
        let sides = self.shape.split(',').filter(|side| !side.is_empty());
        let shape: Option<Vec<usize>> = sides.map(|side| side.parse().ok()).collect();
        // The header may state any numbers, so that the product may overflow.
        let count = shape
            .iter()
            .flatten()
            .try_fold(1_usize, |count, side| count.checked_mul(*side));
        let (Some(shape), Some(count)) = (shape, count) else {
            return Err(wrong_shape(wanted, &self.shape));
        };
        // Bytes behind the numbers are ignored, as NumPy ignores them.
        if self.data.len() / bytes < count {
            return Err(too_short(wanted, self.length));
        }
        let values: Vec<f64> = self
            .data
            .chunks_exact(bytes)
            .take(count)
            .filter_map(value)
            .collect();
        let values = if self.is_fortran {
            by_rows(&values, &shape)
        } else {
            values
        };
        Ok(Array { shape, values })
    }
}

/// Converts numbers from Fortran order (first axis fastest) to C order (last axis fastest).
fn by_rows(values: &[f64], shape: &[usize]) -> Vec<f64> {
    (0..values.len())
        .map(|c_index| values[fortran_index(c_index, shape, values.len())])
        .collect()
}

/// The index in Fortran order of the number that has this index in C order, of `count` numbers.
fn fortran_index(c_index: usize, shape: &[usize], count: usize) -> usize {
    // Decompose the C index into coordinates, last axis first; in Fortran order the last axis has
    // the largest stride.
    let (mut left, mut index, mut stride) = (c_index, 0, count);
    for side in shape.iter().rev() {
        stride /= side;
        index += left % side * stride;
        left /= side;
    }
    index
}

fn wrong_shape(wanted: &'static str, shape: &str) -> Problem {
    Problem::not_format(wanted, format!("the shape is ({})", shorten(shape)))
}

fn too_short(wanted: &'static str, length_bytes: usize) -> Problem {
    Problem::not_format(wanted, format!("it ends after {length_bytes} bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_are_those_of_numpy_and_come_back() {
        let h = Mat3::new(1.5, -2.0, 3.25, 0.0, 1e-17, 5.0, 7.0, 8.0, 1.0);
        let bytes = matrix_to_bytes(&h);
        assert_eq!((bytes.len(), bytes[127]), (200, b'\n'));
        assert_eq!(matrix(&bytes).unwrap(), h);
        let mut fortran = matrix_to_bytes(&h.transpose());
        let at = bytes
            .windows(5)
            .position(|window| window == b"False")
            .unwrap();
        fortran[at..at + 5].copy_from_slice(b"True ");
        assert_eq!(matrix(&fortran).unwrap(), h);
    }

    #[test]
    fn damaged_and_hostile_files_are_named() {
        let good = matrix_to_bytes(&Mat3::identity());
        let swap = |from: &str, to: &str| {
            assert_eq!(from.len(), to.len());
            let mut bytes = good.clone();
            let at = good
                .windows(from.len())
                .position(|window| window == from.as_bytes())
                .unwrap();
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
            (swap("<f8", ">f8"), format!("{not}numbers of the type '>f8'")),
            (
                swap("'<f8'", "'|O' "),
                "an object array cannot be read: reading it would run code; save the matrix as float64".to_owned(),
            ),
            (nan, "a number of the homography is not a finite number".to_owned()),
        ] {
            assert_eq!(matrix(&bytes).unwrap_err().to_string(), wanted);
        }
    }

    #[test]
    fn arrays_of_any_shape_and_of_whole_numbers_are_read() {
        let array = Array {
            shape: vec![2, 3, 4],
            values: (0..24).map(f64::from).collect(),
        };
        let bytes = array.to_bytes();
        assert_eq!(bytes.len(), 128 + 24 * 8);
        assert_eq!(
            (super::array(&bytes).unwrap(), array.row(1)),
            (array.clone(), &array.values[12..])
        );
        assert_eq!(array.row(2), [0.0; 0]);
        let list = Array {
            shape: vec![2],
            values: vec![3.0, -4.0],
        };
        assert_eq!(super::array(&list.to_bytes()).unwrap(), list);
        let mut whole = list.to_bytes();
        let at = whole
            .windows(3)
            .position(|window| window == b"<f8")
            .unwrap();
        whole[at..at + 3].copy_from_slice(b"<i8");
        let from = whole.len() - 16;
        whole[from..].copy_from_slice(&[3_i64.to_le_bytes(), (-4_i64).to_le_bytes()].concat());
        assert_eq!(super::array(&whole).unwrap(), list);
    }

    #[test]
    fn the_order_of_fortran_is_turned_round_and_impossible_shapes_are_refused() {
        let array = Array {
            shape: vec![2, 3, 4],
            values: (0..24).map(f64::from).collect(),
        };
        let at = |i: usize, j: usize, k: usize| array.values[(i * 3 + j) * 4 + k];
        let by_columns: Vec<f64> = (0..4)
            .flat_map(|k| (0..3).flat_map(move |j| (0..2).map(move |i| (i, j, k))))
            .map(|(i, j, k)| at(i, j, k))
            .collect();
        assert_eq!(by_rows(&by_columns, &array.shape), array.values);
        let good = array.to_bytes();
        for (shape, found) in [
            ("(-2, 3, 4)", "the shape is (-2,3,4)"),
            ("(9, 99, 99)", "it ends after 320 bytes"),
            (
                "(4294967296, 4294967296)",
                "the shape is (4294967296,4294967296)",
            ),
        ] {
            let text = format!("{:<40}", format!("'shape': {shape}, }}"));
            let from = good
                .windows(8)
                .position(|window| window == b"'shape':")
                .unwrap();
            let mut bytes = good.clone();
            bytes[from..from + text.len()].copy_from_slice(text.as_bytes());
            let problem = super::array(&bytes).unwrap_err().to_string();
            assert_eq!(
                problem,
                format!("not an array as numpy.save writes it: {found}")
            );
        }
        let nothing = Array {
            shape: vec![0, 3, 3],
            values: Vec::new(),
        };
        assert_eq!(super::array(&nothing.to_bytes()).unwrap(), nothing);
    }
}
