//! An archive of arrays as `numpy.savez` and `numpy.savez_compressed` write it (`.npz`): a zip file
//! with one `.npy` file per array.
//!
//! The container is read here instead of by a crate, because such archives use only two kinds of
//! zip entry, stored and deflated, and the table at the end of the file (APPNOTE 6.3, 4.3.7, 4.3.12
//! and 4.3.16). `flate2`, which MATLAB files need as well, decompresses. Sizes are taken from that
//! table, because `NumPy` may leave those before the data unset. Allocations are limited, whatever
//! sizes a file states.

use super::npy;
use super::npy::Array;
use super::values::shorten;
use crate::exchange::error::Problem;
use crate::exchange::files::MAX_FILE_BYTES;
use flate2::read::DeflateDecoder;
use std::collections::BTreeMap;
use std::io::Read as _;

const LOCAL: &[u8] = b"PK\x03\x04";
const CENTRAL: &[u8] = b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";
/// The fixed part of an entry's local header, bytes.
const LOCAL_BYTES: usize = 30;
/// The fixed part of an entry of the table (central directory), bytes.
const CENTRAL_BYTES: usize = 46;
/// The fixed part of the record at the end of the file, bytes.
const END_BYTES: usize = 22;
/// The longest comment behind it, bytes.
const MAX_COMMENT: usize = 65_535;
/// The maximum number of entries that are read; archives of cameras have five.
const MAX_ENTRIES: usize = 1000;
/// The zip version that is needed to extract written archives.
const VERSION: u16 = 20;
/// 1 January 1980, the first day of the format: a fixed date, so that the same arrays give the same
/// bytes.
const FIRST_DAY: u16 = 0x21;
const STORED: u16 = 0;
const DEFLATED: u16 = 8;
/// The flag of an entry that is encrypted.
const ENCRYPTED: u16 = 1;

/// An opened archive; its entries are still compressed.
#[derive(Debug)]
pub struct Npz<'a> {
    bytes: &'a [u8],
    entries: BTreeMap<String, Entry>,
}

/// The location of an array in the file.
#[derive(Clone, Copy, Debug)]
struct Entry {
    flags: u16,
    method: u16,
    crc: u32,
    packed: usize,
    unpacked: usize,
    at: usize,
}

fn wrong(found: impl Into<String>) -> Problem {
    Problem::not_format("an archive as numpy.savez writes it (.npz)", found)
}

/// The error of an archive without its table.
fn damaged_table() -> Problem {
    wrong("the table at its end is missing or damaged; copy the file again")
}

/// The error of an array that cannot be unpacked.
fn damage_in(found: &str, array: &str) -> Problem {
    wrong(format!("{found} in the array {array}; copy the file again"))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(
        bytes.get(at..at.checked_add(2)?)?.try_into().ok()?,
    ))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(
        bytes.get(at..at.checked_add(4)?)?.try_into().ok()?,
    ))
}

impl<'a> Npz<'a> {
    /// Reads the table of an archive.
    ///
    /// # Errors
    /// It is empty, not such an archive, or truncated.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Problem> {
        if bytes.is_empty() {
            return Err(Problem::Empty);
        }
        // An archive of no arrays begins with its end.
        if !bytes.starts_with(LOCAL) && !bytes.starts_with(END) {
            return Err(wrong("it does not begin as a zip file"));
        }
        // The record at the end is followed by a comment of any length up to the limit, so that it
        // is searched from behind; the same four bytes may stand within an array.
        let from = bytes.len().saturating_sub(END_BYTES + MAX_COMMENT);
        let end = bytes[from..]
            .windows(END.len())
            .rposition(|window| window == END)
            .map(|at| from + at);
        let end = end.ok_or_else(damaged_table)?;
        // The number of entries and the place of the table, as counted from the file's beginning.
        let count = usize::from(u16_at(bytes, end + 10).ok_or_else(damaged_table)?);
        if count > MAX_ENTRIES {
            return Err(wrong(format!(
                "it states {count} arrays, and at most {MAX_ENTRIES} are read"
            )));
        }
        let mut at = u32_at(bytes, end + 16).ok_or_else(damaged_table)? as usize;
        let mut entries = BTreeMap::new();
        for _ in 0..count {
            let (name, entry, next) = entry_at(bytes, at).ok_or_else(damaged_table)?;
            let key = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
            if entries.insert(key, entry).is_some() {
                return Err(Problem::twice("the array", shorten(&name)));
            }
            at = next;
        }
        Ok(Self { bytes, entries })
    }

    /// The names of its arrays.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    /// An array by its name; none where the archive does not contain it.
    ///
    /// # Errors
    /// It is damaged, compressed by another method, or too large.
    pub fn find(&self, name: &str) -> Result<Option<Array>, Problem> {
        let Some(entry) = self.entries.get(name) else {
            return Ok(None);
        };
        let bytes = self.unpack(name, *entry)?;
        npy::array(&bytes)
            .map(Some)
            .map_err(|problem| problem.at_array(name))
    }

    /// An array by its name.
    ///
    /// # Errors
    /// It is missing, or as for [`Self::find`].
    pub fn array(&self, name: &str) -> Result<Array, Problem> {
        self.find(name)?
            .ok_or_else(|| Problem::Missing(format!("the array {name}")))
    }

    fn unpack(&self, name: &str, entry: Entry) -> Result<Vec<u8>, Problem> {
        if entry.flags & ENCRYPTED != 0 {
            return Err(Problem::not_supported(
                format!("the array {name}"),
                "it is encrypted",
            ));
        }
        // Before anything is unpacked: a few kilobytes may state, and unpack to, gigabytes.
        if entry.unpacked as u64 > MAX_FILE_BYTES {
            let too_large = Problem::TooLarge {
                bytes: entry.unpacked as u64,
                limit: MAX_FILE_BYTES,
            };
            return Err(too_large.at_array(name));
        }
        let data =
            data_of(self.bytes, entry).ok_or_else(|| damage_in("bytes are missing", name))?;
        let unpacked = match entry.method {
            STORED => data.to_vec(),
            DEFLATED => {
                let mut unpacked = Vec::new();
                // One byte more than stated is enough to see that a size is wrong.
                let limit = entry.unpacked as u64 + 1;
                let read = DeflateDecoder::new(data)
                    .take(limit)
                    .read_to_end(&mut unpacked);
                read.map_err(|_| damage_in("the packed bytes are damaged", name))?;
                unpacked
            }
            other => {
                let what = format!("the array {name}, packed by method {other}");
                return Err(Problem::not_supported(
                    what,
                    "save it with numpy.savez or numpy.savez_compressed",
                ));
            }
        };
        if unpacked.len() != entry.unpacked || crc32fast::hash(&unpacked) != entry.crc {
            return Err(damage_in("the check sum is wrong", name));
        }
        Ok(unpacked)
    }
}

