//! `touchline plan`, `shard` and `collect`: a season in parts, on a drawn clip.
#![cfg(all(feature = "opencv", target_os = "linux"))]

use crate::drawn::draw;
use crate::headless::Headless;
use crate::program::{Ran, touchline};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{self, Child, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use touchline::app::{Action, App, Command, OpenProject, Question};
use touchline::document::{Camera, Document, Frame, FrameId, FrameStatus};
use touchline::season::part::part_path;
use touchline::season::plan::Plan;
use touchline::season::queue::Queue;
use touchline_documents::testing::{load, save};

const SEASON: &str = "
    [options]
    images = 4
    [[match]]
    name = 'north'
    frames = 'match/images'
    project = 'match/known.json'
    [[match]]
    frames = 'grey'
";

/// A folder with a season of two matches: the drawn clip, in which every third frame is known, and
/// four grey pictures in which no camera is found.
struct Season {
    folder: TempDir,
    truth: Document,
}

impl Season {
    fn draw() -> Self {
        let folder = tempfile::tempdir().unwrap();
        draw(
            folder.path(),
            "--frames 12 --step 0.04 --seed 4 --size 640x360 --preset easy",
        );
        let truth = load(folder.path().join("match/truth.json"));
        let mut known = truth.clone();
        for (index, frame) in known.frames.iter_mut().enumerate() {
            let frame: &mut Frame = frame;
            frame.clicks.clear();
            frame.solution = None;
            if index % 3 == 0 {
                frame.status = FrameStatus::Reference;
            } else {
                (frame.status, frame.ptz) = (FrameStatus::New, None);
            }
        }
        save(folder.path().join("match/known.json"), &known);
        fs::create_dir(folder.path().join("grey")).unwrap();
        for index in 0..4_u8 {
            image::RgbImage::from_pixel(64, 36, image::Rgb([50 * index; 3]))
                .save(folder.path().join(format!("grey/{index}.png")))
                .unwrap();
        }
        fs::write(folder.path().join("season.toml"), SEASON).unwrap();
        Self { folder, truth }
    }

    /// The season with its plan.
    fn with_plan() -> (Self, Plan) {
        let season = Self::draw();
        season
            .run("plan season.toml -o plan.json --commands commands")
            .done();
        let plan = Plan::read(&season.path("plan.json")).unwrap();
        (season, plan)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, arguments: &str) -> Ran {
        touchline(self.folder.path(), arguments)
    }

    /// Does a shard; it must be done.
    fn shard(&self, id: &str, parts: &str) -> String {
        let ran = self.run(&format!("shard plan.json {id} -o {parts}")).done();
        ran.stderr
    }

    /// Does all shards.
    fn all_shards(&self, plan: &Plan, parts: &str) {
        for id in plan.shard_ids() {
            self.shard(id, parts);
        }
    }

    /// Does the shards of the match without a camera, which take no time.
    fn shards_of_grey(&self, plan: &Plan) {
        let grey = &plan.matches[1];
        self.shard(&grey.find, "parts");
        for label in &grey.labels {
            self.shard(&label.shard, "parts");
        }
    }

    /// What a command that must fail says in its one line.
    fn refusal(&self, arguments: &str) -> String {
        let ran = self.run(arguments);
        let lines = ran.stderr.trim_end().lines().count();
        assert_eq!((ran.code, lines), (2, 1), "{arguments}: {}", ran.stderr);
        ran.stderr
    }

    fn start_shard(&self, id: &str, parts: &str) -> Child {
        process::Command::new(env!("CARGO_BIN_EXE_touchline"))
            .args(["shard", "plan.json", id, "-o", parts])
            .current_dir(self.folder.path())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }
}

/// The files below a folder whose names end so, by name, with their bytes.
fn bytes_of(folder: &Path, endings: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().display().to_string();
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.insert(name, fs::read(path).unwrap());
            }
        }
    }
    found
}

