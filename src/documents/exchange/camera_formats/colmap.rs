//! COLMAP's text files: `cameras.txt`, `images.txt`, `points3D.txt`.
//!
//! (0.5, 0.5) is the centre of the first pixel, as in our convention; world→camera is a Hamilton
//! quaternion and t = −R C; world and units are free, and ours are written. Because the focal
//! length changes, every frame has a camera of its own. Every image has two lines; the second one
//! is written even if it is empty, because readers silently lose images without it. Clicked
//! landmarks are written as points with tracks. Source: colmap/colmap, doc/format.rst.

use crate::exchange::cameras::calibration_matrix::{Calibration, WithoutSkew};
use crate::exchange::cameras::camera_format::{CameraFormat, HeldFrame, WriteContext};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::held::{parts, relative_name};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::node::safe_path;
use crate::exchange::syntax::table::{number, numbers};
use crate::exchange::syntax::values::{coefficient, shorten};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};

/// The format.
pub struct Colmap;

/// The fields of an image's line.
const IMAGE_FIELDS: usize = 10;

const CAMERAS: &str = "cameras.txt";
const IMAGES: &str = "images.txt";
const POINTS: &str = "points3D.txt";

/// The picture and lens of a camera's line.
#[derive(Clone, Copy)]
struct Lens {
    size: ImageSize,
    taken: WithoutSkew,
    radial: Radial,
}

/// The cameras by their numbers, or what is wrong with them: only an image that has one of these
/// cannot be read.
type Lenses = BTreeMap<u64, Result<Lens, Problem>>;

fn read_camera(fields: &[&str]) -> Result<Lens, Problem> {
    let [_, model, width, height, params @ ..] = fields else {
        return Err(Problem::wrong_count("fields of a camera", 8, fields.len()));
    };
    let params: Vec<f64> = params
        .iter()
        .map(|field| number("a parameter of the camera", field))
        .collect::<Result<_, _>>()?;
    let size = ImageSize::new(side_px(width)?, side_px(height)?);
    let wanted = match *model {
        "SIMPLE_PINHOLE" => 3,
        "PINHOLE" | "SIMPLE_RADIAL" => 4,
        "RADIAL" => 5,
        "OPENCV" => 8,
        other => {
            let why = "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL and OPENCV are read";
            return Err(Problem::not_supported(
                format!("the camera model {:?}", shorten(other)),
                why,
            ));
        }
    };
    if params.len() != wanted {
        return Err(Problem::wrong_count(
            format!("parameters of {model}"),
            wanted,
            params.len(),
        ));
    }
    // Behind one or two focal lengths come cx and cy, which every model has, and then k1, k2, p1
    // and p2 as far as the model has them.
    let has_two = matches!(*model, "PINHOLE" | "OPENCV");
    let (focal, rest) = params.split_at(if has_two { 2 } else { 1 });
    let calibration = Calibration {
        fx: focal[0],
        fy: *focal.last().unwrap_or(&focal[0]),
        skew: 0.0,
        principal_point: ImagePoint::new(rest[0], rest[1]),
    };
    if rest.iter().skip(4).any(|value| *value != 0.0) {
        let why = "the document's lens has k1 and k2 only";
        return Err(Problem::not_supported("tangential distortion", why));
    }
    let taken = calibration.without_skew(size)?;
    Ok(Lens {
        size,
        taken,
        radial: Radial {
            k1: coefficient(rest, 2),
            k2: coefficient(rest, 3),
            pixel_aspect: taken.pixel_aspect,
        },
    })
}

/// A side of a picture, px.
fn side_px(field: &str) -> Result<u32, Problem> {
    field
        .parse::<u32>()
        .ok()
        .filter(|side| ImageSize::is_side_px(f64::from(*side)))
        .ok_or_else(|| Problem::Kind {
            what: "the size of the picture".to_owned(),
            wanted: "a whole number from 1 to 65535",
            found: format!("{:?}", shorten(field)),
        })
}

/// Lines that are not comments, with their number from 1. Empty lines are included only if
/// `keeps_empty`.
fn lines(text: &str, keeps_empty: bool) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line));
    numbered
        .filter(move |(_, line)| !line.starts_with('#') && (keeps_empty || !line.trim().is_empty()))
}