/// An entry of the table with its name, and the offset of the next one.
fn entry_at(bytes: &[u8], at: usize) -> Option<(String, Entry, usize)> {
    let fixed = bytes.get(at..at.checked_add(CENTRAL_BYTES)?)?;
    if !fixed.starts_with(CENTRAL) {
        return None;
    }
    let entry = Entry {
        flags: u16_at(fixed, 8)?,
        method: u16_at(fixed, 10)?,
        crc: u32_at(fixed, 16)?,
        packed: u32_at(fixed, 20)? as usize,
        unpacked: u32_at(fixed, 24)? as usize,
        at: u32_at(fixed, 42)? as usize,
    };
    let lengths = [28, 30, 32].map(|place| u16_at(fixed, place).map(usize::from));
    let [name, extra, comment] = [lengths[0]?, lengths[1]?, lengths[2]?];
    let from = at + CENTRAL_BYTES;
    let text = String::from_utf8_lossy(bytes.get(from..from.checked_add(name)?)?).into_owned();
    Some((text, entry, from + name + extra + comment))
}

/// The compressed bytes of an entry.
fn data_of(bytes: &[u8], entry: Entry) -> Option<&[u8]> {
    let local = bytes.get(entry.at..)?;
    if !local.starts_with(LOCAL) {
        return None;
    }
    // The name and the extra field stand before the data. Their lengths are read here, for the
    // local extra field may differ from that of the table.
    let lengths = usize::from(u16_at(local, 26)?) + usize::from(u16_at(local, 28)?);
    let from = LOCAL_BYTES + lengths;
    local.get(from..from.checked_add(entry.packed)?)
}

