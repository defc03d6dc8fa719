//! A reader of MATLAB's level 5 files (saved with `-v6` or `-v7`), for numbers, strings, cells and
//! structures.
//!
//! Format: `MathWorks`, "MAT-File Format", 2023, chapter 1. A file is a header and a row of
//! elements; an element is a tag (type, number of bytes) and its bytes. Whatever lengths a damaged
//! file states, nothing is read beyond its end and no more is allocated than its bytes can fill.
//! Only the requested variables are decompressed and read.

use super::mat_value::{MatValue, NamedValues};
use flate2::read::ZlibDecoder;
use std::io::Read as _;
use std::sync::Arc;
use thiserror::Error;

/// The header: text, an offset, the version and the order of bytes.
const HEADER: usize = 128;
/// The maximum decompressed size of all requested variables together, bytes: enough for twenty
/// thousand annotated frames.
const MOST_UNFOLDED: usize = 8 << 20;
/// The length to which a compressed variable is decompressed to find its name, bytes.
const NAME_WITHIN: usize = 1024;
/// The longest name of a structure's field, with its final 0: MATLAB's own limit.
const MOST_LETTERS: f64 = 64.0;
/// The maximum nesting depth of structures and cells.
const MOST_NESTED: u32 = 16;

/// Why a MAT file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MatError {
    /// It has another format.
    #[error("it is not a MATLAB file of level 5")]
    NotMat,
    /// It was saved with `-v7.3`.
    #[error("it is a MATLAB 7.3 file (HDF5); save it with -v7 in MATLAB")]
    Hdf5,
    /// It ends within an element.
    #[error(
        "it is truncated or damaged: {wanted} bytes are expected at byte {at}, where {left} are left"
    )]
    Short {
        /// Where, counted within its element if that is compressed.
        at: usize,
        /// Bytes that the element claims.
        wanted: usize,
        /// Bytes that there are.
        left: usize,
    },
    /// An element is invalid.
    #[error("it is damaged at byte {at}: {what}")]
    Damaged {
        /// Where, counted within its element if that is compressed.
        at: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// A compressed element cannot be decompressed.
    #[error("a compressed part of it cannot be decompressed: {0}")]
    Compressed(String),
}

impl MatError {
    /// What is wrong at a place, counted within its element if that is compressed.
    const fn damage_at(at: usize, what: &'static str) -> Self {
        Self::Damaged { at, what }
    }
}

/// The requested variables that a MAT file contains, in the order of the file.
///
/// # Errors
/// It is not a MAT file of level 5, or it is damaged.
pub fn read_mat(bytes: &[u8], wanted: &[&str]) -> Result<NamedValues, MatError> {
    // An HDF5 file begins with 0x89 "HDF", after MATLAB's own 512 bytes of text or at once.
    if bytes.starts_with(b"\x89HDF") || bytes.starts_with(b"MATLAB 7.3") {
        return Err(MatError::Hdf5);
    }
    let big_endian = match bytes.get(HEADER - 2..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(MatError::NotMat),
    };
    let mut reader = Reader {
        bytes,
        at: HEADER,
        big_endian,
    };
    let mut variables = NamedValues::new();
    // The limit is for all variables together: many small ones could otherwise fill the memory.
    let mut left = MOST_UNFOLDED;
    while !reader.is_at_end() {
        let element = reader.element()?;
        let at = element.at;
        let read = match element.kind {
            ElementType::MATRIX => element.inside(big_endian).variable(wanted)?,
            ElementType::COMPRESSED => {
                // The name is near the beginning, so variables that were not requested need not be
                // decompressed entirely.
                let begin = unfold(element.bytes, NAME_WITHIN)?;
                let mut inside = Reader {
                    bytes: &begin,
                    at: 0,
                    big_endian,
                };
                if inside.skip_tag()? == ElementType::MATRIX
                    && wanted.contains(&&*inside.matrix_head()?.name)
                {
                    // One byte more than is left shows that it is too much.
                    let unfolded = unfold(element.bytes, left + 1)?;
                    left = left.checked_sub(unfolded.len()).ok_or_else(|| {
                        MatError::Compressed(format!(
                            "it decompresses to more than {} MiB",
                            MOST_UNFOLDED >> 20
                        ))
                    })?;
                    let element = Reader {
                        bytes: &unfolded,
                        at: 0,
                        big_endian,
                    }
                    .element()?;
                    element.inside(big_endian).variable(wanted)?
                } else {
                    None
                }
            }
            // Other top-level elements are not variables.
            _ => None,
        };
        if let Some((name, value)) = read {
            if variables.iter().any(|(known, _)| *known == name) {
                return Err(MatError::damage_at(at, "a variable occurs twice"));
            }
            variables.push((name, value));
        }
    }
    Ok(variables)
}

