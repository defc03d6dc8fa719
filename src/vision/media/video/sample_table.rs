//! The times of an MP4's frames, read from its sample table without decoding (ISO/IEC 14496-12,
//! `stbl`).

use crate::media::MediaError;
use crate::media::error::open_file;
use mp4parse::unstable::create_sample_table;
use mp4parse::{Track, TrackType, read_mp4};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Maximum size of the index, bytes: for ten hours at 60 frames a second with sound it is about 40
/// MB.
const MOST_BYTES: u64 = 512 << 20;

/// The presentation times of an MP4's frames, s from the first, ascending. `None` if the file is
/// truncated, fragmented or edited (so that frames are dropped), has several video tracks, or is no
/// MP4; then only decoding determines the times.
///
/// # Errors
/// The file cannot be read.
pub(super) fn sample_times_s(path: &Path) -> Result<Option<Vec<f64>>, MediaError> {
    let mut file = open_file(path)?;
    let bytes = file
        .metadata()
        .map_err(|error| MediaError::from_io(path, &error))?
        .len();
    let boxes = index_boxes(&mut file, bytes).map_err(|error| MediaError::from_io(path, &error))?;
    Ok(boxes.and_then(|boxes| times_s(&boxes, bytes)))
}

/// The boxes `ftyp` and `moov`, which identify the file and index its content; `None` if one is
/// missing or too large, or the file is fragmented (`moof`).
fn index_boxes(file: &mut File, bytes: u64) -> std::io::Result<Option<Vec<u8>>> {
    const WIDE_HEADER: u64 = 16;
    let (mut kind_of_file, mut index) = (None, None);
    let mut at = 0;
    while at + WIDE_HEADER <= bytes {
        file.seek(SeekFrom::Start(at))?;
        let mut head = [0; WIDE_HEADER as usize];
        file.read_exact(&mut head)?;
        // The length of a box is 32 bits; 0 means to the end of the file, 1 that 64 bits follow its
        // type.
        let length = match big_endian(&head[..4]) {
            0 => bytes - at,
            1 => big_endian(&head[8..16]),
            length => length,
        };
        // Shorter than its own head: damaged; longer than the file: cut off.
        if length < 8 || length > bytes - at {
            return Ok(None);
        }
        let kept = match &head[4..8] {
            b"moof" => return Ok(None),
            b"ftyp" => Some(&mut kind_of_file),
            b"moov" => Some(&mut index),
            _ => None,
        };
        if let Some(kept) = kept {
            if length > MOST_BYTES {
                return Ok(None);
            }
            file.seek(SeekFrom::Start(at))?;
            let mut content = Vec::new();
            file.take(length).read_to_end(&mut content)?;
            *kept = Some(content);
        }
        at += length;
    }
    Ok(kind_of_file
        .zip(index)
        .map(|(kind_of_file, index)| [kind_of_file, index].concat()))
}

/// The number that is stored in up to eight bytes, the most significant first.
fn big_endian(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0, |all, byte| all << 8 | u64::from(*byte))
}

fn times_s(boxes: &[u8], file_bytes: u64) -> Option<Vec<f64>> {
    let context = read_mp4(&mut &*boxes).ok()?;
    let mut videos = context
        .tracks
        .iter()
        .filter(|track| track.track_type == TrackType::Video);
    let (video, None) = (videos.next()?, videos.next()) else {
        return None;
    };
    // A sample beyond the end of the file: truncated.
    let samples = create_sample_table(video, 0.into())?;
    if samples
        .iter()
        .any(|sample| sample.end_offset.0 > file_bytes)
    {
        return None;
    }
    // Samples are stored in decoding order; frames are shown in order of composition time.
    let mut times: Vec<i64> = samples
        .iter()
        .map(|sample| sample.start_composition.0)
        .collect();
    times.sort_unstable();
    let first = *times.first()?;
    let scale = video.timescale?.0 as f64;
    is_whole(video, first).then(|| {
        times
            .into_iter()
            .map(|time| (time - first) as f64 / scale)
            .collect()
    })
}

/// Whether the edit list drops no frame at the beginning of a track whose first frame has this
/// time.
fn is_whole(track: &Track, first: i64) -> bool {
    track
        .media_time
        .is_none_or(|start| i64::try_from(start.0).is_ok_and(|start| start <= first))
}