/// The bytes of an archive of arrays, stored as `numpy.savez` does.
pub fn archive_to_bytes(arrays: &[(&str, Array)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut table = Vec::new();
    for (name, array) in arrays {
        let name = format!("{name}.npy");
        let data = array.to_bytes();
        let at = bytes.len() as u32;
        // What the entry's local header and the table have in common: version, flags, method, time
        // and date, check sum, both sizes, and the lengths of the name and of the extra field.
        let mut common = Vec::new();
        for number in [VERSION, 0, STORED, 0, FIRST_DAY] {
            common.extend(number.to_le_bytes());
        }
        for number in [crc32fast::hash(&data), data.len() as u32, data.len() as u32] {
            common.extend(number.to_le_bytes());
        }
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        bytes.extend(
            LOCAL
                .iter()
                .chain(&common)
                .chain(name.as_bytes())
                .chain(&data),
        );
        table.extend(CENTRAL);
        table.extend(VERSION.to_le_bytes());
        table.extend(common);
        // No comment, the first disk, no attributes.
        table.extend([0; 10]);
        table.extend(at.to_le_bytes());
        table.extend(name.as_bytes());
    }
    let (count, at) = (arrays.len() as u16, bytes.len() as u32);
    let length = table.len() as u32;
    // The table and the record at the end: one disk, the number of entries on it and in all, the
    // table's length and place, no comment.
    bytes.extend(table);
    bytes.extend(END);
    bytes.extend([0; 4]);
    bytes.extend([count, count].into_iter().flat_map(u16::to_le_bytes));
    bytes.extend([length, at].into_iter().flat_map(u32::to_le_bytes));
    bytes.extend([0, 0]);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::DeflateEncoder;
    use std::io::Write as _;

    fn sample() -> Array {
        Array {
            shape: vec![2, 3],
            values: vec![1.5, -2.0, 0.0, 4.25, 5.0, 1e-17],
        }
    }

    /// The same archive with its only array deflated.
    fn deflated(array: &Array) -> Vec<u8> {
        let data = array.to_bytes();
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&data).unwrap();
        let packed = encoder.finish().unwrap();
        let stored = archive_to_bytes(&[("K", array.clone())]);
        let from = LOCAL_BYTES + "K.npy".len();
        let mut bytes = [&stored[..from], &packed, &stored[from + data.len()..]].concat();
        let table = from + packed.len();
        bytes[table + 10..table + 12].copy_from_slice(&DEFLATED.to_le_bytes());
        bytes[table + 20..table + 24].copy_from_slice(&(packed.len() as u32).to_le_bytes());
        let end = bytes.len() - END_BYTES;
        bytes[end + 16..end + 20].copy_from_slice(&(table as u32).to_le_bytes());
        bytes
    }

    #[test]
    fn stored_and_deflated_arrays_come_back() {
        let bytes = archive_to_bytes(&[
            ("K", sample()),
            (
                "t",
                Array {
                    shape: vec![1],
                    values: vec![7.0],
                },
            ),
        ]);
        let archive = Npz::open(&bytes).unwrap();
        assert_eq!(archive.names().collect::<Vec<_>>(), ["K", "t"]);
        assert_eq!(
            (archive.array("K").unwrap(), archive.find("R").unwrap()),
            (sample(), None)
        );
        let bytes = deflated(&sample());
        assert_eq!(Npz::open(&bytes).unwrap().array("K").unwrap(), sample());
    }

    #[test]
    fn damaged_and_hostile_archives_are_named() {
        let good = archive_to_bytes(&[("K", sample())]);
        let end = good.len() - END_BYTES;
        let table = end - CENTRAL_BYTES - "K.npy".len();
        let with = |at: usize, new: &[u8]| {
            let mut bytes = good.clone();
            bytes[at..at + new.len()].copy_from_slice(new);
            bytes
        };
        let not = "not an archive as numpy.savez writes it (.npz): ";
        let cut = format!("{not}the table at its end is missing or damaged; copy the file again");
        let missing = format!("{not}bytes are missing in the array K; copy the file again");
        let sum = format!("{not}the check sum is wrong in the array K; copy the file again");
        for (bytes, wanted) in [
            (Vec::new(), "the file is empty".to_owned()),
            (b"\x93NUMPY".to_vec(), format!("{not}it does not begin as a zip file")),
            (good[..good.len() - END_BYTES].to_vec(), cut.clone()),
            (good[..40].to_vec(), cut.clone()),
            (with(end + 16, &u32::MAX.to_le_bytes()), cut.clone()),
            (with(end + 10, &2_u16.to_le_bytes()), cut),
            (
                with(end + 10, &u16::MAX.to_le_bytes()),
                format!("{not}it states 65535 arrays, and at most 1000 are read"),
            ),
            (with(table + 42, &u32::MAX.to_le_bytes()), missing.clone()),
            (with(table + 20, &u32::MAX.to_le_bytes()), missing),
            (with(table + 24, &u32::MAX.to_le_bytes()), "K: it is 4096 MiB, at most 64 MiB are read".to_owned()),
            (with(table + 16, &[1, 2, 3, 4]), sum),
            (
                with(table + 10, &[12, 0]),
                "the array K, packed by method 12 cannot be read: save it with numpy.savez or numpy.savez_compressed"
                    .to_owned(),
            ),
            (with(table + 8, &[1, 0]), "the array K cannot be read: it is encrypted".to_owned()),
            (
                // A block of a type that the format does not have.
                [&deflated(&sample())[..LOCAL_BYTES + 5], &[7], &deflated(&sample())[LOCAL_BYTES + 6..]].concat(),
                format!("{not}the packed bytes are damaged in the array K; copy the file again"),
            ),
        ] {
            let problem = Npz::open(&bytes).and_then(|archive| archive.array("K")).unwrap_err();
            assert_eq!(problem.to_string(), wanted);
        }
        let bomb = deflated(&Array {
            shape: vec![100_000],
            values: vec![0.0; 100_000],
        });
        let table = bomb.len() - END_BYTES - CENTRAL_BYTES - "K.npy".len();
        let mut understated = bomb;
        understated[table + 24..table + 28].copy_from_slice(&100_u32.to_le_bytes());
        let problem = Npz::open(&understated).unwrap().array("K").unwrap_err();
        assert!(
            problem.to_string().contains("check sum"),
            "no more is unpacked than is stated: {problem}"
        );
    }
}
