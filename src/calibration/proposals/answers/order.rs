//! The order in which the forest is queried for frames.

use touchline_documents::document::{Document, shots};

/// Number of frames on either side of the current one that are queried first.
const FRAMES_BESIDE: usize = 8;

/// Longer shots, such as uncut recordings, are split into parts of this length.
const LONGEST_SHOT: usize = 250;

/// The frames in the order of their queries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct QueryOrder {
    /// The neighbours of the current frame in its shot, then one frame of each shot that has none
    /// yet.
    pub first: Vec<usize>,
    /// All others.
    pub rest: Vec<usize>,
}

impl QueryOrder {
    /// The order of the frames for which `wanted` is true. Within each part, frames nearer to the
    /// current one come first.
    pub fn new(document: &Document, current: usize, wanted: impl Fn(usize) -> bool) -> Self {
        // `wanted` is called once for each frame.
        let is_wanted: Vec<bool> = (0..document.frames.len()).map(&wanted).collect();
        let distance = |index: &usize| (index.abs_diff(current), *index);
        let mut taken = vec![false; is_wanted.len()];
        let mut order = Self::default();
        let shots = shots(document);

        // First the neighbours in the current shot, because the user looks at them next.
        if let Some((shot, at)) = shots
            .iter()
            .find_map(|shot| Some((shot, shot.binary_search(&current).ok()?)))
        {
            let near =
                &shot[at.saturating_sub(FRAMES_BESIDE)..(at + FRAMES_BESIDE + 1).min(shot.len())];
            order
                .first
                .extend(near.iter().filter(|&&index| is_wanted[index]));
            order.first.sort_by_key(distance);
            for &index in &order.first {
                taken[index] = true;
            }
        }
        // Then one frame of each shot that has none yet: the middle one, which is least likely to
        // lie in a blend.
        let mut one_a_shot: Vec<usize> = shots
            .iter()
            .flat_map(|shot| shot.chunks(LONGEST_SHOT))
            .filter(|shot| shot.iter().all(|&index| is_wanted[index] && !taken[index]))
            .map(|shot| shot[shot.len() / 2])
            .collect();
        one_a_shot.sort_by_key(distance);
        for &index in &one_a_shot {
            taken[index] = true;
        }
        order.first.extend(one_a_shot);
        // Then all others.
        order.rest = (0..is_wanted.len())
            .filter(|&index| is_wanted[index] && !taken[index])
            .collect();
        order.rest.sort_by_key(distance);
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::Clip;
    use touchline_documents::testing::{new_frame, soccer_document};

    /// Shots of some lengths, one after the other.
    fn document(lengths: &[usize]) -> Document {
        let mut document = soccer_document();
        for (shot, &length) in lengths.iter().enumerate() {
            for _ in 0..length {
                let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
                frame.clip = Some(Clip::Number(shot as i64));
                document.frames.push(frame.into());
            }
        }
        document
    }

    #[test]
    fn neighbours_first_then_one_of_each_shot_then_the_rest() {
        let document = document(&[5, 30, 5, 5]);
        let order = QueryOrder::new(&document, 20, |index| index != 20 && index != 36);
        assert_eq!(order.first[..4], [19, 21, 18, 22]);
        assert_eq!(
            order.first[16..],
            [2, 42],
            "shot 2 has an answer already, shot 1 is the current one"
        );
        assert_eq!(order.rest[..2], [11, 29]);
        assert_eq!(
            order.first.len() + order.rest.len(),
            43,
            "every wanted frame once"
        );
        let mut all: Vec<_> = order.first.into_iter().chain(order.rest).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 43);
    }

    #[test]
    fn a_recording_without_shots_is_sampled() {
        let document = document(&[1000]);
        let order = QueryOrder::new(&document, 0, |_| true);
        assert_eq!(order.first[9..], [375, 625, 875]);
        assert_eq!(
            QueryOrder::new(&document, 0, |_| false),
            QueryOrder::default()
        );
        assert_eq!(
            QueryOrder::new(&soccer_document(), 7, |_| true),
            QueryOrder::default()
        );
    }
}