fn read_cameras(bytes: &[u8]) -> Result<Lenses, Problem> {
    let mut cameras = BTreeMap::new();
    for (line_number, line) in lines(text(bytes)?, false) {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let id = fields.first().copied().unwrap_or_default();
        let id: u64 = id.parse().map_err(|_| {
            let problem = Problem::Kind {
                what: "the camera's number".to_owned(),
                wanted: "a whole number",
                found: format!("{:?}", shorten(id)),
            };
            problem.at_line(line_number)
        })?;
        // The file is named, because the image that has the camera is of another one.
        let lens = read_camera(&fields).map_err(|problem| Problem::Array {
            array: CAMERAS.to_owned(),
            problem: Box::new(problem.at_line(line_number)),
        });
        if cameras.insert(id, lens).is_some() {
            return Err(Problem::twice("the camera", id.to_string()).at_line(line_number));
        }
    }
    Ok(cameras)
}

/// The fields of an image's line, between blanks. The last of ten, its name, may hold blanks.
fn image_fields(line: &str) -> Vec<&str> {
    // Only the first nine fields are split off; what is left is the name.
    let mut fields = Vec::new();
    let mut rest = line.trim();
    while fields.len() < 9
        && let Some((field, behind)) = rest.split_once(char::is_whitespace)
    {
        fields.push(field);
        rest = behind.trim_start();
    }
    fields.push(rest);
    fields
}

fn read_image(line: &str, cameras: &Lenses) -> Result<FrameCamera, Problem> {
    let fields = image_fields(line);
    let [_, pose @ .., camera, name] = &fields[..] else {
        return Err(Problem::wrong_count("fields of an image", 10, fields.len()));
    };
    let found = fields.len();
    let pose = numbers("the pose of the image", &pose.join(" "))?;
    let [w, x, y, z, tx, ty, tz]: [f64; 7] = pose
        .try_into()
        .map_err(|_| Problem::wrong_count("fields of an image", 10, found))?;
    let quaternion = Quaternion::new(w, x, y, z);
    // Rounded digits leave the length near 1, and it is normalised below. Another length means that
    // the fields are not a quaternion.
    if !((quaternion.norm() - 1.0).abs() < 1e-3) {
        let what = "the length of the quaternion".to_owned();
        return Err(Problem::out_of_range(what, quaternion.norm(), "1"));
    }
    let id: u64 = camera.parse().map_err(|_| unknown_camera(camera))?;
    let lens = cameras.get(&id).ok_or_else(|| unknown_camera(camera))?;
    let Lens {
        size,
        taken,
        radial,
    } = *lens.as_ref().map_err(Clone::clone)?;
    let cam_from_world = *UnitQuaternion::from_quaternion(quaternion)
        .to_rotation_matrix()
        .matrix();
    // t = −R C, so C = −Rᵀ t.
    let pinhole = Pinhole {
        cam_from_world,
        position_m: -(cam_from_world.transpose() * Vec3::new(tx, ty, tz)),
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        lens: radial,
    };
    let name = safe_path(name)?;
    let pinhole = pinhole.validate("the camera")?;
    Ok(FrameCamera {
        image: Some(name.clone()),
        off_px: taken.off_px,
        ..FrameCamera::new(&name, Some(size), FrameProjection::Camera(pinhole))
    })
}

/// The error that an image refers to a camera that is not in the file.
fn unknown_camera(id: &str) -> Problem {
    Problem::Unknown {
        what: "the camera",
        name: shorten(id),
    }
}