/// Decompresses at most the first `most` bytes of an element.
fn unfold(bytes: &[u8], most: usize) -> Result<Vec<u8>, MatError> {
    let mut unfolded = Vec::new();
    let read = ZlibDecoder::new(bytes)
        .take(most as u64)
        .read_to_end(&mut unfolded);
    read.map_err(|error| MatError::Compressed(error.to_string()))?;
    Ok(unfolded)
}

/// The type of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ElementType(u32);

impl ElementType {
    const INT8: Self = Self(1);
    const UINT8: Self = Self(2);
    const INT16: Self = Self(3);
    const UINT16: Self = Self(4);
    const INT32: Self = Self(5);
    const UINT32: Self = Self(6);
    const SINGLE: Self = Self(7);
    const DOUBLE: Self = Self(9);
    const INT64: Self = Self(12);
    const UINT64: Self = Self(13);
    const MATRIX: Self = Self(14);
    const COMPRESSED: Self = Self(15);
    const UTF8: Self = Self(16);
    const UTF16: Self = Self(17);
    const UTF32: Self = Self(18);

    /// Bytes of one number; none for what holds no numbers.
    const fn width(self) -> Option<usize> {
        match self {
            Self::INT8 | Self::UINT8 | Self::UTF8 => Some(1),
            Self::INT16 | Self::UINT16 | Self::UTF16 => Some(2),
            Self::INT32 | Self::UINT32 | Self::SINGLE | Self::UTF32 => Some(4),
            Self::DOUBLE | Self::INT64 | Self::UINT64 => Some(8),
            _ => None,
        }
    }
}

/// The head of an array.
struct Head {
    class: u8,
    count: usize,
    rows: Option<f64>,
    name: String,
}

/// An element: its type, its bytes and where they begin.
struct Element<'a> {
    kind: ElementType,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Element<'a> {
    fn inside(&self, big_endian: bool) -> Reader<'a> {
        Reader {
            bytes: self.bytes,
            at: 0,
            big_endian,
        }
    }
}

