//! The options of formats. Only those that a format understands are shown.

use super::typed::Typed;
use egui::{ComboBox, DragValue, Ui};
use touchline_core::geometry::ImageSize;
use touchline_documents::exchange::{
    Direction, ExportOptions, Format, FormatOption, Gaps, GroundPlan, HomographyOptions,
    ImportOptions, KeypointNames, LabelMap, MatrixDirection, PointSource, Rate, Recording,
    Timecode, Zoom,
};

/// The pages, for the texts that are typed on them.
const EXPORT: &str = "export";
const IMPORT: &str = "import";

pub fn export_options(ui: &mut Ui, format: Format, options: &mut ExportOptions) {
    let takes = |option| format.takes(option, Direction::Export);
    if takes(FormatOption::Size) {
        size(
            ui,
            EXPORT,
            &mut options.size,
            "Cameras and points are rescaled to pictures of this size; SoccerNet's submissions \
             want 960 × 540.",
        );
    }
    // Points: which, and under which names.
    if format.is_of_points() {
        ui.horizontal(|ui| {
            let mut projected = options.points == PointSource::Projected;
            let tip = "Points where the camera shows the landmarks, not where people clicked.";
            ui.checkbox(&mut projected, "where the camera shows them")
                .on_hover_text(tip);
            options.points = if projected {
                PointSource::Projected
            } else {
                PointSource::Clicked
            };
            if takes(FormatOption::Names) {
                let mut roboflow = options.names == KeypointNames::Roboflow32;
                ui.checkbox(&mut roboflow, "names of Roboflow's 32 points")
                    .on_hover_text("Other landmarks are left out.");
                options.names = if roboflow {
                    KeypointNames::Roboflow32
                } else {
                    KeypointNames::Touchline
                };
            }
            if takes(FormatOption::Outside) {
                let tip = "Points outside their picture are written too.";
                ui.checkbox(&mut options.keep_outside, "those outside as well")
                    .on_hover_text(tip);
            }
            if takes(FormatOption::Variant) {
                ui.checkbox(&mut options.game_state, "game state")
                    .on_hover_text("Class names without the trailing space.");
            }
        });
    }
    // A homography has no lens, so it fits the picture as it is only roughly.
    if takes(FormatOption::Undistorted) {
        let tip = "Homographies of pictures whose lens distortion has been taken out.";
        ui.checkbox(&mut options.undistorted, "of undistorted pictures")
            .on_hover_text(tip);
    }
    if takes(FormatOption::MatchId) {
        recording(ui, &mut options.recording);
    }
    if takes(FormatOption::Interpolate) {
        ui.horizontal(|ui| gaps(ui, &mut options.gaps));
    }
    if takes(FormatOption::Fps) || takes(FormatOption::SensorMm) {
        ui.horizontal(|ui| {
            if takes(FormatOption::Fps) {
                rate(ui, &mut options.rate);
            }
            if takes(FormatOption::SensorMm) {
                sensor(ui, EXPORT, &mut options.sensor_width_mm);
            }
        });
    }
    if takes(FormatOption::Start) {
        ui.horizontal(|ui| start(ui, &mut options.start));
    }
    if takes(FormatOption::Zoom) {
        ui.horizontal(|ui| zoom(ui, &mut options.zoom));
    }
}

/// What an export does with missing frames of a video.
fn gaps(ui: &mut Ui, gaps: &mut Gaps) {
    ui.label("Missing frames");
    // The number of frames when interpolation is chosen: the present one, else a default.
    let mut most = if let Gaps::Interpolate(most) = *gaps {
        most
    } else {
        12
    };
    let tip = "Frames without a camera get no row.";
    if ui
        .radio(*gaps == Gaps::Keep, "stay missing")
        .on_hover_text(tip)
        .clicked()
    {
        *gaps = Gaps::Keep;
    }
    let tip = "Short gaps get cameras between those of their neighbours, marked as interpolated.";
    if ui
        .radio(matches!(gaps, Gaps::Interpolate(_)), "are interpolated")
        .on_hover_text(tip)
        .clicked()
    {
        *gaps = Gaps::Interpolate(most);
    }
    if matches!(gaps, Gaps::Interpolate(_)) {
        let field = DragValue::new(&mut most)
            .range(1..=500)
            .prefix("up to ")
            .update_while_editing(false);
        ui.add(field)
            .accessible_name("Longest gap")
            .on_hover_text("Longer gaps stay, frames.");
        *gaps = Gaps::Interpolate(most);
    }
    if ui
        .radio(*gaps == Gaps::Takes, "begin a new take")
        .on_hover_text("A file for each run of frames.")
        .clicked()
    {
        *gaps = Gaps::Takes;
    }
}

