//! What is done to valid files of a format.

use crate::samples::{NamedFiles, Sample};
use crate::{damage_cameras, damage_clicks};
use touchline_documents::exchange::{Format, ImportOptions, Zoom};

/// Damaged files with a name, and how they are imported.
pub struct Damaged {
    pub name: String,
    pub files: NamedFiles,
    pub options: ImportOptions,
}

/// A sample and what was made of it.
pub struct Damage {
    pub sample: Sample,
    pub cases: Vec<Damaged>,
}

/// Formats whose files are JSON, or a JSON value a line.
fn is_json(format: Format) -> bool {
    matches!(
        format,
        Format::Json
            | Format::SoccerNet
            | Format::SoccerNetLines
            | Format::PnlCalib
            | Format::Coco
            | Format::LabelStudio
            | Format::Labelme
            | Format::Homography
            | Format::BroadTrack
            | Format::OpenTrackIo
            | Format::DeepSport
    )
}

impl Damage {
    /// Everything that is done to a format.
    pub fn to(format: Format) -> Self {
        let mut damage = Self {
            sample: Sample::of(format),
            cases: Vec::new(),
        };
        damage.damage_any_file();
        if is_json(format) {
            damage.damage_json();
        }
        damage_cameras::add(&mut damage);
        damage_clicks::add(&mut damage);
        damage
    }

    /// Other files.
    pub fn files(&mut self, name: &str, files: NamedFiles) {
        let options = self.sample.options.clone();
        self.cases.push(Damaged {
            name: name.to_owned(),
            files,
            options,
        });
    }

    /// Other bytes in one file.
    pub fn bytes_of(&mut self, name: &str, file: &str, bytes: impl Into<Vec<u8>>) {
        let mut files = self.sample.files.clone();
        files.iter_mut().find(|(known, _)| known == file).unwrap().1 = bytes.into();
        self.files(name, files);
    }

    /// Other bytes in the main file.
    pub fn bytes(&mut self, name: &str, bytes: impl Into<Vec<u8>>) {
        let file = self.sample.main().to_owned();
        self.bytes_of(name, &file, bytes);
    }

    /// A text in the place of another, in one file.
    pub fn swap_in(&mut self, file: &str, name: &str, from: &str, to: &str) {
        let text = String::from_utf8(self.sample.bytes(file).to_vec()).unwrap();
        assert!(
            text.contains(from),
            "{}: {from:?} is not in {text}",
            self.sample.format
        );
        self.bytes_of(name, file, text.replacen(from, to, 1));
    }

    /// A text in the place of another, in the main file.
    pub fn swap(&mut self, name: &str, from: &str, to: &str) {
        let file = self.sample.main().to_owned();
        self.swap_in(&file, name, from, to);
    }

    /// A file beside the others.
    pub fn beside(&mut self, name: &str, file: &str, bytes: impl Into<Vec<u8>>) {
        let mut files = self.sample.files.clone();
        files.push((file.to_owned(), bytes.into()));
        self.files(name, files);
    }

    /// A file missing.
    pub fn without(&mut self, name: &str, file: &str) {
        let mut files = self.sample.files.clone();
        files.retain(|(known, _)| known != file);
        self.files(name, files);
    }

    /// The valid files with other options.
    pub fn options(&mut self, name: &str, change: impl FnOnce(&mut ImportOptions)) {
        self.files(name, self.sample.files.clone());
        change(&mut self.cases.last_mut().unwrap().options);
    }

    fn damage_any_file(&mut self) {
        let good = self.sample.bytes(self.sample.main()).to_vec();
        // A picture without labels has an empty file.
        if self.sample.format != Format::YoloPose {
            self.bytes("empty", "");
            self.bytes("blank", " \n\t\n");
        }
        self.bytes("zip", b"PK\x03\x04\x14\x00\x00\x00".to_vec());
        self.bytes("gzip", b"\x1f\x8b\x08\x00".to_vec());
        self.bytes(
            "html",
            "<!DOCTYPE html><html><body>404 Not Found</body></html>\n",
        );
        self.bytes("not-utf8", b"\xff\xfe{\x00".to_vec());
        self.bytes("zeros", vec![0; 64]);
        self.bytes("cut-short", &good[..good.len() / 3]);
    }

    fn damage_json(&mut self) {
        self.bytes("deep-lists", "[".repeat(100_000));
        self.bytes("deep-objects", "{\"a\":".repeat(100_000));
        self.bytes("a-number", "7");
        self.bytes("null", "null");
        self.bytes("a-text", "\"hello\"");
        self.bytes("not-a-number", "{\"a\": NaN}");
        self.bytes("beyond-all-numbers", "{\"a\": 1e999}");
        self.bytes("half-a-letter", "{\"a\": \"\\ud800\"}");
        if self.sample.format != Format::Json {
            self.bytes("a-key-twice", "{\"a\": 1, \"a\": 2}");
        }
    }
}

/// Options without what some formats need.
pub fn add_missing_options(damage: &mut Damage) {
    damage.options("no-size", |options| options.size = None);
    damage.options("no-zoom", |options| options.zoom = None);
    damage.options("no-sensor", |options| {
        options.zoom = Some(Zoom::FocalMmX100);
    });
    damage.options("outside-the-zoom-table", |options| {
        options.zoom = Some(Zoom::Table(vec![(0.0, 1.0), (9.0, 2.0)]));
    });
}
