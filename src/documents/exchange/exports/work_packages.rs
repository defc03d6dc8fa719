//! Work packages on the disk: one folder each, with a project and copies of its pictures, to be
//! labelled on another machine.
//!
//! | in a package | what |
//! |---|---|
//! | `project.json` | the document of its frames ([`split_into_packages`]) |
//! | `images/` | copies of the frames' images |
//! | `videos/` | copies of their videos |
//! | `fields/` | field templates of the user's own |

use super::dataset::{OwnPlaces, with_templates};
use crate::document::{
    CameraId, Document, DocumentAt, FieldSpec, Frame, Restored, document_to_string,
    restore_package, split_into_packages,
};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{cannot_read, cannot_write, write_new};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use touchline_core::files::{
    PROJECT_FILE, folder_of, follow_link, open_named, replace_folder, temporary_folder_in,
};

/// Writes the document in packages of `count` frames each into a folder that is empty or does not
/// exist. Returns the number of frames of each.
///
/// # Errors
/// The folder holds something, a picture lies outside of the project and `outside` was not given,
/// or something cannot be read or written. Nothing is written then.
pub fn write_packages(
    at: DocumentAt<'_>,
    count: usize,
    folder: &Path,
    outside: bool,
) -> Result<Vec<usize>, ExchangeError> {
    if folder.is_file() || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
        return Err(ExchangeError::NotEmpty {
            path: folder.to_path_buf(),
        });
    }
    if !outside {
        refuse_outside(at)?;
    }
    // A template lies elsewhere on the other machine, so that each package has a copy; the document
    // names the copies.
    let (document, templates) = with_templates(at)?;
    // Errors name the folder as it was given, not the target of a link.
    let target = &follow_link(folder);
    let temporary =
        temporary_folder_in(folder_of(target)).map_err(|source| cannot_write(folder, source))?;
    let packages = split_into_packages(&document, count);
    for (index, package) in packages.iter().enumerate() {
        let place = temporary.path().join(format!("package{:03}", index + 1));
        let package = copy_pictures(package, at.folder, &place, folder)?;
        let project = document_to_string(&package)?.into_bytes();
        let texts = templates
            .iter()
            .map(|(name, bytes)| (name.as_str(), bytes))
            .chain([(PROJECT_FILE, &project)]);
        for (name, bytes) in texts {
            write_new(&place.join(name), bytes).map_err(|source| cannot_write(folder, source))?;
        }
    }
    // The folder is empty or absent: nothing in it is replaced.
    replace_folder(temporary, target, &|_, _| false)?;
    Ok(packages
        .iter()
        .map(|package| package.frames.len())
        .collect())
}

/// A version of `base` as a whole document, and the state that both have in common: what a package
/// does not contain is taken from `base`, with the paths of pictures and template files of `base`.
///
/// # Errors
/// A template of `base` cannot be read, or the version is of another match.
pub fn restore_version(
    base: DocumentAt<'_>,
    version: &Document,
) -> Result<Restored, ExchangeError> {
    // The package names copies of the templates, under names that are computed again here. Its
    // record is of these names, too.
    let (packed, _) = with_templates(base)?;
    let mut restored = restore_package(&packed, version).map_err(ExchangeError::OtherPictures)?;
    for document in [
        &mut restored.common,
        &mut restored.version,
        &mut restored.own,
    ] {
        take_own_templates(document, base.document, &packed);
    }
    Ok(restored)
}

/// Names the template files of `base` instead of their copies. A field that was changed in a
/// package is another one and stays.
fn take_own_templates(document: &mut Document, base: &Document, packed: &Document) {
    if document.field == packed.field {
        document.field = base.field.clone();
    }
    for camera in &mut document.cameras {
        if camera.field.is_some() && camera.field == field_of_camera(packed, &camera.id) {
            camera.field = field_of_camera(base, &camera.id);
        }
    }
}

/// The field of a camera of a document; none if it is the document's own.
fn field_of_camera(document: &Document, id: &CameraId) -> Option<FieldSpec> {
    document.camera(id).and_then(|camera| camera.field.clone())
}

