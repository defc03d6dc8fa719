//! Checksummed lines of JSON, as the journal and the history file hold them: `length crc32 json\n`,
//! length and checksum in eight hexadecimal digits.

use serde::Serialize;
use std::io::{self, Write};

/// Length and checksum, each followed by a space.
const PREFIX_BYTES: usize = 18;

/// A value as a line.
pub(super) fn line(record: &impl Serialize) -> io::Result<String> {
    let json = serde_json::to_string(record)?;
    Ok(prefix(json.as_bytes()) + &json + "\n")
}

/// A value as a line of at most `most_bytes` bytes; none if it does not fit. What does not fit is
/// not written out to its end.
pub(super) fn line_within(
    record: &impl Serialize,
    most_bytes: usize,
) -> io::Result<Option<Vec<u8>>> {
    let mut json = Bounded {
        bytes: Vec::new(),
        room: most_bytes.saturating_sub(PREFIX_BYTES + 1),
    };
    match serde_json::to_writer(&mut json, record) {
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

/// Bytes that refuse to grow beyond their room.
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

/// The first whole line of some bytes: its JSON and its length in bytes.
pub(super) fn first_line(bytes: &[u8]) -> Option<(&[u8], usize)> {
    let digits = std::str::from_utf8(bytes.get(..8)?).ok()?;
    let end = PREFIX_BYTES.checked_add(usize::from_str_radix(digits, 16).ok()?)?;
    let json = bytes.get(PREFIX_BYTES..end)?;
    (bytes.get(end) == Some(&b'\n') && bytes.starts_with(prefix(json).as_bytes()))
        .then_some((json, end + 1))
}

fn prefix(json: &[u8]) -> String {
    format!("{:08x} {:08x} ", json.len(), crc32fast::hash(json))
}