fn read_images(bytes: &[u8], cameras: &Lenses) -> Result<Vec<FrameCamera>, Problem> {
    let mut frames = FrameCollector::default();
    let mut rest = lines(text(bytes)?, true);
    while let Some((line_number, line)) = rest.next() {
        if line.trim().is_empty() {
            // Between images, and at the end of the file.
            continue;
        }
        let read = read_image(line, cameras).map_err(|problem| problem.at_line(line_number));
        let name = image_fields(line).last().copied().unwrap_or_default();
        frames.add(name, None, read);
        if frames.has_only_damaged() {
            break;
        }
        // COLMAP's own readers lose all images of such a file without a word. Here the line of the
        // next image would be taken for points.
        let Some((points_line, points)) = rest.next() else {
            let missing =
                "the line of points behind the last image (it may be empty, but it must be there)";
            return Err(Problem::Missing(missing.to_owned()).at_line(line_number + 1));
        };
        let count = points.split_whitespace().count();
        // X, Y and the point's id. A line of an image has ten fields, so that a missing line of
        // points in between is noticed, too.
        if count == IMAGE_FIELDS {
            let what = "two lines for each image (the second is of points, it may be empty)";
            return Err(Problem::Missing(what.to_owned()).at_line(points_line));
        }
        if count % 3 != 0 {
            let what = "the line of points behind an image (numbers, by three)".to_owned();
            let problem = Problem::wrong_count(what, count.next_multiple_of(3), count);
            return Err(problem.at_line(points_line));
        }
    }
    frames.finish()
}

/// A clicked landmark.
struct Track {
    point_in_world: Vec3,
    /// The sum of the reprojection errors of its clicks, px.
    off_px: f64,
    /// The image, from 1, and the index among its points, from 0.
    seen: Vec<(usize, usize)>,
}

/// The second line of an image: its clicks, with the ids of their points.
fn points_line(
    frame: &FrameCamera,
    image: usize,
    field: &FieldModel,
    tracks: &mut BTreeMap<usize, Track>,
) -> String {
    let mut points = Vec::new();
    for (name, at) in &frame.record.clicks {
        // Clicks on landmarks that the field does not have, or that the camera cannot see, are no
        // points of this model.
        let Some(index) = field
            .landmarks
            .iter()
            .position(|landmark| landmark.id.as_str() == name)
        else {
            continue;
        };
        let point_in_world = field.landmark_in_world(&field.landmarks[index]);
        let Some(shown) = frame.image_from_world(point_in_world) else {
            continue;
        };
        // The id of a point is the number of its landmark, from 1, in every image.
        let track = tracks.entry(index + 1).or_insert(Track {
            point_in_world,
            off_px: 0.0,
            seen: Vec::new(),
        });
        // COLMAP allows one observation of a point per image.
        if track.seen.last().is_none_or(|(last, _)| *last != image) {
            track.seen.push((image, points.len()));
            track.off_px += shown.distance_px(*at);
            points.push(format!("{} {} {}", at.x, at.y, index + 1));
        }
    }
    points.join(" ")
}

/// `points3D.txt`.
fn points_file(tracks: &BTreeMap<usize, Track>) -> String {
    let mut text = "# POINT3D_ID X Y Z R G B ERROR TRACK[] (IMAGE_ID POINT2D_IDX)\n".to_owned();
    for (
        id,
        Track {
            point_in_world: point,
            off_px,
            seen,
        },
    ) in tracks
    {
        // COLMAP's ERROR is the mean reprojection error in px. A track has at least one image.
        let error = off_px / seen.len() as f64;
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{id} {} {} {} 255 255 255 {error}",
            point.x, point.y, point.z
        );
        for (image, at) in seen {
            let _ = write!(text, " {image} {at}");
        }
        text.push('\n');
    }
    text
}