fn refuse_outside(at: DocumentAt<'_>) -> Result<(), ExchangeError> {
    let places = OwnPlaces::from_project(at.folder);
    // Many frames have the same video.
    let mut seen = BTreeSet::new();
    let outside: Vec<PathBuf> = at
        .document
        .frames
        .iter()
        .flat_map(|frame| files_of(frame, at.folder))
        .filter(|file| seen.insert(file.clone()) && !places.hold(file))
        .collect();
    match outside.first() {
        Some(first) => Err(ExchangeError::Outside {
            count: outside.len(),
            first: first.clone(),
        }),
        None => Ok(()),
    }
}

/// The image and the video of a frame.
fn files_of(frame: &Frame, folder: &Path) -> Vec<PathBuf> {
    let video = frame.video.as_ref().map(|video| video.file_path(folder));
    frame.image_path(folder).into_iter().chain(video).collect()
}

/// The package with copies of its pictures in its folder, `place`, until all are renamed to
/// `target`.
fn copy_pictures(
    package: &Document,
    folder: &Path,
    place: &Path,
    target: &Path,
) -> Result<Document, ExchangeError> {
    let mut package = package.clone();
    let mut names = Names::default();
    for frame in &mut package.frames {
        let frame: &mut Frame = frame;
        if let Some(path) = frame.image_path(folder) {
            let name = names.take("images", &path);
            copy(&path, &place.join(&name), target)?;
            frame.image = Some(name);
        }
        if let Some(video) = &mut frame.video {
            let path = video.file_path(folder);
            // A video is that of many frames and is copied once; an image is of one frame as a
            // rule.
            let is_new = !names.by_file.contains_key(&path);
            let name = names.take("videos", &path);
            if is_new {
                copy(&path, &place.join(&name), target)?;
            }
            video.path = name;
        }
    }
    Ok(package)
}

/// Copies a file. An error of the writing names `target`.
fn copy(from: &Path, to: &Path, target: &Path) -> Result<(), ExchangeError> {
    // What can be opened can be read as a rule, so that what fails afterwards is the writing, such
    // as on a full disk.
    open_named(from).map_err(|source| cannot_read(from, source))?;
    copy_whole(from, to).map_err(|source| cannot_write(target, source))
}

/// Copies a file; where the file system can, both share their content until one is changed. A hard
/// link would be the same file: who cuts the video of a package would cut the owner's.
fn copy_whole(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(folder_of(to))?;
    // A symbolic link within the project would be broken in the package. The system call behind
    // `fs::copy` shares the content on Btrfs, XFS and APFS.
    fs::copy(fs::canonicalize(from)?, to).map(drop)
}

/// The names of files in a package: their own, with a number where two have the same name.
#[derive(Default)]
struct Names {
    by_file: BTreeMap<PathBuf, String>,
    /// In lower case, because names that differ only in case are equal on many systems.
    taken: BTreeSet<String>,
    /// The number with which the search for a free name goes on, by the name in lower case.
    next: BTreeMap<String, usize>,
}

