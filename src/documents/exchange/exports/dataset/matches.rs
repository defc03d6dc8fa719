//! The names of the matches of a dataset, without the location of files on this machine.

use super::split::match_of;
use crate::document::Frame;
use std::collections::{BTreeMap, BTreeSet};

/// Names of matches by their keys in the document: the shortest unique suffix of the path.
pub fn match_names<'a>(frames: impl Iterator<Item = &'a Frame>) -> BTreeMap<String, String> {
    let paths: BTreeSet<String> = frames.map(match_of).collect();
    let parts: Vec<Vec<&str>> = paths.iter().map(|path| parts(path)).collect();
    let mut taken = BTreeSet::new();
    let mut names = BTreeMap::new();
    for (path, own) in paths.iter().zip(&parts) {
        // As few folders from the end as tell the match from all others: the rest says where files
        // lie on this machine.
        let count = (1..own.len())
            .find(|count| is_unique(last(own, *count), &parts))
            .unwrap_or(own.len());
        let name = last(own, count).join("/");
        // For paths that differ only above the document's folder.
        let numbered =
            (2_usize..).map(|number| format!("{name} ({number})").trim_start().to_owned());
        let free = std::iter::once(name.clone())
            .chain(numbered)
            .find(|name| taken.insert(name.clone()));
        names.insert(path.clone(), free.unwrap_or_default());
    }
    names
}

/// Whether at most one of the paths ends in these parts.
fn is_unique(suffix: &[&str], paths: &[Vec<&str>]) -> bool {
    let same = paths
        .iter()
        .filter(|path| last(path, suffix.len()) == suffix);
    same.count() < 2
}

fn parts(path: &str) -> Vec<&str> {
    path.split(['/', '\\'])
        .filter(|part| !matches!(*part, "" | "." | ".."))
        .collect()
}

/// The last parts of a path.
fn last<'a>(parts: &'a [&'a str], count: usize) -> &'a [&'a str] {
    &parts[parts.len().saturating_sub(count)..]
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    fn named(images: &[&str]) -> Vec<String> {
        let frames: Vec<Frame> = images
            .iter()
            .map(|image| Frame::from_image(image, "main".into(), ImageSize::new(64, 36)))
            .collect();
        let names = match_names(frames.iter());
        frames
            .iter()
            .map(|frame| names[&match_of(frame)].clone())
            .collect()
    }

    #[test]
    fn a_match_has_as_short_a_name_as_tells_it_from_the_others() {
        assert_eq!(
            named(&["../../home/me/final/1.jpg", "../../home/me/final/2.jpg"]),
            ["final", "final"]
        );
        assert_eq!(
            named(&["/a/final/images/1.jpg", "/a/semi/images/1.jpg"]),
            ["final/images", "semi/images"]
        );
        assert_eq!(
            named(&["1.jpg", "images/1.jpg", "b/images/1.jpg"]),
            ["", "images", "b/images"]
        );
        assert_eq!(named(&["../a/1.jpg", "a/1.jpg"]), ["a", "a (2)"]);
        assert_eq!(named(&["../1.jpg", "1.jpg"]), ["(2)", ""]);
    }

    #[test]
    fn a_folder_is_one_match_however_it_is_written() {
        assert_eq!(named(&["1.jpg", "./2.jpg"]), ["", ""]);
        assert_eq!(named(&["a/1.jpg", "./a/2.jpg", "a/./3.jpg"]), ["a"; 3]);
    }
}