impl CameraFormat for Colmap {
    fn about(&self) -> About {
        About {
            name: "colmap",
            title: "COLMAP text: cameras, images, points3D",
            conventions: "touchline's world → camera, quaternion; pixels from the corner; one camera per frame",
            users: "COLMAP, pycolmap, NeRF, 3D Gaussian splats",
            loses: Some("time, uncertainty"),
            file: None,
            files: "cameras.txt and images.txt",
            endings: &["txt"],
            export_options: format_options::CAMERAS_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let name = relative_name(frame);
        if name.contains(char::is_whitespace) {
            return Err(format!(
                "names must not contain spaces, and {name:?} does; rename the image"
            ));
        }
        Ok(frame.with_name(name))
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut cameras =
            "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[] (f, cx, cy, k1, k2)\n".to_owned();
        let mut images =
            "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# POINTS2D[] (X Y POINT3D_ID)\n\
                          # world: metres from the field's middle, x right, y away, z up\n"
                .to_owned();
        let mut tracks = BTreeMap::new();
        for (index, frame) in held.iter().enumerate() {
            let Ok((pinhole, size)) = parts(frame) else {
                continue;
            };
            let points = points_line(frame, index + 1, context.field, &mut tracks);
            let (id, c, t) = (index + 1, pinhole.principal_point, pinhole.translation());
            let Radial {
                k1,
                k2,
                pixel_aspect,
            } = pinhole.lens;
            // The smaller model wherever it has all numbers: old readers know it.
            let (model, focal, tangential) = if pixel_aspect == 1.0 {
                ("RADIAL", pinhole.focal_px.to_string(), "")
            } else {
                let fy = pinhole.focal_px * pixel_aspect;
                ("OPENCV", format!("{} {fy}", pinhole.focal_px), " 0 0")
            };
            let rotation = Rotation3::from_matrix_unchecked(pinhole.cam_from_world);
            let q = UnitQuaternion::from_rotation_matrix(&rotation);
            // q and −q are the same rotation; write the one with w ≥ 0.
            let sign = if q.w < 0.0 { -1.0 } else { 1.0 };
            let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|part| sign * part);
            // Writing to a string cannot fail.
            let _ = writeln!(
                cameras,
                "{id} {model} {} {} {focal} {} {} {k1} {k2}{tangential}",
                size.width, size.height, c.x, c.y
            );
            let _ = writeln!(
                images,
                "{id} {w} {x} {y} {z} {} {} {} {id} {}\n{points}",
                t.x, t.y, t.z, frame.name
            );
        }
        let mut files = Files::default();
        files.add(CAMERAS, cameras);
        files.add(IMAGES, images);
        files.add(POINTS, points_file(&tracks));
        Ok(files)
    }

    fn is_wanted(&self, name: &str) -> bool {
        name == CAMERAS || name == IMAGES
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let cameras = read_cameras(required_file(files, CAMERAS)?)
            .map_err(|problem| problem.within(CAMERAS))?;
        read_images(required_file(files, IMAGES)?, &cameras)
            .map_err(|problem| problem.within(IMAGES))
    }
}