#[test]
fn a_season_in_any_order_gives_the_same_bytes_and_peoples_work_stays() {
    let (season, plan) = Season::with_plan();
    let north = &plan.matches[0];
    assert_eq!((north.num_frames, north.labels.len()), (12, 3));
    let commands = fs::read_to_string(season.path("commands")).unwrap();
    let lines: Vec<String> = plan
        .shard_ids()
        .map(|id| format!("touchline shard plan.json {id} -o parts"))
        .collect();
    assert_eq!(commands.lines().collect::<Vec<_>>(), lines);

    // In the order of the plan, and in the opposite one, in which the first needs what comes last.
    season.all_shards(&plan, "parts");
    let backwards: Vec<&str> = plan.shard_ids().collect();
    for (position, id) in backwards.iter().rev().enumerate() {
        let said = season.shard(id, "backwards");
        assert_eq!(
            said.contains("is done first"),
            position == 0 || position == 1,
            "{said}"
        );
    }
    let parts = bytes_of(&season.path("parts"), &[".part"]);
    assert_eq!(parts.len(), plan.shard_ids().count());
    assert!(parts == bytes_of(&season.path("backwards"), &[".part"]));
    let again = season.shard(&north.labels[1].shard, "parts");
    assert!(
        again.contains("north, frames 4 to 7: done before"),
        "{again}"
    );

    for (parts, output) in [("parts", "out"), ("backwards", "out2")] {
        season
            .run(&format!("collect plan.json {parts} -o {output}"))
            .done();
    }
    let results = ["project.json", "queue.json"];
    let collected = bytes_of(&season.path("out"), &results);
    assert_eq!(collected.len(), 3, "two projects and a queue");
    assert!(collected == bytes_of(&season.path("out2"), &results));
    let table = fs::read_to_string(season.path("out/season.csv")).unwrap();
    let grey = table.lines().nth(2).unwrap();
    assert!(grey.starts_with("grey,0,4,0,0,4,0,"), "{table}");
    assert!(grey.contains("match each other"), "{table}");

    // Every frame of the drawn match lies where it was drawn.
    let project = season.path("out/north/project.json");
    let mut found = load(&project);
    assert_eq!(found.frames.len(), 12);
    for (frame, exact) in found.frames.iter().zip(&season.truth.frames) {
        let [found, exact] = [frame, exact].map(|frame| frame.ptz.as_ref().unwrap().ptz());
        let off_deg = (found.pan - exact.pan).degrees().abs();
        assert!(off_deg < 0.1, "{}: {off_deg}°", frame.name());
    }

    // A person corrects a frame; it stays, and so does everything else.
    let frame: &mut Frame = &mut found.frames[5];
    frame.status = FrameStatus::Rejected;
    save(&project, &found);
    let edited = fs::read(&project).unwrap();
    season
        .run("collect plan.json parts -o out --below 1")
        .done();
    assert!(fs::read(&project).unwrap() == edited);
    let queue = Queue::read(&season.path("out/queue.json")).unwrap();
    assert!(!queue.entries().is_empty());
    for entry in queue.entries() {
        let of = load(season.path("out").join(&entry.project));
        let frame = of
            .frames
            .iter()
            .find(|frame| frame.id.as_str() == entry.frame);
        let frame = frame.unwrap();
        assert!(frame.status == FrameStatus::Suggested && frame.ptz.is_some());
    }

    // What people did in the project changed it for the plan.
    fs::write(season.path("match/known.json"), &edited).unwrap();
    let refusal = season.refusal(&format!("shard plan.json {} -o new", north.find));
    assert!(
        refusal.contains("known.json changed after the plan was made"),
        "{refusal}"
    );
}

