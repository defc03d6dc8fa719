//! Tables of homographies that do not say what they are: CSV with a matrix a row, JSON lines with
//! `h` alone, and arrays of `NumPy`. The user says which plane they map to (`--template`) and,
//! where that does not tell, in which direction. Import only.
//!
//! A matrix of a table is one field with nine numbers in any brackets, or nine columns `h11` to
//! `h33`. The columns are found by their names, or `--columns h=NAME,name=NAME` names them. An
//! array has the shape 3 × 3, or N × 3 × 3 with a frame each.

use super::ground_homography::{corner_from, inverse, matrix};
use super::ground_plan::{SHUTTLE_COURT_PX, shuttle_from_ground};
use crate::exchange::cameras::camera_format::{CameraFormat, has_ending};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, base_name, text, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::{GroundPlan, HomographyOptions, ImportOptions, MatrixDirection};
use crate::exchange::syntax::node::{Node, parse, safe_path};
use crate::exchange::syntax::npy;
use crate::exchange::syntax::table::{Table, TableRow, numbers};
use std::path::Path;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Mat3, Vec3};

/// The format.
pub struct HomographyTables;

/// Names of columns with a matrix.
const MATRIX_COLUMNS: [&str; 5] = ["homography_matrix", "homography", "h", "H", "matrix"];

/// Names of columns with the name of a frame.
const NAME_COLUMNS: [&str; 8] = [
    "image",
    "file_name",
    "filename",
    "file",
    "frame",
    "video",
    "name",
    "id",
];

/// Columns of a matrix's numbers.
const NUMBER_COLUMNS: [&str; 9] = [
    "h11", "h12", "h13", "h21", "h22", "h23", "h31", "h32", "h33",
];

/// The corners of the court in a picture as `ShuttleSet` states them: far left, far right, near
/// left, near right.
const SHUTTLE_CORNERS: [[&str; 2]; 4] = [
    ["upleft_x", "upleft_y"],
    ["upright_x", "upright_y"],
    ["downleft_x", "downleft_y"],
    ["downright_x", "downright_y"],
];

/// What the numbers of all files mean.
struct Reading<'a> {
    plan: GroundPlan,
    direction: MatrixDirection,
    /// From the pixels of the files to ours.
    corner_from_theirs: Mat3,
    options: &'a HomographyOptions,
    field: FieldModel,
}

impl<'a> Reading<'a> {
    /// # Errors
    /// An option is needed, or the field is not valid; `file` is the first that is read.
    fn from_options(options: &'a ImportOptions, file: &str) -> ExchangeResult<Self> {
        let given = &options.homographies;
        let needed = |what: &str, option| {
            let what = what.to_owned();
            Problem::OptionNeeded { what, option }.within(file)
        };
        let plan = given.plan.ok_or_else(|| {
            let option = "--template centre-m, corner-m, wc14 or shuttleset";
            needed("the plane of the homographies", option)
        })?;
        let direction = given.direction.or(plan.usual_direction());
        let direction = direction.ok_or_else(|| {
            let option = "--direction pitch_from_image or image_from_pitch";
            needed("the direction of the homographies", option)
        })?;
        Ok(Self {
            plan,
            direction,
            corner_from_theirs: corner_from(options.pixels.unwrap_or(plan.usual_pixels())),
            options: given,
            field: options.field.model(Path::new(""))?,
        })
    }

    /// The frame of a matrix; `plan_from_ground` is that of its drawing, where it has its own.
    fn frame(
        &self,
        name: &str,
        h: &Mat3,
        plan_from_ground: Option<Mat3>,
    ) -> Result<FrameCamera, Problem> {
        let image_from_plan = match self.direction {
            MatrixDirection::PitchFromImage => inverse(h, "the homography")?,
            MatrixDirection::ImageFromPitch => *h,
        };
        let plan_from_ground =
            plan_from_ground.unwrap_or_else(|| self.plan.plan_from_ground(&self.field));
        let shown = self.corner_from_theirs * image_from_plan * plan_from_ground;
        // Only to refuse a singular matrix, which no camera gives.
        inverse(&shown, "the homography")?;
        Ok(FrameCamera::new(name, None, FrameProjection::Ground(shown)))
    }
}