impl Names {
    fn take(&mut self, folder: &str, file: &Path) -> String {
        if let Some(known) = self.by_file.get(file) {
            return known.clone();
        }
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let ending = file.extension().unwrap_or_default().to_string_lossy();
        let dot = if ending.is_empty() { "" } else { "." };
        let wanted = format!("{folder}/{stem}{dot}{ending}");
        let next = self.next.entry(wanted.to_lowercase()).or_insert(1);
        loop {
            let name = match *next {
                1 => wanted.clone(),
                number => format!("{folder}/{stem}-{number}{dot}{ending}"),
            };
            *next += 1;
            if self.taken.insert(name.to_lowercase()) {
                self.by_file.insert(file.to_path_buf(), name.clone());
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{VideoFrame, document_from_bytes};
    use touchline_core::geometry::ImageSize;

    /// A project of five frames, two of them with one name.
    fn project(folder: &Path) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for name in [
            "images/1.jpg",
            "images/2.jpg",
            "more/2.jpg",
            "images/3.jpg",
            "images/4.jpg",
        ] {
            fs::create_dir_all(folder_of(&folder.join(name))).unwrap();
            fs::write(folder.join(name), name).unwrap();
            document
                .frames
                .push(Frame::from_image(name, "main".into(), ImageSize::new(64, 48)).into());
        }
        document
    }

    #[test]
    fn packages_have_copies_of_their_pictures_and_come_back() {
        let place = tempfile::tempdir().unwrap();
        let base = project(&place.path().join("project"));
        let at = base.at(&place.path().join("project")).folder.to_path_buf();
        let out = place.path().join("out");
        assert_eq!(
            write_packages(base.at(&at), 3, &out, false).unwrap(),
            [3, 2]
        );
        let read = |number: usize| {
            document_from_bytes(
                &fs::read(out.join(format!("package{number:03}/project.json"))).unwrap(),
            )
            .unwrap()
        };
        let first = read(1);
        let images: Vec<&str> = first
            .frames
            .iter()
            .filter_map(|frame| frame.image.as_deref())
            .collect();
        assert_eq!(images, ["images/1.jpg", "images/2.jpg", "images/2-2.jpg"]);
        assert_eq!(
            fs::read_to_string(out.join("package001/images/2-2.jpg")).unwrap(),
            "more/2.jpg"
        );
        for package in [first, read(2)] {
            let restored = restore_version(base.at(&at), &package).unwrap();
            assert_eq!(
                [restored.common, restored.version],
                [base.clone(), base.clone()]
            );
        }
        let again = write_packages(base.at(&at), 3, &out, false)
            .unwrap_err()
            .to_string();
        assert!(
            again.ends_with("out holds something already; give an empty or a new folder"),
            "{again}"
        );
    }

    #[test]
    fn a_video_that_is_cut_in_a_package_stays_whole_for_the_owner() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("project");
        let mut base = project(&folder);
        fs::write(folder.join("match.mp4"), "a long video").unwrap();
        let shown = VideoFrame::new("match.mp4", 3, None);
        let frame = Frame::from_video(shown, "main".into(), ImageSize::new(64, 48));
        base.frames.push(frame.into());
        let out = place.path().join("out");
        write_packages(base.at(&folder), 6, &out, false).unwrap();
        let copy = out.join("package001/videos/match.mp4");
        let mut opened = fs::OpenOptions::new().write(true).open(&copy).unwrap();
        std::io::Write::write_all(&mut opened, b"a cut").unwrap();
        opened.set_len(5).unwrap();
        assert_eq!(fs::read_to_string(&copy).unwrap(), "a cut");
        let own = fs::read_to_string(folder.join("match.mp4")).unwrap();
        assert_eq!(own, "a long video");
    }

    #[test]
    fn files_keep_their_names_also_without_an_ending() {
        let mut names = Names::default();
        let taken = ["/a/match", "/b/match", "/c/MATCH-2", "/a/match"]
            .map(|file| names.take("videos", Path::new(file)));
        let wanted = ["match", "match-2", "MATCH-2-2", "match"];
        assert_eq!(taken, wanted.map(|name| format!("videos/{name}")));
    }

    #[test]
    fn what_cannot_be_read_or_written_is_named_as_such() {
        let place = tempfile::tempdir().unwrap();
        let (from, in_the_way) = (place.path().join("1.jpg"), place.path().join("file"));
        fs::write(&in_the_way, "").unwrap();
        let to = in_the_way.join("1.jpg");
        let unread = format!("cannot read {}: ", from.display());
        for wanted in [unread.as_str(), "cannot write /packages: "] {
            let copied = copy(&from, &to, Path::new("/packages"));
            let said = copied.unwrap_err().to_string();
            assert!(said.starts_with(wanted), "{said}");
            fs::write(&from, "").unwrap();
        }
    }

    #[cfg(unix)]
    #[test]
    fn packages_are_written_through_a_link_to_an_empty_folder() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("project");
        let base = project(&folder);
        let (out, link) = (place.path().join("out"), place.path().join("link"));
        fs::create_dir(&out).unwrap();
        std::os::unix::fs::symlink(&out, &link).unwrap();
        write_packages(base.at(&folder), 5, &link, false).unwrap();
        assert!(link.is_symlink() && out.join("package001/project.json").is_file());
    }

    #[test]
    fn a_picture_from_outside_has_to_be_allowed() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("project");
        let mut base = project(&folder);
        fs::write(place.path().join("private.jpg"), "private").unwrap();
        base.frames[1].image = Some("../private.jpg".to_owned());
        let refused = write_packages(base.at(&folder), 5, &place.path().join("out"), false)
            .unwrap_err()
            .to_string();
        assert!(
            refused.contains("1 file outside of the project, the first is "),
            "{refused}"
        );
        assert!(!place.path().join("out").exists());
        write_packages(base.at(&folder), 5, &place.path().join("out"), true).unwrap();
        assert!(
            place
                .path()
                .join("out/package001/images/private.jpg")
                .exists()
        );
    }
}