#[test]
fn collecting_replaces_only_what_it_wrote() {
    let (season, plan) = Season::with_plan();
    season.shards_of_grey(&plan);
    fs::create_dir(season.path("own")).unwrap();
    let own = ["season.csv", "season.md", "queue.json", "notes.txt"];
    for name in own {
        fs::write(season.path("own").join(name), "match,my notes\n").unwrap();
    }
    let before = bytes_of(&season.path("own"), &own);
    let refusal = season.refusal("collect plan.json parts -o own");
    assert!(refusal.contains("own holds other things"), "{refusal}");
    assert!(bytes_of(&season.path("own"), &[""]) == before);

    let collect = || season.run("collect plan.json parts -o out");
    assert_eq!(collect().code, 1, "the drawn match is a gap");
    assert_eq!(collect().code, 1, "again");
    let table = season.path("out/season.csv");
    let text = fs::read_to_string(&table).unwrap();
    fs::write(&table, format!("{text}my row\n")).unwrap();
    let refusal = season.refusal("collect plan.json parts -o out");
    assert!(
        refusal.contains("out/season.csv is not as touchline collect wrote it"),
        "{refusal}"
    );
    assert!(fs::read_to_string(&table).unwrap().ends_with("my row\n"));
    fs::write(&table, text).unwrap();
    assert_eq!(collect().code, 1);

    // A project of a person's under the name of a match.
    fs::rename(season.path("out/grey"), season.path("out/north")).unwrap();
    season.shard(&plan.matches[0].find, "parts");
    let project = season.path("out/north/project.json");
    let before = fs::read(&project).unwrap();
    let ran = collect();
    ran.assert_says("north: its project was left as it is: it was not collected here");
    assert!(fs::read(project).unwrap() == before);
}

#[test]
fn a_match_that_is_renamed_or_gets_a_camera_keeps_its_project() {
    let (season, plan) = Season::with_plan();
    season.shards_of_grey(&plan);
    let collect = |wanted: &str| {
        let ran = season.run("collect plan.json parts -o out");
        assert!(
            ran.code < 2 && ran.stderr.contains(wanted),
            "{}",
            ran.stderr
        );
    };
    collect("");
    let plan_again = |grey: &str| {
        let text = SEASON.replace("frames = 'grey'", &format!("frames = 'grey'\n{grey}"));
        fs::write(season.path("season.toml"), text).unwrap();
        season.run("plan season.toml -o plan.json --force").done();
        let plan = Plan::read(&season.path("plan.json")).unwrap();
        season.shards_of_grey(&plan);
    };
    plan_again("name = 'cup'");
    collect("cup: its frames were collected as grey; its project stays in that folder");
    assert!(!season.path("out/cup").exists());
    let table = fs::read_to_string(season.path("out/season.csv")).unwrap();
    assert!(table.contains("\ncup,0,4,0,0,4,0,"), "{table}");
    fs::rename(season.path("out/grey"), season.path("out/cup")).unwrap();
    collect("out: 1 project");
    assert!(!season.path("out/grey").exists());

    // The season gets a camera for it: a project without work of a person takes it.
    let project = season.path("out/cup/project.json");
    let mut known = load(&project).relocate(&season.path("out/cup"), season.folder.path());
    let base = season.truth.cameras[0].base().unwrap();
    let camera: &mut Camera = &mut known.cameras[0];
    camera.set_base(&base);
    save(season.path("grey.json"), &known);
    let untouched = fs::read(&project).unwrap();
    let mut edited = load(&project);
    edited.frames[0].comment = Some("too dark".to_owned());
    save(&project, &edited);
    plan_again("name = 'cup'\nproject = 'grey.json'");
    collect("cup: its project was left as it is: camera main has no base, unlike in the parts");
    assert_eq!(load(&project), edited);
    fs::write(&project, untouched).unwrap();
    collect("out: 1 project");
    assert!(load(&project).cameras[0].base().is_some());
}