/// Nine numbers in any brackets.
fn matrix_of_text(text: &str) -> Result<Mat3, Problem> {
    let bare = text.replace(['[', ']', '(', ')', ',', ';'], " ");
    matrix(&numbers("a number of the homography", &bare)?)
}

/// The matrix of a row.
fn matrix_of_row(row: &TableRow<'_>, column: Option<&str>) -> Result<Mat3, Problem> {
    if let Some(column) = column {
        let text = row.text(column).ok_or_else(|| row.missing(column))?;
        return matrix_of_text(text).map_err(|problem| problem.at_line(row.line()));
    }
    let values = NUMBER_COLUMNS.map(|column| row.number(column));
    let values: Vec<f64> = values.into_iter().collect::<Result<_, _>>()?;
    matrix(&values)
}

/// The map from the ground to the drawing of a row of `ShuttleSet` that states the court's corners
/// in the picture; none where it does not, or the corners are no upright rectangle of the drawing.
///
/// # Errors
/// One of the corners is missing, or is no number: with the usual drawing in its place the camera
/// would stand elsewhere.
fn drawing_of_corners(
    row: &TableRow<'_>,
    h: &Mat3,
    field: &FieldModel,
) -> Result<Option<Mat3>, Problem> {
    /// Corners of a rectangle agree this well, px of the drawing.
    const EXACT_PX: f64 = 0.1;
    let mut columns = SHUTTLE_CORNERS.iter().flatten();
    if columns.all(|column| row.text(column).is_none()) {
        return Ok(None);
    }
    let corner = |[x, y]: [&str; 2]| {
        let drawn = h * Vec3::new(row.number(x)?, row.number(y)?, 1.0);
        Ok(drawn.xy() / drawn.z)
    };
    let [a, b, c, d] = SHUTTLE_CORNERS;
    let (a, b, c, d) = (corner(a)?, corner(b)?, corner(c)?, corner(d)?);
    let off_px = [a.x - c.x, b.x - d.x, a.y - b.y, c.y - d.y];
    let is_upright = off_px.iter().all(|off_px| off_px.abs() < EXACT_PX);
    // The court of another drawing is nearly where the usual one is.
    let [left, top, ..] = SHUTTLE_COURT_PX;
    let is_near = (a.x - left).hypot(a.y - top) < 0.1 * (SHUTTLE_COURT_PX[3] - top);
    Ok((is_upright && is_near).then(|| shuttle_from_ground([a.x, a.y, d.x, d.y], field)))
}

fn read_table(bytes: &[u8], reading: &Reading<'_>) -> Result<Vec<FrameCamera>, Problem> {
    let table = Table::read(bytes)?;
    let given = reading.options;
    let known = |column: &str| table.needs(&[column]).is_ok();
    let find = |given: Option<&String>, usual: &[&'static str]| match given {
        Some(column) => table
            .needs(&[column.as_str()])
            .map(|()| Some(column.clone())),
        None => Ok(usual
            .iter()
            .find(|column| known(column))
            .map(|column| (*column).to_owned())),
    };
    let column = find(given.matrix_column.as_ref(), &MATRIX_COLUMNS)?;
    if column.is_none() {
        table.needs(&NUMBER_COLUMNS).map_err(|_| {
            Problem::option_needed("the column of the matrices", "--columns h=NAME")
        })?;
    }
    let name_column = find(given.name_column.as_ref(), &NAME_COLUMNS)?;
    let mut frames = FrameCollector::default();
    for (index, row) in table.rows().enumerate() {
        let name = name_column.as_deref().and_then(|column| row.text(column));
        let name = name.map_or_else(|| format!("{:06}", index + 1), ToOwned::to_owned);
        // A name that leads out of the folder is none, also of a frame without a camera.
        let (name, is_safe) = match safe_path(&name) {
            Ok(path) => (path, Ok(())),
            Err(problem) => (format!("line {}", row.line()), Err(problem)),
        };
        let read = is_safe.and_then(|()| {
            let h = matrix_of_row(&row, column.as_deref())?;
            let is_shuttle = reading.plan == GroundPlan::ShuttleSet
                && reading.direction == MatrixDirection::PitchFromImage;
            let own = if is_shuttle {
                drawing_of_corners(&row, &h, &reading.field)?
            } else {
                None
            };
            reading.frame(&name, &h, own)
        });
        frames.add(&name, None, read);
        if frames.has_only_damaged() {
            break;
        }
    }
    frames.finish()
}

