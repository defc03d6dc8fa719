//! The order in which queued frames are read.

use std::collections::VecDeque;
use std::path::Path;
use touchline_vision::media::FrameRef;

/// Maximum number of frames before the most urgent one that are read on the way to it.
///
/// A video is decoded forward only. Going back to a frame costs about fifty frames of decoding; the
/// frames just before it cost 3 ms each if they are decoded in the same pass. Without this, each
/// step backwards would seek.
const ON_THE_WAY_FRAMES: usize = 16;

/// The index in `queue`, which has the most urgent frame first, of the next frame to read after
/// `last`: the most urgent, or the first queued frame of the same video shortly before it that the
/// decoder passes anyway. `None` if the queue is empty.
pub(super) fn next_place(queue: &VecDeque<FrameRef>, last: Option<&FrameRef>) -> Option<usize> {
    let FrameRef::Video {
        path,
        index: urgent,
    } = queue.front()?
    else {
        return Some(0);
    };
    // The decoder cannot pass frames at or before its own position.
    let stands_at = last
        .and_then(|frame| index_in_video(frame, path))
        .filter(|at| at < urgent);
    let from = urgent
        .saturating_sub(ON_THE_WAY_FRAMES)
        .max(stands_at.map_or(0, |at| at + 1));
    // Of the queued frames in that range the earliest, because the decoder only goes forward.
    let on_the_way = queue
        .iter()
        .enumerate()
        .filter_map(|(place, frame)| Some((index_in_video(frame, path)?, place)));
    on_the_way
        .filter(|(index, _)| (from..=*urgent).contains(index))
        .min()
        .map(|(_, place)| place)
}

/// The index of a frame among the decoded frames of a video. `None` if it is of another file.
fn index_in_video(frame: &FrameRef, video: &Path) -> Option<usize> {
    match frame {
        FrameRef::Video { path, index } if **path == *video => Some(*index),
        FrameRef::Video { .. } | FrameRef::Image(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fake_reader::frame;
    use super::*;
    use std::path::Path;

    /// The order in which a queue is read when the decoder is at a frame.
    fn order(queue: &[usize], stands_at: Option<usize>) -> Vec<usize> {
        let mut queue: VecDeque<_> = queue.iter().map(|&index| frame(index)).collect();
        let mut last = stands_at.map(frame);
        let mut order = Vec::new();
        while let Some(next) =
            next_place(&queue, last.as_ref()).and_then(|place| queue.remove(place))
        {
            let FrameRef::Video { index, .. } = next else {
                panic!()
            };
            order.push(index);
            last = Some(next);
        }
        order
    }

    #[test]
    fn forward_the_order_of_the_queue_is_kept() {
        assert_eq!(order(&[5, 6, 7, 8], Some(4)), [5, 6, 7, 8]);
        assert_eq!(
            order(&[5, 6, 7, 4, 3], Some(4)),
            [5, 6, 7, 3, 4],
            "those behind come last, in one pass"
        );
        assert_eq!(
            order(&[100, 101, 5], Some(4)),
            [100, 101, 5],
            "too far to be on the way"
        );
    }

    #[test]
    fn back_a_block_is_read_in_one_pass() {
        assert_eq!(order(&[20, 16, 17, 18, 19], Some(21)), [16, 17, 18, 19, 20]);
        // The user has come to 20 while the decoder is in the middle of the block.
        assert_eq!(order(&[20, 18, 19, 8, 9], Some(17)), [18, 19, 20, 8, 9]);
        assert_eq!(order(&[40, 10, 30], None), [30, 40, 10]);
    }

    #[test]
    fn other_files_are_not_on_the_way() {
        let image = FrameRef::image(Path::new("a.png"));
        let other = FrameRef::video(Path::new("other.mp4"), 4);
        let queue: VecDeque<_> = [frame(5), other.clone(), image.clone()].into();
        assert_eq!(next_place(&queue, Some(&other)), Some(0));
        assert_eq!(next_place(&[image, frame(5)].into(), None), Some(0));
        assert_eq!(next_place(&VecDeque::new(), None), None);
    }
}