#[test]
fn gaps_are_named_and_what_is_not_a_whole_part_is_not_taken() {
    let (season, plan) = Season::with_plan();
    let north = &plan.matches[0];
    let ran = season.run("collect plan.json parts -o out");
    assert_eq!(ran.code, 2);
    assert_eq!(
        ran.stderr,
        "touchline: there is no folder parts; do the shards of the plan first, with this folder as \
         their -o\n"
    );
    season.all_shards(&plan, "parts");
    let [first, second, third] = &north.labels[..] else {
        panic!("{:?}", north.labels)
    };
    let part = |shard: &str| part_path(&season.path("parts"), shard);
    let whole = fs::read(part(&first.shard)).unwrap();

    // Half a part, the part of another shard, and a part of no shard of this plan.
    fs::write(part(&first.shard), &whole[..whole.len() / 2]).unwrap();
    fs::remove_file(part(&second.shard)).unwrap();
    fs::write(part(&third.shard), &whole).unwrap();
    fs::write(part("0123"), &whole).unwrap();
    let ran = season.run("collect plan.json parts -o out");
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let said: Vec<&str> = ran.stderr.trim_end().lines().collect();
    let wanted = [
        ("0123.part", "no shard of this plan; it is not used"),
        ("north: frames 0 to 3: ", "is cut off: it has"),
        ("north: frames 4 to 7: ", "there is no"),
        ("north: frames 8 to 11: ", "is the part of another shard"),
        ("out: 2 projects with", "3 shards without a whole part"),
    ];
    assert_eq!(said.len(), wanted.len(), "{}", ran.stderr);
    for (line, (what, why)) in said.iter().zip(wanted) {
        assert!(line.contains(what) && line.contains(why), "{line}");
    }
    let json = season.run("collect plan.json parts -o out --json");
    let lines = json.stderr.lines();
    assert!(lines.clone().count() == 5 && lines.clone().all(|line| line.starts_with("{\"level\"")));

    // The shards refuse to replace what is there, and nothing has changed.
    for (shard, why) in [
        (first, "is cut off"),
        (third, "is the part of another shard"),
    ] {
        let before = fs::read(part(&shard.shard)).unwrap();
        let refusal = season.refusal(&format!("shard plan.json {} -o parts", shard.shard));
        assert!(refusal.contains(why), "{refusal}");
        assert!(fs::read(part(&shard.shard)).unwrap() == before);
        fs::remove_file(part(&shard.shard)).unwrap();
    }
    for shard in [first, second, third] {
        season.shard(&shard.shard, "parts");
    }
    assert!(fs::read(part(&first.shard)).unwrap() == whole);
    assert_eq!(season.run("collect plan.json parts -o out").code, 0);
    let project = load(season.path("out/north/project.json"));
    let names: Vec<String> = project.frames.iter().map(|frame| frame.name()).collect();
    assert!(names.len() == 12 && names.is_sorted(), "{names:?}");

    // Two collectors: the one that came second says so and changes nothing.
    let lock = File::create(season.path("out/collect.lock")).unwrap();
    lock.lock().unwrap();
    let refusal = season.refusal("collect plan.json parts -o out");
    assert!(
        refusal.contains("another touchline collects into out ("),
        "{refusal}"
    );
    drop(lock);
    let refusal = season.refusal("collect plan.json parts -o match");
    assert!(refusal.contains("match holds other things"), "{refusal}");

    // An image that changes after planning, and a plan that was edited.
    image::RgbImage::new(64, 36)
        .save(season.path("grey/2.png"))
        .unwrap();
    let refusal = season.refusal(&format!("shard plan.json {} -o new", plan.matches[1].find));
    assert!(
        refusal.contains("grey changed after the plan was made"),
        "{refusal}"
    );
    let refusal = season.refusal("shard plan.json abc -o new");
    assert!(refusal.contains("plan.json has no shard abc"), "{refusal}");
    let text = fs::read_to_string(season.path("plan.json")).unwrap();
    for (edited, said) in [
        (
            text.replace("\"last\": 7", "\"last\": 6"),
            "plan.json was edited",
        ),
        (
            text.replace("\"look_at\": 40", "\"look_at\": 41"),
            "plan.json was edited",
        ),
        (
            text.replace("\"name\": \"north\"", "\"name\": \"../north\""),
            "\"../north\" cannot be the name of a match",
        ),
        (
            text.replace("\"name\": \"grey\"", "\"name\": \"North\""),
            "\"North\" is the name of two matches",
        ),
        (text.replace("touchline plan", "plan"), "is not a plan"),
        (text[..100].to_owned(), "is not a plan"),
    ] {
        fs::write(season.path("plan.json"), edited).unwrap();
        let refusal = season.refusal(&format!("shard plan.json {} -o new", north.find));
        assert!(refusal.contains(said), "{refusal}");
    }
}