/// The matrix of a JSON line: `h`, of rows or of nine numbers.
fn matrix_of_json(node: &Node<'_>) -> Result<Mat3, Problem> {
    let h = match node.find("h") {
        Some(h) => h,
        None => node.key("homography")?,
    };
    let rows = h.items()?.map(|row| {
        if row.value().is_array() {
            row.all_numbers()
        } else {
            row.number().map(|number| vec![number])
        }
    });
    let rows: Vec<Vec<f64>> = rows.collect::<Result<_, _>>()?;
    matrix(&rows.concat())
}

fn read_lines(bytes: &[u8], reading: &Reading<'_>) -> Result<Vec<FrameCamera>, Problem> {
    let mut frames = FrameCollector::default();
    let lines = text(bytes)?.lines().enumerate();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let mut name = format!("line {}", index + 1);
        let read = parse(line.as_bytes()).and_then(|value| {
            let node = Node::root(&value);
            if let Some(image) = node.find("image") {
                name = image.image_name()?;
            }
            reading.frame(&name, &matrix_of_json(&node)?, None)
        });
        let read = read.map_err(|problem| problem.at_line(index + 1));
        frames.add(&name, None, read);
        if frames.has_only_damaged() {
            break;
        }
    }
    frames.finish()
}

fn read_array(
    file: &str,
    bytes: &[u8],
    reading: &Reading<'_>,
) -> Result<Vec<FrameCamera>, Problem> {
    let array = npy::array(bytes)?;
    let name = without_ending(base_name(file));
    let count = match array.shape[..] {
        [3, 3] => 1,
        [count, 3, 3] => count,
        _ => {
            return Err(Problem::Kind {
                what: "the array".to_owned(),
                wanted: "the shape 3 x 3 or N x 3 x 3",
                found: format!("{:?}", array.shape),
            });
        }
    };
    let mut frames = FrameCollector::default();
    for (index, values) in array.values.chunks_exact(9).take(count).enumerate() {
        let name = match array.shape.len() {
            2 => name.to_owned(),
            _ => format!("{name}_{index:06}"),
        };
        let is_finite = values.iter().all(|value| value.is_finite());
        let h = if is_finite {
            matrix(values)
        } else {
            Err(Problem::NotFinite("a number of the homography".to_owned()))
        };
        frames.add(&name, None, h.and_then(|h| reading.frame(&name, &h, None)));
    }
    frames.finish()
}

