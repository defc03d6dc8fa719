//! The options of formats. Only those that a format understands are shown.

use super::typed::Typed;
use egui::{ComboBox, DragValue, Ui};
use touchline_core::geometry::ImageSize;
use touchline_documents::exchange::{
    Direction, ExportOptions, Format, FormatOption, Gaps, ImportOptions, KeypointNames, LabelMap,
    PointSource, Rate, Recording, Timecode, Zoom,
};

/// The pages, for the texts that are typed on them.
const EXPORT: &str = "export";
const IMPORT: &str = "import";

/// The options of an export in this format.
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

/// The options of an import of this format.
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
    });
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

/// The width of the sensor, mm.
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
        ui.label("Perspective");
        let shown = recording.perspective.as_deref().unwrap_or("not chosen");
        let combo = ComboBox::from_id_salt("perspective")
            .width(160.0)
            .selected_text(shown)
            .show_ui(ui, |ui| {
                for name in Recording::PERSPECTIVES {
                    if ui
                        .selectable_label(recording.perspective.as_deref() == Some(name), name)
                        .clicked()
                    {
                        recording.perspective = Some(name.to_owned());
                    }
                }
            });
        combo
            .response
            .on_hover_text("Which of the stadium's cameras it is.");
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
