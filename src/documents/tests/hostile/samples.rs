//! Something valid in every format that is imported: exported here where that is possible.

use crate::mat_writer::{CAMERA, frame, sequence};
use std::path::Path;
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::{SIZE, TestBase, base_at};
use touchline_documents::document::{Click, Document, FieldSpec, FrameStatus, VideoFrame};
use touchline_documents::exchange::{
    ExchangeError, ExportOptions, Format, GroundPlan, HomographyOptions, ImportOptions, Imported,
    MatrixDirection, Zoom, export, import,
};
use touchline_documents::testing::{match_from, new_frame, ptz_at};

/// Files by name.
pub type NamedFiles = Vec<(String, Vec<u8>)>;

/// What is imported and how.
#[derive(Clone)]
pub struct Sample {
    pub format: Format,
    pub files: NamedFiles,
    pub options: ImportOptions,
}

/// Every format that can be imported.
pub fn formats() -> impl Iterator<Item = Format> {
    Format::all().filter(|format| format.imports())
}

/// A sample of every format, and of every other file that one of them has.
pub fn samples() -> impl Iterator<Item = Sample> {
    let formats = formats().map(Sample::of);
    formats.chain([Sample::game_state(), Sample::labels_v3()])
}

impl Sample {
    /// A picture of the game state challenge with a line and the box of one person.
    pub fn game_state() -> Self {
        Self::with_masks(one("Labels-GameState.json", GAME_STATE))
    }

    /// A match of SoccerNet-v3: an action and its replay.
    pub fn labels_v3() -> Self {
        Self::with_masks(one("Labels-v3.json", LABELS_V3))
    }

    /// Files of lines and boxes.
    fn with_masks(files: NamedFiles) -> Self {
        let mut sample = Self {
            files,
            ..Self::of(Format::SoccerNetLines)
        };
        sample.options.masks = true;
        sample
    }

    pub fn of(format: Format) -> Self {
        let mut options = ImportOptions {
            size: Some(SIZE),
            zoom: Some(Zoom::FocalPx),
            homographies: HomographyOptions {
                plan: Some(GroundPlan::CentreMetres),
                direction: Some(MatrixDirection::PitchFromImage),
                ..HomographyOptions::default()
            },
            ..ImportOptions::default()
        };
        if format == Format::Lens {
            options.sensor_width_mm = Some(24.0);
        }
        if format == Format::DeepSport {
            options.field = FieldSpec::new("basketball_fiba");
        }
        Self {
            format,
            files: files(format),
            options,
        }
    }

    /// Its only file, or the one that most is said of.
    pub fn main(&self) -> &str {
        let wanted = match self.format {
            Format::YoloPose => "labels/train/0001.txt",
            Format::Colmap => "images.txt",
            _ => return &self.files[0].0,
        };
        assert!(self.files.iter().any(|(name, _)| name == wanted));
        wanted
    }

    pub fn bytes(&self, name: &str) -> &[u8] {
        &self
            .files
            .iter()
            .find(|(known, _)| known == name)
            .unwrap()
            .1
    }

    pub fn text(&self) -> String {
        String::from_utf8(self.bytes(self.main()).to_vec()).unwrap()
    }

    /// The main file's text; nothing for formats that are none.
    pub fn text_or_empty(&self) -> String {
        String::from_utf8(self.bytes(self.main()).to_vec()).unwrap_or_default()
    }

