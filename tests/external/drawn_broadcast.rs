//! A drawn broadcast: its video and the truth beside it.

use crate::parts::{Test, tests};
use crate::program::touchline;
use touchline::media::Video;
use touchline_documents::testing::load;

pub const TESTS: &[Test] = tests![
    [Ffmpeg] a_broadcast_is_a_video_with_the_camera_of_every_frame;
];

fn a_broadcast_is_a_video_with_the_camera_of_every_frame() {
    let place = tempfile::tempdir().unwrap();
    let run = |arguments: &str| touchline(place.path(), arguments);
    run("synth -o drawn --broadcast 12 --seed 2 --size 64x36").done();
    let truth = load(place.path().join("drawn/truth.json"));
    let video = Video::open(&place.path().join("drawn/broadcast.mp4")).unwrap();
    assert_eq!(
        (video.info().decoded_frames, truth.frames.len()),
        (300, 300)
    );
    assert!(truth.shots.len() > 1 && truth.cameras.len() == 6);
    let video = truth.frames[7].video.as_ref().unwrap();
    assert_eq!(
        (video.path.as_str(), video.frame_index),
        ("broadcast.mp4", 7)
    );

    let odd = run("synth -o odd --broadcast 9 --size 65x36");
    odd.assert_refused(2);
    odd.assert_says("odd side");
}
