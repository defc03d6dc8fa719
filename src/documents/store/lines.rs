//! Checksummed lines of JSON, the format of the journal and the history file: `length crc32
//! json\n`, with length (bytes of the JSON) and checksum in eight hexadecimal digits each.

use serde::Serialize;
use std::io::{self, Write};

/// Length of `length crc32 `, bytes.
const PREFIX_BYTES: usize = 18;

/// Serialises a record as a line.
pub(super) fn line(record: &impl Serialize) -> io::Result<String> {
    let json = serde_json::to_string(record)?;
    Ok(prefix(json.as_bytes()) + &json + "\n")
}

/// Serialises a record as a line of at most `most_bytes` bytes; none if it is longer. Serialisation
/// stops at the limit.
pub(super) fn line_within(
    record: &impl Serialize,
    most_bytes: usize,
) -> io::Result<Option<Vec<u8>>> {
    let mut json = Bounded {
        bytes: Vec::new(),
        room: most_bytes.saturating_sub(PREFIX_BYTES + 1),
    };
    match serde_json::to_writer(&mut json, record) {
        // `Bounded` is the only writer that can fail here, and only for want of room.
        Err(error) if error.is_io() => Ok(None),
        Err(error) => Err(error.into()),
        Ok(()) => {
            let mut line = prefix(&json.bytes).into_bytes();
            line.extend(json.bytes);
            line.push(b'\n');
            Ok(Some(line))
        }
    }
}

/// A buffer with a maximum size. A write beyond it is an error.
struct Bounded {
    bytes: Vec<u8>,
    room: usize,
}

impl Write for Bounded {
    fn write(&mut self, more: &[u8]) -> io::Result<usize> {
        if self.bytes.len() + more.len() > self.room {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes.extend(more);
        Ok(more.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The JSON of the first line, and the line's length in bytes. None if the line is incomplete or
/// its checksum is wrong.
pub(super) fn first_line(bytes: &[u8]) -> Option<(&[u8], usize)> {
    // Nothing of the bytes is trusted: a length may exceed what is there, or overflow. The prefix
    // that belongs to the JSON is made anew and compared, which checks length, checksum and form at
    // once.
    let digits = std::str::from_utf8(bytes.get(..8)?).ok()?;
    let end = PREFIX_BYTES.checked_add(usize::from_str_radix(digits, 16).ok()?)?;
    let json = bytes.get(PREFIX_BYTES..end)?;
    (bytes.get(end) == Some(&b'\n') && bytes.starts_with(prefix(json).as_bytes()))
        .then_some((json, end + 1))
}

fn prefix(json: &[u8]) -> String {
    format!("{:08x} {:08x} ", json.len(), crc32fast::hash(json))
}