    /// Imports files in the place of its own, written into a folder that is empty before and after.
    pub fn import(
        &self,
        files: &[(String, Vec<u8>)],
        folder: &Path,
    ) -> Result<Imported, ExchangeError> {
        let within = folder.join("in");
        std::fs::create_dir_all(&within).unwrap();
        for (name, bytes) in files {
            let path = within.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        let imported = import(&self.path(files, &within), self.format, &self.options);
        std::fs::remove_dir_all(&within).unwrap();
        imported
    }

    fn path(&self, files: &[(String, Vec<u8>)], within: &Path) -> std::path::PathBuf {
        match files {
            [(name, _)] if !self.format.is_folder() => within.join(name),
            _ => within.to_path_buf(),
        }
    }
}

/// Two solved frames with clicks.
pub fn document() -> Document {
    let mut document = match_from(&base_at([0.0, -60.0, 18.0], SIZE).bent(0.0661), SIZE);
    for index in 0..2_u64 {
        let mut frame = new_frame(&format!("images/{:04}.jpg", index + 1), SIZE);
        frame.video = Some(VideoFrame::new(
            "match.mp4",
            412 + index,
            Some((412 + index) as f64 / 25.0),
        ));
        frame.status = FrameStatus::Reference;
        frame.ptz = ptz_at(12.5, -11.2, 2410.0);
        frame.clicks = vec![
            Click::landmark("centre_mark".into(), ImagePoint::new(444.5, 789.25)),
            Click::landmark(
                "penalty_area_far_right_front".into(),
                ImagePoint::new(1449.22, 565.92),
            ),
            Click::line("halfway_line".into(), ImagePoint::new(440.63, 690.25)),
        ];
        document.frames.push(frame.into());
    }
    document
}

fn files(format: Format) -> NamedFiles {
    match format {
        Format::Cvat => one("annotations.xml", CVAT),
        Format::Points => one("points.csv", POINTS),
        Format::Homographies => one("homographies.csv", HOMOGRAPHIES),
        Format::Lens => one("lens.csv", LENS),
        Format::DeepSport => one("camcourt1_7.json", DEEPSPORT),
        Format::PnlCalib => one("0001.json", PNLCALIB),
        Format::AuthorsMat => vec![(
            "seq1_anno.mat".to_owned(),
            sequence(vec![frame("1.jpg", CAMERA)], false),
        )],
        _ => {
            let document = document();
            let exported = export(
                document.at(Path::new("/")),
                format,
                &ExportOptions::default(),
            )
            .unwrap();
            exported
                .files
                .sorted_entries()
                .into_iter()
                .map(|(name, bytes)| (name.to_owned(), bytes.to_vec()))
                .collect()
        }
    }
}

fn one(name: &str, text: &str) -> NamedFiles {
    vec![(name.to_owned(), text.as_bytes().to_vec())]
}

const CVAT: &str = r#"<annotations><version>1.1</version><meta><task><original_size><width>1920</width><height>1080</height></original_size></task></meta>
<image id="0" name="clip/0001.jpg" width="1920" height="1080">
 <points label="centre_mark" occluded="0" points="444.68,789.18" z_order="0"></points>
 <polyline label="halfway_line" occluded="0" points="434.1,535.7;440.6,690.3" z_order="0"></polyline>
 <skeleton label="pitch" z_order="0"><points label="corner_far_left" outside="1" points="0.00,0.00"></points></skeleton>
</image>
<track id="0" label="penalty_mark_left"><points frame="3" keyframe="1" outside="0" points="10,20"/></track></annotations>
"#;

const DEEPSPORT: &str = r#"{"calibration":{"img_width":1920,"img_height":1080,"KK":[2410,0,959.5,0,2410,539.5,0,0,1],"kc":[0.0661,0,0,0,0],
 "R":[0.97629600712,0.216439613938,0.0,-0.042040007992,0.189630221542,0.980955155349,0.212317555114,-0.957702601331,0.19423435122],
 "T":[-2827.781804,544.571295,6516.869814]}}
"#;

const PNLCALIB: &str = r#"{"cam_params":{"pan_degrees":12.5,"tilt_degrees":78.8,"roll_degrees":0.0,"position_meters":[0.0,60.0,-18.0],
 "x_focal_length":2410.0,"y_focal_length":2410.0,"principal_point":[960.0,540.0],"radial_distortion":[0,0,0,0,0,0],
 "tangential_distortion":[0,0],"thin_prism_distortion":[0,0,0,0],"rotation_matrix":[[1,0,0],[0,1,0],[0,0,1]]}}
"#;

const GAME_STATE: &str = r#"{"info":{"im_dir":"img1"},
 "images":[{"image_id":"1","file_name":"1.jpg","width":1920,"height":1080}],
 "annotations":[{"image_id":"1","bbox_image":{"x":9,"y":9,"w":9,"h":9}},
  {"image_id":"1","lines":{"Middle line":[{"x":0.5,"y":0.25}]}}]}
"#;

const LABELS_V3: &str = r#"{"GameMetadata":{"UrlLocal":"league/match","list_actions":["0.png"]},
 "actions":{"0.png":{"imageMetadata":{"width":1920,"height":1080,"gameTime":"1 - 02:00"},
  "bboxes":[{"class":"Ball","ID":"7","points":{"x1":100.5,"y1":200,"x2":140,"y2":290}},
   {"class":null,"ID":null,"points":{"x1":1,"y1":2,"x2":3,"y2":4}}],
  "lines":[{"class":"Middle line","points":[960.25,270,970,800]},{"class":null,"points":[]}],
  "linked_replays":["0_1.png"]}},
 "replays":{"0_1.png":{"imageMetadata":{"width":1920,"height":1080},"bboxes":[],
  "lines":[{"class":"Circle central","points":[700,500,720,520,760,530]}],
  "linked_action":"0.png"}}}
"#;

const HOMOGRAPHIES: &str = "image,homography
0001.jpg,\"[[-0.2852303786, 0.01228222517, 117.69701651986],
 [0.06323405255, 1.01070678755, -824.93520766999], [0, -0.01592175417, 1]]\"
0002.jpg,\"[[-0.2852303786, 0.01228222517, 117.69701651986],
 [0.06323405255, 1.01070678755, -824.93520766999], [0, -0.01592175417, 1]]\"
";

const LENS: &str = "Timecode,Clip Name,Focal Length (mm)
16:47:04:19,A001,32
16:47:04:20,A001,32.5
";

const POINTS: &str = "frame,label,x,y
0001.jpg,centre_mark,444.68,789.18
0001.jpg,halfway_line,440.6,690.3
0002.jpg,centre_mark,444.68,789.18
";