pub fn import_options(ui: &mut Ui, format: Format, options: &mut ImportOptions) {
    let takes = |option| format.takes(option, Direction::Import);
    if takes(FormatOption::Map) {
        labels(ui, options);
    }
    if takes(FormatOption::Size) {
        let tip = "Of pictures that are not here; what is for another size is rescaled.";
        size(ui, IMPORT, &mut options.size, tip);
    }
    ui.horizontal(|ui| {
        // FreeD states zoom as a raw number, so its meaning and the sensor are needed.
        if takes(FormatOption::Zoom) {
            let mut chosen = options.zoom.clone().unwrap_or_default();
            zoom(ui, &mut chosen);
            options.zoom = Some(chosen);
        }
        if takes(FormatOption::SensorMm) {
            sensor(ui, IMPORT, &mut options.sensor_width_mm);
        }
        if takes(FormatOption::Undistorted) {
            ui.checkbox(&mut options.undistorted, "pictures without distortion")
                .on_hover_text("What the file states of distortion was taken out of them.");
        }
    });
    if takes(FormatOption::Template) {
        homographies(ui, &mut options.homographies);
    }
}

/// What a table of homographies leaves open.
fn homographies(ui: &mut Ui, options: &mut HomographyOptions) {
    const PLANS: [(GroundPlan, &str); 4] = [
        (GroundPlan::CentreMetres, "metres from the middle"),
        (GroundPlan::CornerMetres, "metres from the far left corner"),
        (GroundPlan::WorldCup2014, "template of World Cup 2014"),
        (GroundPlan::ShuttleSet, "ShuttleSet's court"),
    ];
    const DIRECTIONS: [(MatrixDirection, &str); 2] = [
        (MatrixDirection::PitchFromImage, "picture to field"),
        (MatrixDirection::ImageFromPitch, "field to picture"),
    ];
    ui.horizontal(|ui| {
        choice(
            ui,
            "Plane",
            "The plane that the matrices map to or from.",
            &PLANS,
            &mut options.plan,
        );
        let tip = "Where a matrix leads; ShuttleSet's lead to the field.";
        choice(ui, "Direction", tip, &DIRECTIONS, &mut options.direction);
    });
    ui.horizontal(|ui| {
        let tip = "The column of the matrix; open: found by its name.";
        column(
            ui,
            "Matrix column",
            tip,
            "homography",
            &mut options.matrix_column,
        );
        let tip = "The column of the picture's name; open: found by its name.";
        column(ui, "Name column", tip, "image", &mut options.name_column);
    });
}

fn column(ui: &mut Ui, name: &str, tip: &str, example: &str, column: &mut Option<String>) {
    let typed = Typed {
        page: IMPORT,
        name,
        tip,
        example,
        width: 120.0,
        text: String::clone,
        read: |text: &str| Some(text.to_owned()),
    };
    typed.show(ui, column);
}

/// A choice of one of a few values, or of none.
fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    values: &[(T, &str)],
    chosen: &mut Option<T>,
) {
    ui.label(name);
    let mut known = values.iter();
    let shown = known.find(|(value, _)| Some(*value) == *chosen);
    let combo = ComboBox::from_id_salt(name)
        .width(180.0)
        .selected_text(shown.map_or("not stated", |(_, name)| name))
        .show_ui(ui, |ui| {
            for (value, name) in values {
                if ui
                    .selectable_label(*chosen == Some(*value), *name)
                    .clicked()
                {
                    *chosen = Some(*value);
                }
            }
        });
    combo.response.on_hover_text(tip);
}

/// The size of pictures, px.
fn size(ui: &mut Ui, page: &str, size: &mut Option<ImageSize>, tip: &str) {
    let typed = Typed {
        page,
        name: "Picture size",
        tip,
        example: "1920 × 1080",
        width: 120.0,
        text: |size: &ImageSize| format!("{} × {}", size.width, size.height),
        read: ImageSize::parse,
    };
    ui.horizontal(|ui| typed.show(ui, size));
}

/// The frame rate, frames per second.
fn rate(ui: &mut Ui, rate: &mut Option<Rate>) {
    let tip = "25, 29.97 or 30000/1001; open: from the frames' times.";
    let typed = Typed {
        page: EXPORT,
        name: "Frames a second",
        tip,
        example: "29.97",
        width: 100.0,
        text: Rate::to_string,
        read: Rate::parse,
    };
    typed.show(ui, rate);
}