#[test]
fn a_project_without_a_reference_gives_a_part_that_says_why_it_has_no_forest() {
    let season = Season::draw();
    let mut unlabelled = season.truth.clone();
    for frame in &mut unlabelled.frames {
        frame.clicks.clear();
        (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
    }
    save(season.path("match/known.json"), &unlabelled);
    season.run("plan season.toml -o plan.json").done();
    let plan = Plan::read(&season.path("plan.json")).unwrap();
    let said = season.shard(&plan.matches[0].find, "parts");
    assert!(
        said.contains("0 with a camera; no forest could be trained: no features to learn from"),
        "{said}"
    );
}

#[test]
fn a_plan_is_for_one_processor_class_unless_it_says_otherwise() {
    let season = Season::draw();
    let mistaken = SEASON.replace("'grey'", "'gray'");
    fs::write(season.path("wrong.toml"), mistaken).unwrap();
    let refusal = season.refusal("plan wrong.toml -o wrong.json");
    assert!(
        refusal.contains("wrong.toml, line 9: there is no "),
        "{refusal}"
    );
    assert_eq!(
        season
            .run("plan season.toml -o any.json --any-processor")
            .code,
        0
    );
    assert_eq!(season.run("plan season.toml -o plan.json").code, 0);
    let refusal = season.refusal("plan season.toml -o plan.json");
    assert!(refusal.contains("plan.json already exists"), "{refusal}");
    let [any, own] = ["any.json", "plan.json"].map(|file| Plan::read(&season.path(file)).unwrap());
    assert_eq!(any.processor, "any");
    assert!(
        any.matches[1].find != own.matches[1].find,
        "the class is in the name"
    );
    let grey = &any.matches[1].find;
    season
        .run(&format!("shard any.json {grey} -o parts"))
        .done();

    // Another machine's ffmpeg.
    let fake = season.path("bin");
    fs::create_dir(&fake).unwrap();
    let script = "#!/bin/sh\necho ffmpeg version 0.1-other";
    fs::write(fake.join("ffmpeg"), script).unwrap();
    let is_made = process::Command::new("chmod")
        .arg("+x")
        .arg(fake.join("ffmpeg"))
        .status();
    assert!(is_made.unwrap().success());
    let path = format!("{}:{}", fake.display(), std::env::var("PATH").unwrap());
    let ran = process::Command::new(env!("CARGO_BIN_EXE_touchline"))
        .args(["shard", "plan.json", &own.matches[1].find, "-o", "parts"])
        .current_dir(season.folder.path())
        .env("PATH", path)
        .output()
        .unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    assert_eq!(
        (ran.status.code(), said.lines().count()),
        (Some(2), 1),
        "{said}"
    );
    assert!(
        said.contains("ffmpeg-0.1-other") && said.contains("--any-processor"),
        "{said}"
    );
}

#[test]
fn a_shard_that_is_killed_or_has_no_space_leaves_nothing_and_is_done_again() {
    let (season, plan) = Season::with_plan();
    let find = &plan.matches[0].find;
    season.shard(find, "parts");
    let whole = fs::read(part_path(&season.path("parts"), find)).unwrap();
    for after_ms in [0, 20, 60, 150, 400, 900] {
        let mut child = season.start_shard(find, "killed");
        std::thread::sleep(Duration::from_millis(after_ms));
        let _ = child.kill();
        let _ = child.wait();
        let left = fs::read(part_path(&season.path("killed"), find));
        assert!(
            left.is_err() || left.unwrap() == whole,
            "after {after_ms} ms"
        );
    }
    season.shard(find, "killed");
    assert!(fs::read(part_path(&season.path("killed"), find)).unwrap() == whole);

    // No file may be larger than 16 blocks of 512 bytes; the part has more.
    let script = format!(
        "trap '' XFSZ; ulimit -f 16; exec {} shard plan.json {find} -o full",
        env!("CARGO_BIN_EXE_touchline")
    );
    let ran = process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(season.folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    assert_eq!(ran.status.code(), Some(2), "{said}");
    assert!(
        said.lines().last().unwrap().contains("cannot write full/"),
        "{said}"
    );
    assert_eq!(fs::read_dir(season.path("full")).unwrap().count(), 0);
}

#[test]
fn a_shard_ends_with_the_process_that_started_it() {
    let (season, plan) = Season::with_plan();
    // The shell waits for the shard and is killed meanwhile.
    let script = format!(
        "{} shard plan.json {} -o parts & echo $!; wait",
        env!("CARGO_BIN_EXE_touchline"),
        plan.matches[0].find
    );
    let mut shell = process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(season.folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut shard = String::new();
    let output = std::io::BufReader::new(shell.stdout.take().unwrap());
    std::io::BufRead::read_line(&mut { output }, &mut shard).unwrap();
    let running = PathBuf::from(format!("/proc/{}/exe", shard.trim()));
    // It has begun when it has made its folder.
    let begun = Instant::now();
    while !season.path("parts").exists() {
        assert!(begun.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(1));
    }
    shell.kill().unwrap();
    shell.wait().unwrap();
    let killed = Instant::now();
    while running.exists() {
        assert!(
            killed.elapsed() < Duration::from_secs(10),
            "an orphan works on"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(bytes_of(&season.path("parts"), &[".part"]).len(), 0);
}

#[test]
fn in_the_application_the_queue_leads_from_match_to_match() {
    let (season, plan) = Season::with_plan();
    season.all_shards(&plan, "parts");
    season.run("collect plan.json parts -o out").done();
    // A second match with the same frames.
    fs::create_dir(season.path("out/south")).unwrap();
    let [north, south] =
        ["north", "south"].map(|name| season.path(&format!("out/{name}/project.json")));
    fs::copy(&north, &south).unwrap();
    let frames = load(&north).frames;
    let [first, second, third] = [4, 7, 10].map(|index: usize| frames[index].id.clone());
    let entry = |name: &str, frame: &FrameId| {
        let frame = frame.as_str();
        format!(
            "{{\"match\":\"{name}\",\"project\":\"{name}/project.json\",\"frame\":\"{frame}\",\
             \"number\":0,\"confidence\":0.5,\"frames\":1}}"
        )
    };
    let entries = [
        entry("north", &first),
        entry("south", &second),
        entry("north", &third),
    ];
    let text = format!(
        r#"{{"format":"touchline queue","version":1,"below":0.9,"entries":[{}]}}"#,
        entries.join(",")
    );
    let queue = season.path("out/queue.json");
    fs::write(&queue, text).unwrap();

    let shows = |app: &App, project: &Path, frame: &FrameId| {
        let is_of = |open: &OpenProject| open.file == project.canonicalize().unwrap();
        app.open().is_some_and(is_of) && app.frame().is_some_and(|shown| shown.id == *frame)
    };
    let mut headless = Headless::new();
    headless.act(Action::Command(Command::OpenQueue));
    headless.answer(Question::Queue, &queue);
    headless.wait_until("the queue", |app| shows(app, &north, &first));
    headless.act(Action::Command(Command::NextNeedsMe));
    headless.wait_until("the other match", |app| shows(app, &south, &second));
    headless.wait_for_picture();
    // Accepting goes on to the next frame, which is in the first match again.
    headless.act(Action::Command(Command::Accept));
    headless.wait_until("the first match", |app| shows(app, &north, &third));
    let (_, corrected, _) = touchline::store::read(&south).unwrap();
    let accepted = corrected.frames.by_id(&second).unwrap();
    assert_eq!(accepted.status, FrameStatus::Reference);
    headless.act(Action::Command(Command::PreviousNeedsMe));
    headless.wait_until("back", |app| shows(app, &south, &second));
    headless.act(Action::Command(Command::NextNeedsMe));
    headless.wait_until("the last frame", |app| shows(app, &north, &third));
    assert_eq!(headless.app.queue_position(), Some((3, 3)));
    headless.act(Action::Command(Command::NextNeedsMe));
    assert_eq!(headless.app.queue_position(), None);
    let notices = &headless.app.session.messages.notices;
    let is_end = notices
        .iter()
        .any(|notice| notice.text.contains("the last frame of the queue"));
    assert!(
        is_end && shows(&headless.app, &north, &third),
        "{notices:?}"
    );
    // The queue has ended: now the key goes to the next frame to do of this match.
    headless.act(Action::Command(Command::NextNeedsMe));
    assert!(headless.app.frame().unwrap().id != third);
}