impl CameraFormat for HomographyTables {
    fn about(&self) -> About {
        About {
            name: "homographies",
            title: "tables of homographies that do not say what they are",
            conventions: "as --template and --direction say",
            users: "ShuttleSet, scripts",
            loses: None,
            file: None,
            files: "table of homographies (.csv, .jsonl, .npy)",
            endings: &["csv", "jsonl", "npy"],
            export_options: &[],
            import_options: &[
                FormatOption::Field,
                FormatOption::Set,
                FormatOption::Images,
                FormatOption::Size,
                FormatOption::Pixels,
                FormatOption::Template,
                FormatOption::Direction,
                FormatOption::Columns,
            ],
        }
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let entries = files.sorted_entries();
        let first = entries.first().map_or("", |(file, _)| *file);
        let reading = Reading::from_options(options, first)?;
        files.read_all(|file, bytes| {
            if has_ending(file, "csv") {
                read_table(bytes, &reading)
            } else if has_ending(file, "npy") {
                read_array(file, bytes, &reading)
            } else {
                read_lines(bytes, &reading)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::FieldSpec;
    use crate::exchange::options::Pixels;
    use crate::exchange::syntax::npy::Array;
    use touchline_core::geometry::Vec2;

    /// The first row of `ShuttleSet`'s table.
    const SHUTTLE: &str = "id,video,homography_matrix,upleft_x,upright_x,downleft_x,downright_x,\
        upleft_y,upright_y,downleft_y,downright_y\n\
        1,Finals,\"[[1.0606627138451856, 0.3439667138673875, -497.8978610611467], \
        [0.011919581725440269, 4.586662980083068, -1176.8442597836183], \
        [4.8478780487874024e-06, 0.002012572611469505, 1.0]]\",\
        407.6,867.0,307.2,973.0,308.6,307.4,671.2,669.4\n";

    fn options(plan: GroundPlan, field: &str) -> ImportOptions {
        ImportOptions {
            field: FieldSpec::new(field),
            homographies: HomographyOptions {
                plan: Some(plan),
                ..HomographyOptions::default()
            },
            ..ImportOptions::default()
        }
    }

    fn read(file: &str, bytes: &[u8], options: &ImportOptions) -> Result<Vec<FrameCamera>, String> {
        let read = HomographyTables.read(&Files::one(file, bytes.to_vec()), options);
        read.map_err(|error| error.to_string())
    }

    fn shown(frame: &FrameCamera, x: f64, y: f64) -> Vec2 {
        let FrameProjection::Ground(h) = frame.shown else {
            panic!("a homography");
        };
        let at = h * Vec3::new(x, y, 1.0);
        at.xy() / at.z
    }

    #[test]
    fn shuttlesets_court_lies_where_its_corners_are_stated() {
        let frames = read(
            "a.csv",
            SHUTTLE.as_bytes(),
            &options(GroundPlan::ShuttleSet, "badminton"),
        );
        let frames = frames.unwrap();
        assert_eq!(frames[0].name, "Finals");
        // Far left, seen by a camera behind the left end: +x is away, +y to the left.
        for ((x, y), corner) in [
            ((6.7, 3.05), [407.6, 308.6]),
            ((6.7, -3.05), [867.0, 307.4]),
            ((-6.7, 3.05), [307.2, 671.2]),
            ((-6.7, -3.05), [973.0, 669.4]),
        ] {
            let at = shown(&frames[0], x, y);
            assert!((at - Vec2::from(corner)).norm() < 0.05, "{at} {corner:?}");
        }
    }

    #[test]
    fn one_matrix_means_the_same_in_a_table_a_line_and_an_array() {
        let values = [20.0, 1.0, 640.0, 0.5, -15.0, 360.0, 0.001, 0.002, 1.0];
        let mut options = options(GroundPlan::CentreMetres, "soccer");
        options.homographies.direction = Some(MatrixDirection::ImageFromPitch);
        options.pixels = Some(Pixels::Centre);
        let text = values.map(|value| value.to_string()).join(",");
        let columns = NUMBER_COLUMNS.join(",");
        let table = read(
            "a.csv",
            format!("frame,{columns}\n7,{text}\n").as_bytes(),
            &options,
        );
        let line = format!("{{\"image\": \"7.jpg\", \"h\": [{text}]}}\n");
        let line = read("a.jsonl", line.as_bytes(), &options);
        let array = Array {
            shape: vec![1, 3, 3],
            values: values.to_vec(),
        };
        let array = read("a.npy", &array.to_bytes(), &options);
        for frames in [table, line, array].map(Result::unwrap) {
            let at = shown(&frames[0], 0.0, 0.0);
            assert!((at - Vec2::new(640.5, 360.5)).norm() < 1e-9, "{at}");
        }
    }

    #[test]
    fn what_is_not_said_is_requested_and_a_damaged_row_costs_itself_alone() {
        let mut options = options(GroundPlan::CornerMetres, "soccer");
        assert_eq!(
            read("a.csv", SHUTTLE.as_bytes(), &options).unwrap_err(),
            "a.csv: the direction of the homographies is not known; give --direction \
             pitch_from_image or image_from_pitch"
        );
        options.homographies.plan = None;
        assert_eq!(
            read("a.csv", SHUTTLE.as_bytes(), &options).unwrap_err(),
            "a.csv: the plane of the homographies is not known; give --template centre-m, \
             corner-m, wc14 or shuttleset"
        );
        options.homographies.plan = Some(GroundPlan::WorldCup2014);
        let text = "name,m\na,1 0 0 0 1 0 0 0 1\nb,1 2\n";
        assert_eq!(
            read("a.csv", text.as_bytes(), &options).unwrap_err(),
            "a.csv: the column of the matrices is not known; give --columns h=NAME"
        );
        options.homographies.matrix_column = Some("m".to_owned());
        let frames = read("a.csv", text.as_bytes(), &options).unwrap();
        let unread = frames[1].unreadable.as_ref().unwrap();
        assert_eq!(
            unread.problem,
            "line 3: the homography (numbers): 9 are expected, found 2"
        );
    }
}