fn sensor(ui: &mut Ui, page: &str, width_mm: &mut Option<f64>) {
    let tip = "Of the camera, mm, where its panel does not know it: lengths in mm follow from it.";
    let typed = Typed {
        page,
        name: "Sensor width",
        tip,
        example: "9.59",
        width: 80.0,
        text: f64::to_string,
        read: |text: &str| {
            let mm: Option<f64> = text.parse().ok();
            mm.filter(|mm| (1.0..=100.0).contains(mm))
        },
    };
    typed.show(ui, width_mm);
    ui.label("mm");
}

/// The timecode of the first frame.
fn start(ui: &mut Ui, start: &mut Option<Timecode>) {
    let tip = "Of the video's first frame; 10:00:00;00 where numbers are dropped (29.97).";
    let (text, read) = (Timecode::to_string, Timecode::parse);
    let typed = Typed {
        page: EXPORT,
        name: "First timecode",
        tip,
        example: "10:00:00:00",
        width: 120.0,
        text,
        read,
    };
    typed.show(ui, start);
}

/// The meaning of zoom values.
fn zoom(ui: &mut Ui, zoom: &mut Zoom) {
    ui.label("Zoom values are");
    for (meaning, name, tip) in [
        (
            Zoom::FocalPx,
            "focal length, px",
            "The focal length in px itself.",
        ),
        (
            Zoom::FocalMmX100,
            "focal length, mm × 100",
            "The focal length in mm × 100, by the width of the sensor.",
        ),
    ] {
        if ui
            .radio(*zoom == meaning, name)
            .on_hover_text(tip)
            .clicked()
        {
            *zoom = meaning;
        }
    }
}

/// The properties of a recording that the Common Data Format requires.
fn recording(ui: &mut Ui, recording: &mut Recording) {
    ui.horizontal(|ui| {
        let tip = "The id that the other files about the match use.";
        Typed {
            page: EXPORT,
            name: "The match's id",
            tip,
            example: "2026-118",
            width: 150.0,
            text: String::clone,
            read: |text: &str| Some(text.to_owned()),
        }
        .show(ui, &mut recording.match_id);
        let tip = "When the video begins, in UTC.";
        Typed {
            page: EXPORT,
            name: "Begins",
            tip,
            example: "2026-03-01T18:59:30Z",
            width: 190.0,
            text: String::clone,
            read: |text: &str| Recording::is_start(text).then(|| text.to_owned()),
        }
        .show(ui, &mut recording.start);
    });
    ui.horizontal(|ui| {
        let names = Recording::PERSPECTIVES.map(|name| (name, name));
        let mut chosen = names
            .into_iter()
            .map(|(name, _)| name)
            .find(|name| recording.perspective.as_deref() == Some(name));
        let tip = "Which of the stadium's cameras it is.";
        choice(ui, "Perspective", tip, &names, &mut chosen);
        recording.perspective = chosen.map(ToOwned::to_owned);
        ui.checkbox(&mut recording.is_automated, "no operator")
            .on_hover_text("The camera is not operated by a person.");
    });
}

/// The meaning of labels, for formats of points.
fn labels(ui: &mut Ui, options: &mut ImportOptions) {
    const MAPS: [(LabelMap, &str); 4] = [
        (LabelMap::Touchline, "names of touchline"),
        (LabelMap::Roboflow32, "Roboflow's 32 points by index"),
        (
            LabelMap::Roboflow32Captions,
            "Roboflow's 32 points, 01 to 32",
        ),
        (LabelMap::SoccerNet, "SoccerNet's classes"),
    ];
    ui.horizontal(|ui| {
        ui.label("Labels are");
        let shown = MAPS
            .iter()
            .find(|(map, _)| *map == options.map)
            .map_or("your own", |(_, name)| *name);
        let combo = ComboBox::from_id_salt("labels")
            .width(220.0)
            .selected_text(shown)
            .show_ui(ui, |ui| {
                for (map, name) in MAPS {
                    let is_chosen = options.map == map;
                    if ui.selectable_label(is_chosen, name).clicked() {
                        options.map = map;
                    }
                }
            });
        combo.response.on_hover_text(
            "What the labels of other tools mean; formats with classes of their own ignore it.",
        );
        ui.checkbox(&mut options.skip_unmapped, "leave out others")
            .on_hover_text("Labels without a meaning are left out, and counted.");
    });
}
