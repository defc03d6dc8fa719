//! The id of a frame: a short string that stays the same when frames are added, removed or moved.

use serde::{Deserialize, Deserializer, Serialize};
use sha2::{Digest, Sha256};
use std::fmt;
use std::sync::Arc;

/// The maximum length of an id, bytes.
const MAX_BYTES: usize = 128;

/// The id of a frame, unique within a document. Edits, suggestions and undo refer to it, never to a
/// position.
///
/// A frame that is made takes its id from its picture. One that was read without an id has an empty
/// one until it is among the frames of a document, which give it its own.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct FrameId(Arc<str>);

impl FrameId {
    /// The id as the document writes it.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether the frame was read without an id and has not been given one.
    pub(in crate::document) fn is_missing(&self) -> bool {
        self.0.is_empty()
    }

    /// The id of a frame that has none: twelve hexadecimal digits of a hash of its image's path, or
    /// else of its video's path and the number of the frame.
    pub(super) fn from_picture(image: Option<&str>, video: Option<(&str, u64)>) -> Self {
        // The words and the zero bytes separate the cases: no path contains a zero byte, so that an
        // image never gets the id of a frame of a video. These bytes may never change, because
        // documents without ids rely on them.
        let hash = Sha256::new();
        let hash = match (image, video) {
            (Some(image), _) => hash.chain_update("image\0").chain_update(image),
            (None, Some((path, index))) => hash
                .chain_update("video\0")
                .chain_update(path)
                .chain_update(index.to_be_bytes()),
            (None, None) => hash,
        };
        // Six bytes: among a million pictures, two have the same digest with a probability of about
        // 0.2 %, and then `free` tells them apart.
        let mut first = [0; 8];
        first[2..].copy_from_slice(&hash.finalize()[..6]);
        Self(format!("{:012x}", u64::from_be_bytes(first)).into())
    }

    /// `id`, or one of `id-2`, `id-3`, … that is free while the one before it is taken; the first
    /// free one if there are no gaps. Found by an exponential search and bisection instead of a
    /// linear search, because one picture may have many frames.
    pub(in crate::document) fn free(self, is_taken: impl Fn(&Self) -> bool) -> Self {
        if !is_taken(&self) {
            return self;
        }
        // The number that stands for `id` itself is 1. `taken` is always a taken number; the first
        // loop ends at one that is free, the second one halves the gap between the two.
        let (mut taken, mut step) = (1, 1);
        while is_taken(&self.with_number(taken + step)) {
            taken += step;
            step *= 2;
        }
        let mut free = taken + step;
        while free - taken > 1 {
            let between = taken.midpoint(free);
            if is_taken(&self.with_number(between)) {
                taken = between;
            } else {
                free = between;
            }
        }
        self.with_number(free)
    }

    /// The id with a number appended, shortened to the maximum length.
    fn with_number(&self, number: u64) -> Self {
        let number = format!("-{number}");
        let end = self.0.floor_char_boundary(MAX_BYTES - number.len());
        Self((self.0[..end].to_owned() + &number).into())
    }
}

impl From<&str> for FrameId {
    fn from(id: &str) -> Self {
        Self(id.into())
    }
}

impl fmt::Display for FrameId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for FrameId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let id = Arc::<str>::deserialize(deserializer)?;
        if id.is_empty() || id.len() > MAX_BYTES || id.chars().any(char::is_control) {
            let wanted = format!(
                "a frame's id has 1 to {MAX_BYTES} bytes and no control characters, found {id:?}"
            );
            return Err(serde::de::Error::custom(wanted));
        }
        Ok(Self(id))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_follows_from_the_picture_and_is_the_same_for_ever() {
        let image = FrameId::from_picture(Some("images/0001.jpg"), None);
        assert_eq!(
            image,
            FrameId::from_picture(Some("images/0001.jpg"), Some(("match.mp4", 3)))
        );
        assert_eq!(image.as_str(), "48ffd214d244");
        let video = FrameId::from_picture(None, Some(("match.mp4", 412)));
        assert_eq!(video.as_str(), "0859afc6239f");
        assert_ne!(video, FrameId::from_picture(None, Some(("match.mp4", 413))));
    }

    #[test]
    fn a_taken_id_gets_a_number() {
        let taken = ["a", "a-2", "b"].map(FrameId::from);
        let free = |id: &str| FrameId::from(id).free(|id| taken.contains(id)).to_string();
        assert_eq!([free("a"), free("b"), free("c")], ["a-3", "b-2", "c"]);
        let taken = 2..=1000;
        let is_taken = |id: &FrameId| {
            id.as_str()
                .strip_prefix("a-")
                .is_none_or(|n| taken.contains(&n.parse().unwrap()))
        };
        assert_eq!(FrameId::from("a").free(is_taken).as_str(), "a-1001");
    }

    #[test]
    fn a_long_id_with_a_number_is_still_an_id() {
        let long = FrameId::from("é".repeat(MAX_BYTES / 2).as_str());
        let numbered = long.clone().free(|id| *id == long);
        assert!(
            numbered.as_str().ends_with("é-2") && numbered.as_str().len() <= MAX_BYTES,
            "{numbered}"
        );
    }

    #[test]
    fn what_is_no_id_is_refused() {
        let read = |json: &str| {
            serde_json::from_str::<FrameId>(json)
                .map(|id| id.to_string())
                .ok()
        };
        assert_eq!(read("\"anna/7\"").as_deref(), Some("anna/7"));
        let too_long = format!("\"{}\"", "x".repeat(MAX_BYTES + 1));
        assert!(
            ["\"\"", "\"a\\n\"", "7", &too_long]
                .into_iter()
                .all(|json| read(json).is_none())
        );
    }
}
