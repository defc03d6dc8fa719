//! Where a frame is in time, as far as it says so itself.

use crate::document::Frame;

/// The place of a frame in time: a number among the frames of one run.
///
/// The order of a document's frames is that of its files, and says nothing about time: `corner`
/// comes before `goal` by the alphabet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment<'a> {
    /// What names the run: the video, or the name of the image before and after its number.
    run: [&'a str; 2],
    /// The number of the frame in its run.
    number: u64,
}

impl<'a> Moment<'a> {
    /// The number of frames from here to another moment, negative if that is earlier; none if it is
    /// of another run.
    pub fn frames_to(&self, other: &Self) -> Option<f64> {
        (self.run == other.run).then_some(other.number as f64 - self.number as f64)
    }

    /// What names the run.
    pub const fn run(&self) -> [&'a str; 2] {
        self.run
    }

    /// A frame of a video, by its number there.
    pub(crate) const fn in_video(path: &'a str, number: u64) -> Self {
        Self {
            run: [path, ""],
            number,
        }
    }

    /// The last run of digits in a name without its ending.
    pub(crate) fn from_name(name: &'a str) -> Option<Self> {
        // An ending of digits alone belongs to the name: `frame.000017`.
        let stem = match name.rsplit_once('.') {
            Some((stem, ending)) if !ending.bytes().all(|byte| byte.is_ascii_digit()) => stem,
            _ => name,
        };
        let end = stem.rfind(|letter: char| letter.is_ascii_digit())? + 1;
        let before = stem[..end].trim_end_matches(|letter: char| letter.is_ascii_digit());
        Some(Self {
            run: [before, &stem[end..]],
            number: stem[before.len()..end].parse().ok()?,
        })
    }
}

impl Frame {
    /// Where it is in time: its number in its video, else that at the end of its image's name. None
    /// for an image without a number.
    pub fn moment(&self) -> Option<Moment<'_>> {
        match (&self.video, &self.image) {
            (Some(video), _) => Some(Moment::in_video(&video.path, video.frame_index)),
            (None, Some(image)) => Moment::from_name(image),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::VideoFrame;
    use crate::testing::new_frame;
    use touchline_core::geometry::ImageSize;

    fn frames_between(one: &str, other: &str) -> Option<f64> {
        let frame = |name| new_frame(name, ImageSize::new(64, 36));
        let (one, other) = (frame(one), frame(other));
        one.moment()?.frames_to(&other.moment()?)
    }

    #[test]
    fn names_of_one_run_state_how_many_frames_lie_between() {
        for (one, other, frames) in [
            ("000017.jpg", "000019.jpg", Some(2.0)),
            ("9.jpg", "10.jpg", Some(1.0)),
            ("clip/frame_25.png", "clip/frame_0.png", Some(-25.0)),
            ("frame.000017", "frame.000018", Some(1.0)),
            ("17_left.jpg", "18_left.jpg", Some(1.0)),
            ("a/17.jpg", "b/18.jpg", None),
            ("match-1-07.jpg", "match-2-08.jpg", None),
            ("17_720p.jpg", "18_720p.jpg", None),
            ("corner.jpg", "goal.jpg", None),
            ("goal.jpg", "7.jpg", None),
            ("99999999999999999999999.jpg", "1.jpg", None),
        ] {
            assert_eq!(frames_between(one, other), frames, "{one} {other}");
        }
    }

    #[test]
    fn frames_of_one_video_are_counted_there() {
        let size = ImageSize::new(64, 36);
        let frame = |path, index| {
            Frame::from_video(VideoFrame::new(path, index, None), "main".into(), size)
        };
        let [first, later, other] = [
            frame("match.mp4", 3),
            frame("match.mp4", 12),
            frame("b.mp4", 4),
        ];
        let moment = |frame: &Frame| frame.moment().unwrap().number;
        assert_eq!((moment(&first), moment(&later)), (3, 12));
        let between = |to: &Frame| first.moment().unwrap().frames_to(&to.moment().unwrap());
        assert_eq!((between(&later), between(&other)), (Some(9.0), None));
    }
}