/// A cursor in a byte slice.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Reader<'a> {
    const fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }

    fn take(&mut self, wanted: usize) -> Result<&'a [u8], MatError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let taken = rest.get(..wanted).ok_or(MatError::Short {
            at: self.at,
            wanted,
            left: rest.len(),
        })?;
        self.at += wanted;
        Ok(taken)
    }

    fn word(&mut self) -> Result<u32, MatError> {
        let at = self.at;
        let bytes: [u8; 4] = self
            .take(4)?
            .try_into()
            .map_err(|_| MatError::damage_at(at, "a number is cut short"))?;
        Ok(if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }

    /// The next element with its padding.
    fn element(&mut self) -> Result<Element<'a>, MatError> {
        let first = self.word()?;
        if first >> 16 != 0 {
            // A small element: type and length share one word, and at most four bytes follow. The
            // types of whole tags are below 2¹⁶, so that their upper half is 0.
            let (kind, length) = (ElementType(first & 0xffff), (first >> 16) as usize);
            let at = self.at;
            let bytes = self.take(4)?;
            let bytes = bytes
                .get(..length)
                .ok_or(MatError::damage_at(at, "a small element is too long"))?;
            return Ok(Element { kind, bytes, at });
        }
        let (kind, length) = (ElementType(first), self.word()? as usize);
        let at = self.at;
        let bytes = self.take(length)?;
        if kind != ElementType::COMPRESSED {
            // Elements are padded to eight bytes, compressed ones are not. Some programs leave out
            // the padding at the very end.
            self.at = (at + length).next_multiple_of(8).min(self.bytes.len());
        }
        Ok(Element { kind, bytes, at })
    }

    /// The numbers of the next element.
    fn numbers(&mut self) -> Result<Vec<f64>, MatError> {
        let Element { kind, bytes, at } = self.element()?;
        let width = kind
            .width()
            .ok_or(MatError::damage_at(at, "numbers are expected"))?;
        if bytes.len() % width != 0 {
            return Err(MatError::damage_at(at, "a number is cut short"));
        }
        Ok(bytes
            .chunks_exact(width)
            .map(|number| self.number(kind, number))
            .collect())
    }

    /// A number from its bytes, which are at most eight, in the file's order.
    fn number(&self, kind: ElementType, bytes: &[u8]) -> f64 {
        // Into the low bytes of a number of eight, from which each type takes its own bits.
        let mut low_first = [0u8; 8];
        for (place, byte) in low_first.iter_mut().zip(bytes) {
            *place = *byte;
        }
        if self.big_endian {
            low_first[..bytes.len()].reverse();
        }
        let bits = u64::from_le_bytes(low_first);
        match kind {
            ElementType::INT8 => f64::from(bits as u8 as i8),
            ElementType::INT16 => f64::from(bits as u16 as i16),
            ElementType::INT32 => f64::from(bits as u32 as i32),
            ElementType::INT64 => bits as i64 as f64,
            ElementType::SINGLE => f64::from(f32::from_bits(bits as u32)),
            ElementType::DOUBLE => f64::from_bits(bits),
            _ => bits as f64,
        }
    }

    /// The type of the next element, which may be incomplete.
    fn skip_tag(&mut self) -> Result<ElementType, MatError> {
        let kind = ElementType(self.word()?);
        self.word()?;
        Ok(kind)
    }

    /// The contents of a top-level `MATRIX` element, if its name is requested.
    fn variable(&mut self, wanted: &[&str]) -> Result<Option<(Arc<str>, MatValue)>, MatError> {
        let head = self.matrix_head()?;
        if !wanted.contains(&&*head.name) {
            return Ok(None);
        }
        let value = self.matrix_value(&head, 0)?;
        Ok(Some((head.name.as_str().into(), value)))
    }

    /// The value of an unnamed array.
    fn matrix(&mut self, depth: u32) -> Result<MatValue, MatError> {
        if self.bytes.is_empty() {
            return Ok(MatValue::Numbers(Vec::new()));
        }
        if depth > MOST_NESTED {
            return Err(MatError::damage_at(
                self.at,
                "structures are nested too deeply",
            ));
        }
        let head = self.matrix_head()?;
        self.matrix_value(&head, depth)
    }

    /// The head of a `MATRIX` element.
    fn matrix_head(&mut self) -> Result<Head, MatError> {
        // An array begins with its flags (the class is the lowest byte of the first word), its
        // sizes and its name.
        let Element {
            bytes: flags, at, ..
        } = self.element()?;
        let class = if self.big_endian {
            flags.get(3)
        } else {
            flags.first()
        };
        let class = *class.ok_or(MatError::damage_at(at, "an array has no class"))?;
        let at = self.at;
        let sizes = self.numbers()?;
        // A size that is no number counts as too large, so that the product overflows and is
        // refused.
        let count = sizes.iter().try_fold(1usize, |count, size| {
            let size = if *size >= 0.0 && *size <= f64::from(u32::MAX) {
                *size as usize
            } else {
                usize::MAX
            };
            count.checked_mul(size)
        });
        let count = count.ok_or(MatError::damage_at(at, "an array has no size"))?;
        Ok(Head {
            class,
            count,
            rows: sizes.first().copied(),
            name: words(&self.numbers()?),
        })
    }

    /// The value that follows a head.
    fn matrix_value(&mut self, head: &Head, depth: u32) -> Result<MatValue, MatError> {
        Ok(match head.class {
            // Classes by the format's table: cell, structure, character, double to unsigned 64
            // bits. An object, a sparse matrix or a function is passed over.
            1 => MatValue::Cells(self.matrices(head.count, depth)?),
            2 => self.structures(head.count, depth)?,
            4 => MatValue::Words(self.letters(head.rows)?),
            6..=15 => MatValue::Numbers(self.numbers()?),
            _ => MatValue::Other,
        })
    }

    /// Reads `count` consecutive `MATRIX` elements.
    fn matrices(&mut self, count: usize, depth: u32) -> Result<Vec<MatValue>, MatError> {
        // Each takes at least eight bytes; check before allocating.
        let left = (self.bytes.len().saturating_sub(self.at)) / 8;
        if count > left {
            return Err(MatError::Short {
                at: self.at,
                wanted: count.saturating_mul(8),
                left: left * 8,
            });
        }
        (0..count)
            .map(|_| {
                let element = self.element()?;
                if element.kind != ElementType::MATRIX {
                    return Err(MatError::damage_at(element.at, "an array is expected"));
                }
                element.inside(self.big_endian).matrix(depth + 1)
            })
            .collect()
    }

    fn structures(&mut self, count: usize, depth: u32) -> Result<MatValue, MatError> {
        let at = self.at;
        // The length of a name, and all names one after the other, each filled with zeros; then the
        // values of the first structure, of the second, …
        let length = self.numbers()?.first().copied().unwrap_or(0.0);
        let names = self.numbers()?;
        if !(1.0..=MOST_LETTERS).contains(&length) {
            return Err(MatError::damage_at(
                at,
                "a structure's field names have no length",
            ));
        }
        let names: Vec<Arc<str>> = names
            .chunks(length as usize)
            .map(|name| words(name).into())
            .collect();
        let total = count
            .checked_mul(names.len())
            .ok_or(MatError::damage_at(at, "an array has no size"))?;
        let mut values = self.matrices(total, depth)?.into_iter();
        // Elements without fields contain nothing.
        let count = if names.is_empty() { 0 } else { count };
        let elements = (0..count).map(|_| {
            let of_element = values.by_ref().take(names.len());
            names.iter().cloned().zip(of_element).collect()
        });
        Ok(MatValue::Structures(elements.collect()))
    }

    /// The first row of a character array, which is stored column by column.
    fn letters(&mut self, rows: Option<f64>) -> Result<String, MatError> {
        let Element { kind, bytes, at } = self.element()?;
        if kind == ElementType::UTF8 {
            return Ok(String::from_utf8_lossy(bytes).into_owned());
        }
        let width = kind
            .width()
            .ok_or(MatError::damage_at(at, "text is expected"))?;
        // Several rows lie side by side in memory, so that every `rows`-th letter is of the first.
        let rows = rows.unwrap_or(1.0).max(1.0) as usize;
        let numbers: Vec<f64> = bytes
            .chunks_exact(width)
            .step_by(rows)
            .map(|number| self.number(kind, number))
            .collect();
        Ok(words(&numbers))
    }
}

/// The text of character codes, up to the first 0.
fn words(numbers: &[f64]) -> String {
    let letters = numbers.iter().take_while(|number| **number != 0.0);
    letters
        .map(|number| char::from_u32(*number as u32).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}
