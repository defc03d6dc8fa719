//! Writes results to files: completely or not at all, and without `--force` never over an existing
//! file. Links, pipes and devices are written through.

use anyhow::{Context as _, anyhow, bail, ensure};
use image::{DynamicImage, ImageFormat};
use std::io::{Cursor, Write as _};
use std::path::Path;
use touchline_calibration::proposals::WORK_FOLDER;
use touchline_core::files::{
    refuse_part_of_project, remove_stray_files, temporary_file_in, way_out,
};
use touchline_documents::report::Report;
use touchline_documents::store::{refuse_document, write_new, write_output};

/// Refuses a path that exists, unless `force`, and a path that cannot be written. To be called
/// before the work begins.
///
/// # Errors
/// The path exists, or its folder does not accept files.
pub fn refuse_existing(path: &Path, force: bool) -> anyhow::Result<()> {
    if is_pipe_or_device(path) {
        // A pipe is written through: nothing is replaced, and no file is created beside it.
        return Ok(());
    }
    refuse_to_replace(path, force)?;
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    // Missing folders will be created, so that the first existing one must accept files.
    let Some(folder) = path.ancestors().skip(1).find(|folder| folder.exists()) else {
        return Ok(());
    };
    // Runs that were killed leave temporary files, which would fill the folder. Then a file is made
    // for a trial: permissions alone say nothing of a full or read-only disk.
    remove_stray_files(folder);
    temporary_file_in(folder).map(drop).map_err(|error| {
        let (path, folder, way_out) = (path.display(), folder.display(), way_out(&error));
        anyhow!("cannot write {path}: nothing can be made in {folder}: {error}{way_out}")
    })
}

/// Refuses a path that exists, unless `force`. An empty folder counts as absent.
fn refuse_to_replace(path: &Path, force: bool) -> anyhow::Result<()> {
    ensure!(
        force || !path.exists() || is_empty_folder(path),
        "{} already exists; give --force to replace it, or another -o",
        path.display()
    );
    Ok(())
}

/// Refuses what [`refuse_existing`] refuses, and a folder where a file is to be written. To be
/// called before the work begins: no file takes the place of a folder, not even of an empty one.
///
/// # Errors
/// The path exists or is a folder, or its folder does not accept files.
pub fn refuse_existing_file(path: &Path, force: bool) -> anyhow::Result<()> {
    ensure!(
        !path.is_dir(),
        "{} is a folder; give the name of a file",
        path.display()
    );
    refuse_existing(path, force)
}

/// Refuses a file where a folder for something is to be written.
///
/// # Errors
/// The path is a file.
pub fn refuse_file(path: &Path, what_for: &str) -> anyhow::Result<()> {
    ensure!(
        path.is_dir() || !path.exists(),
        "{} is a file; give a folder for {what_for}",
        path.display()
    );
    Ok(())
}

/// Refuses a name that promises another format than PNG; `option` is the argument that gives it.
///
/// # Errors
/// The name does not end with `.png`.
pub fn refuse_other_than_png(option: &str, path: &Path) -> anyhow::Result<()> {
    ensure!(
        ending(path) == "png",
        "{option} {}: a PNG is written, so its name must end with .png",
        path.display()
    );
    Ok(())
}

/// The extension of a path in small letters; empty if there is none.
pub fn ending(path: &Path) -> String {
    path.extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase())
        .unwrap_or_default()
}

/// A picture as the bytes of a PNG.
///
/// # Errors
/// It has no pixels.
pub fn encode_png(picture: impl Into<DynamicImage>) -> anyhow::Result<Vec<u8>> {
    let mut png = Cursor::new(Vec::new());
    picture
        .into()
        .write_to(&mut png, ImageFormat::Png)
        .context("cannot encode the PNG")?;
    Ok(png.into_inner())
}

/// Whether a path is a pipe or a device such as `/dev/stdout`, so that writing replaces nothing.
pub fn is_pipe_or_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// Whether a folder exists and is empty, or has nothing but work that can be done again, as a run
/// that was stopped early leaves it; it counts as absent.
fn is_empty_folder(path: &Path) -> bool {
    std::fs::read_dir(path).is_ok_and(|mut entries| {
        entries.all(|entry| entry.is_ok_and(|entry| entry.file_name() == WORK_FOLDER))
    })
}

/// Writes a result to standard output. A reader that closes the pipe early is no error.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to standard output"),
    }
}

/// Writes a result to a file.
///
/// # Errors
/// The file exists and `force` was not given, it belongs to a project, or it cannot be written.
/// Nothing has been changed then.
pub fn write_file(path: &Path, bytes: &[u8], force: bool) -> anyhow::Result<()> {
    // Without the trial of `refuse_existing`, which lists the folder: a drawn match has thousands
    // of pictures in one, and the write below says itself why it fails.
    if !is_pipe_or_device(path) {
        refuse_to_replace(path, force)?;
    }
    refuse_part_of_project(path)?;
    refuse_document(path)?;
    // A link to a missing file exists for `symlink_metadata`, and is written through. A new file is
    // not replaced if another program makes it after this check: `write_new` refuses it.
    let is_new = !force && std::fs::symlink_metadata(path).is_err();
    let written = if is_new {
        write_new(path, bytes)
    } else {
        write_output(path, bytes)
    };
    if written
        .as_ref()
        .is_err_and(|error| error.kind() == std::io::ErrorKind::AlreadyExists)
    {
        bail!(
            "{} was made by another program meanwhile; give --force to replace it, or another -o",
            path.display()
        );
    }
    written.map_err(|error| {
        anyhow!(
            "cannot write {}: {error}{}",
            path.display(),
            way_out(&error)
        )
    })
}

/// Writes the files of a report into a folder, which is created if necessary.
///
/// # Errors
/// A figure cannot be drawn, or a file exists or cannot be written.
pub fn write_report(report: &Report, folder: &Path, force: bool) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, bytes) in report.files()? {
        write_file(&folder.join(name), &bytes, force)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_exists_is_replaced_only_by_force() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.png");
        write_file(&path, b"first", false).unwrap();
        let refusal = write_file(&path, b"second", false).unwrap_err().to_string();
        assert!(
            refusal
                .ends_with("result.png already exists; give --force to replace it, or another -o"),
            "{refusal}"
        );
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        write_file(&path, b"second", true).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
    }

    #[test]
    fn a_folder_is_refused_where_a_file_is_to_be_written_also_if_it_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        assert!(refuse_existing(folder.path(), false).is_ok());
        for force in [false, true] {
            let refused = refuse_existing_file(folder.path(), force);
            let refused = refused.unwrap_err().to_string();
            assert!(
                refused.ends_with("is a folder; give the name of a file"),
                "{refused}"
            );
        }
        let file = folder.path().join("forest.tlf");
        assert!(refuse_existing_file(&file, false).is_ok());
    }

    #[test]
    fn a_folder_that_is_missing_is_named() {
        let error = write_file(Path::new("/no/such/folder/a.png"), b"", false).unwrap_err();
        assert!(
            format!("{error:#}").starts_with("cannot write /no/such/folder/a.png: "),
            "{error:#}"
        );
    }
}
