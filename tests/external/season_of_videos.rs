//! A season whose match is a video: its windows, and a video that changes.
#![cfg(feature = "opencv")]

use crate::parts::{Test, tests};
use crate::program::touchline;
use std::fs::{self, File};
use std::io::Write as _;
use std::process::Command;
use std::time::{Duration, SystemTime};
use touchline::document::{Frame, FrameStatus, VideoFrame};
use touchline::season::plan::Plan;
use touchline_documents::testing::{load, save};

pub const TESTS: &[Test] = tests![
    [Ffmpeg] windows_of_a_video_are_labelled_apart_and_join_in_its_project;
];

fn windows_of_a_video_are_labelled_apart_and_join_in_its_project() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    let run = |arguments: &str| touchline(place.path(), arguments);
    run("synth -o drawn --frames 16 --step 0.04 --seed 4 --size 640x360 --preset easy").done();
    let encoded = Command::new("ffmpeg")
        .args("-v error -framerate 10 -i drawn/images/%04d.jpg -c:v libx264".split(' '))
        .args("-pix_fmt yuv420p -crf 12 match.mp4".split(' '))
        .current_dir(place.path())
        .status();
    assert!(encoded.unwrap().success());
    let video = File::options().write(true).open(path("match.mp4")).unwrap();
    video
        .set_modified(SystemTime::now() - Duration::from_mins(1))
        .unwrap();

    // A person has labelled every fifth frame; the document names no other.
    let truth = load(path("drawn/truth.json"));
    let mut known = truth.clone();
    for (index, frame) in known.frames.iter_mut().enumerate() {
        let frame: &mut Frame = frame;
        frame.clicks.clear();
        frame.status = FrameStatus::Reference;
        (frame.image, frame.sha256) = (None, None);
        frame.video = Some(VideoFrame::new("match.mp4", index as u64, None));
    }
    let mut index = 0;
    known.frames.retain(|_| {
        index += 1;
        (index - 1) % 5 == 0
    });
    save(path("known.json"), &known);
    let season = "[options]\nwindow_s = 1\n[[match]]\nvideo = 'match.mp4'\nproject = 'known.json'";
    fs::write(path("season.toml"), season).unwrap();

    run("plan season.toml -o plan.json").done();
    assert!(
        path("match.mp4.touchline-hash").exists(),
        "the hash is kept"
    );
    let plan = Plan::read(&path("plan.json")).unwrap();
    let ends = plan.matches[0].labels.iter();
    let ends: Vec<_> = ends.map(|label| (label.first, label.last)).collect();
    assert_eq!(ends, [(0, 9), (10, 15)]);
    for parts in ["parts", "again"] {
        for id in plan.shard_ids() {
            run(&format!("shard plan.json {id} -o {parts}")).done();
        }
    }
    for id in plan.shard_ids() {
        let [one, other] = ["parts", "again"]
            .map(|parts| fs::read(path(parts).join(format!("{id}.part"))).unwrap());
        assert!(one == other, "{id}");
    }

    run("collect plan.json parts -o out").done();
    let project = load(path("out/match/project.json"));
    assert_eq!(project.frames.len(), 16);
    for (number, (frame, exact)) in project.frames.iter().zip(&truth.frames).enumerate() {
        assert_eq!(frame.number_at(99), number as u64);
        let [found, exact] = [frame, exact].map(|frame| frame.ptz.as_ref().unwrap().ptz());
        let off_deg = (found.pan - exact.pan).degrees().abs();
        assert!(off_deg < 0.1, "frame {number}: {off_deg}°");
        assert_eq!(frame.status == FrameStatus::Reference, number % 5 == 0);
    }

    let mut video = File::options()
        .append(true)
        .open(path("match.mp4"))
        .unwrap();
    video.write_all(&[0; 8]).unwrap();
    let refused = run(&format!("shard plan.json {} -o new", plan.matches[0].find));
    assert_eq!(refused.code, 2);
    let said = "match.mp4 changed after the plan was made";
    refused.assert_says(said);

    // Planned again, it is another video than the one that was labelled.
    let before = fs::read(path("out/match/project.json")).unwrap();
    run("plan season.toml -o plan.json --force").done();
    let plan = Plan::read(&path("plan.json")).unwrap();
    for id in plan.shard_ids() {
        assert_eq!(run(&format!("shard plan.json {id} -o parts")).code, 0);
    }
    let collected = run("collect plan.json parts -o out");
    let said = "match: its project was left as it is: match.mp4 is another video";
    assert!(
        collected.code == 1 && collected.stderr.contains(said),
        "{}",
        collected.stderr
    );
    assert!(fs::read(path("out/match/project.json")).unwrap() == before);
    let checked = run("check out/match");
    let said = format!("{}{}", checked.stdout, checked.stderr);
    let times = said.matches("is another video than the one that was labelled");
    assert!(checked.code == 1 && times.count() == 1, "{said}");
    let exported = run("export out/match --dataset set --status suggested --outside-pictures");
    assert_ne!(exported.code, 0);
    let said = "its video is not the one that was labelled";
    exported.assert_says(said);
}