/// The contents of a file that must be there.
fn required_file<'a>(files: &'a Files, name: &str) -> ExchangeResult<&'a [u8]> {
    files
        .get(name)
        .ok_or_else(|| Problem::Missing("the file".to_owned()).within(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::Format;
    use crate::exchange::tests::{awkward, export_as, reference, text_of, with_clicks};

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let files = export_as(&reference(), Format::Colmap).files;
        assert!(text_of(&files, CAMERAS).ends_with("\n1 RADIAL 1920 1080 2410 960 540 0.0661 0\n"));
        let images = text_of(&files, IMAGES);
        assert!(
            images.ends_with(" 1 images/0001.jpg\n\n"),
            "the second line is there: {images:?}"
        );
        let line = images.lines().find(|line| !line.starts_with('#')).unwrap();
        let found = numbers("the pose", line.rsplit_once(' ').unwrap().0).unwrap();
        let wanted = [
            1.0,
            0.6309578897118199,
            0.7681407064922243,
            -0.08412508923984748,
            0.0691011273455145,
            -12.986376836286173,
            6.279379503790085,
            60.95837440182727,
            1.0,
        ];
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{line}");
        }
    }

    #[test]
    fn clicked_landmarks_are_points_with_tracks_and_held_out_points_are_not() {
        let mut document = with_clicks();
        let twice = document.frames[0].clicks[0].clone();
        document.frames[0].clicks.push(twice);
        let files = export_as(&document, Format::Colmap).files;
        let points: Vec<String> = text_of(&files, POINTS)
            .lines()
            .skip(1)
            .map(ToOwned::to_owned)
            .collect();
        assert_eq!(points.len(), 2, "{points:?}");
        let first: Vec<f64> = numbers("a point", &points[0]).unwrap();
        assert_eq!(first[1..7], [0.0, 0.0, 0.0, 255.0, 255.0, 255.0]);
        assert!(
            first[7] < 1e-3 && first[8..] == [1.0, 0.0],
            "its error and its track: {first:?}"
        );
        let images = text_of(&files, IMAGES);
        let line = images.lines().last().unwrap();
        assert!(
            line.starts_with("444.681 789.175 ") && line.split(' ').count() == 6,
            "{line}"
        );
    }

    #[test]
    fn awkward_cameras_come_back() {
        let exported = export_as(&awkward(), Format::Colmap);
        assert!(
            exported.loss.is_none() && exported.worst_px < 1e-6,
            "{exported:?}"
        );
    }

    #[test]
    fn fields_of_images_are_between_any_blanks_and_names_may_hold_some() {
        let mut files = export_as(&reference(), Format::Colmap).files;
        let images = text_of(&files, IMAGES);
        let read = |files: &Files| Colmap.read(files, &ImportOptions::default()).unwrap();
        let before = read(&files);
        let line = images.lines().find(|line| line.contains(".jpg")).unwrap();
        for blank in ["  ", "\t", " \t "] {
            let spaced = line.replace(' ', blank).replace("0001.jpg", "00  01.jpg");
            files.add(IMAGES, images.replace(line, &format!(" {spaced} ")));
            let again = read(&files);
            assert_eq!(again[0].name, "images/00  01.jpg");
            assert_eq!(again[0].shown, before[0].shown);
        }
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let files = export_as(&reference(), Format::Colmap).files;
        let (cameras, images) = (text_of(&files, CAMERAS), text_of(&files, IMAGES));
        let swap = |text: &str, from: &str, to: &str| text.replacen(from, to, 1);
        let cases = [
            (
                String::new(),
                images.clone(),
                "cameras.txt: the file is empty",
            ),
            (
                swap(&cameras, "RADIAL", "FISHEYE"),
                images.clone(),
                "images.txt: line 4: cameras.txt: line 2: the camera model \"FISHEYE\" cannot be \
                 read: SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL and OPENCV are read",
            ),
            (
                swap(&cameras, " 0.0661 0", " 0.0661"),
                images.clone(),
                "images.txt: line 4: cameras.txt: line 2: parameters of RADIAL: 5 are expected, \
                 found 4",
            ),
            (
                swap(&cameras, "1920", "-1920"),
                images.clone(),
                "images.txt: line 4: cameras.txt: line 2: the size of the picture: a whole \
                 number from 1 to 65535 is expected, found \"-1920\"",
            ),
            (
                swap(&cameras, "2410", "nan"),
                images.clone(),
                "images.txt: line 4: cameras.txt: line 2: a parameter of the camera is not a \
                 finite number",
            ),
            (
                format!("{cameras}1 RADIAL 1920 1080 2410 960 540 0 0\n"),
                images.clone(),
                "cameras.txt: line 3: the camera \"1\" occurs twice",
            ),
            (
                cameras.clone(),
                String::new(),
                "images.txt: the file is empty",
            ),
            (
                cameras.clone(),
                images.trim_end().to_owned(),
                "images.txt: line 5: the line of points behind the last image (it may be empty, but it must be there) is missing",
            ),
            (
                cameras.clone(),
                swap(&images, "\n\n", "\n1 2 3 4\n"),
                "images.txt: line 5: the line of points behind an image (numbers, by three): 6 are expected, found 4",
            ),
            (
                cameras.clone(),
                swap(&images, " 1 images", " 7 images"),
                "images.txt: line 4: the camera \"7\" is not in the file",
            ),
            (
                cameras.clone(),
                swap(&images, "images/0001", "../0001"),
                "images.txt: line 4: the path \"../0001.jpg\" points outside the folder",
            ),
            (
                cameras.clone(),
                swap(&images, " 0.76", " 5.76"),
                "images.txt: line 4: the length of the quaternion is 5.803568476801342, which must be 1",
            ),
            (
                cameras.clone(),
                "1 2 3\n\n".to_owned(),
                "images.txt: line 1: fields of an image: 10 are expected, found 3",
            ),
        ];
        for (cameras, images, wanted) in cases {
            let mut files = Files::one(CAMERAS, cameras.into_bytes());
            files.add(IMAGES, images);
            let error = Colmap
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert!(error.starts_with(wanted), "{error}\nwanted {wanted}");
        }
        let error = Colmap
            .read(
                &Files::one(CAMERAS, cameras.into_bytes()),
                &ImportOptions::default(),
            )
            .unwrap_err();
        assert_eq!(error.to_string(), "images.txt: the file is missing");
    }
}
