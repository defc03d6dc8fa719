//! Matches the frames of two documents.

use std::collections::BTreeMap;
use std::path::Path;
use touchline_documents::document::{DocumentAt, Frame, resolve_path};

/// For each frame of `wanted`, the frame of `offered` that shows the same picture, if there is one.
///
/// Frames are identified by the location of their image or video, else by the image's SHA-256, else
/// by the path as the document writes it (for a project that was moved), else by the file's name
/// alone. A frame that has both an image and a video is identified by its image, and by its video
/// where the other document has that alone. The first identity that is unique in both documents
/// decides; a frame is matched only once. Frames with different SHA-256 never match, because names
/// recur from match to match.
pub(super) fn match_frames(wanted: DocumentAt<'_>, offered: DocumentAt<'_>) -> Vec<Option<usize>> {
    let mut partners = vec![None; wanted.frames.len()];
    // A frame that a stronger identity has matched takes no part in the weaker ones.
    let mut given = vec![false; offered.frames.len()];
    let identities = [
        by_place,
        by_video,
        by_digest,
        by_path,
        by_name,
        by_video_name,
    ];
    for identity in identities {
        let open = index_by(identity, offered, |index| !given[index]);
        let by_key = index_by(identity, wanted, |index| partners[index].is_none());
        // Match keys with exactly one frame on either side. Ambiguous ones are left to the next
        // identity, which may separate them: a guess would compare a camera with that of another
        // picture.
        for (key, asking) in by_key {
            if let ([asking], Some([partner])) = (&asking[..], open.get(&key).map(Vec::as_slice))
                && may_be_same_picture(&wanted.frames[*asking], &offered.frames[*partner])
            {
                partners[*asking] = Some(*partner);
                given[*partner] = true;
            }
        }
    }
    partners
}

/// The indices of those frames of a document that are open, by what identifies them.
fn index_by(
    identity: fn(&Frame, &Path) -> Option<String>,
    document: DocumentAt<'_>,
    is_open: impl Fn(usize) -> bool,
) -> BTreeMap<String, Vec<usize>> {
    let mut by_key: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, frame) in document.frames.iter().enumerate() {
        if is_open(index)
            && let Some(key) = identity(frame, document.folder)
        {
            by_key.entry(key).or_default().push(index);
        }
    }
    by_key
}

/// Whether two frames may show the same picture: their SHA-256 and what their videos are recognised
/// by are equal, or one is not stated.
fn may_be_same_picture(a: &Frame, b: &Frame) -> bool {
    let videos = a.video.as_ref().zip(b.video.as_ref());
    if videos.is_some_and(|(a, b)| a.is_of_other_file(b.file_id.as_deref())) {
        return false;
    }
    a.sha256
        .as_ref()
        .zip(b.sha256.as_ref())
        .is_none_or(|(a, b)| a.eq_ignore_ascii_case(b))
}

/// The absolute location of the image, or of the video with the frame's number.
fn by_place(frame: &Frame, folder: &Path) -> Option<String> {
    let Some(image) = &frame.image else {
        return by_video(frame, folder);
    };
    let path = resolve_path(&folder.join(image));
    Some(path.to_string_lossy().into_owned())
}

/// The absolute location of the video with the frame's number.
fn by_video(frame: &Frame, folder: &Path) -> Option<String> {
    let video = frame.video.as_ref()?;
    let path = resolve_path(&folder.join(&video.path));
    Some(format!("{}#{}", path.to_string_lossy(), video.frame_index))
}

/// The image's SHA-256 in small letters, if stated: programs write its digits in either case.
fn by_digest(frame: &Frame, _: &Path) -> Option<String> {
    frame.sha256.as_deref().map(str::to_ascii_lowercase)
}

/// The path as written in the document.
fn by_path(frame: &Frame, _: &Path) -> Option<String> {
    (frame.image.is_some() || frame.video.is_some()).then(|| frame.name())
}

/// The file's name without its folder, with the frame's number for a video.
fn by_name(frame: &Frame, folder: &Path) -> Option<String> {
    match &frame.image {
        Some(image) => file_name(image),
        None => by_video_name(frame, folder),
    }
}

/// The name of the video's file with the frame's number.
fn by_video_name(frame: &Frame, _: &Path) -> Option<String> {
    let video = frame.video.as_ref()?;
    Some(format!("{}#{}", file_name(&video.path)?, video.frame_index))
}

fn file_name(path: &str) -> Option<String> {
    Path::new(path)
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Document, VideoFrame};
    use touchline_documents::testing::{new_frame, soccer_document};

    fn document(images: &[&str]) -> Document {
        let mut document = soccer_document();
        let size = ImageSize::new(64, 48);
        document
            .frames
            .extend(images.iter().map(|image| new_frame(image, size).into()));
        document
    }

    #[test]
    fn frames_meet_by_place_then_digest_then_path_then_name() {
        let (a, b) = (Path::new("/no/a"), Path::new("/no/b"));
        // By location: the same file, referenced from two folders.
        let one = document(&["1.jpg", "../b/2.jpg"]);
        let other = document(&["2.jpg", "../a/1.jpg"]);
        assert_eq!(match_frames(one.at(a), other.at(b)), [Some(1), Some(0)]);
        // By digest: a renamed file.
        let (mut one, mut other) = (document(&["1.jpg"]), document(&["x.jpg", "y.jpg"]));
        one.frames[0].sha256 = Some("ab".to_owned());
        for stated in ["ab", "AB"] {
            other.frames[1].sha256 = Some(stated.to_owned());
            assert_eq!(match_frames(one.at(a), other.at(b)), [Some(1)]);
        }
        // Another match with the same names.
        other.frames[0].sha256 = Some("cd".to_owned());
        other.frames[1].sha256 = None;
        other.frames[0].image = Some("1.jpg".to_owned());
        assert_eq!(match_frames(one.at(a), other.at(b)), [None]);
        other.frames[0].sha256 = Some("AB".to_owned());
        assert_eq!(match_frames(one.at(a), other.at(b)), [Some(0)]);
        // By path as written: a copy of the project.
        let one = document(&["images/1.jpg", "more/1.jpg"]);
        assert_eq!(
            match_frames(one.at(a), document(&["more/1.jpg", "images/1.jpg"]).at(b)),
            [Some(1), Some(0)]
        );
        // By name, if only one file has it.
        assert_eq!(
            match_frames(one.at(a), document(&["1.jpg"]).at(b)),
            [None, None]
        );
        assert_eq!(
            match_frames(
                document(&["images/7.jpg"]).at(a),
                document(&["7.jpg"]).at(b)
            ),
            [Some(0)]
        );
    }

    #[test]
    fn a_video_frame_is_its_video_and_number() {
        let mut one = soccer_document();
        for frame_index in [4, 5] {
            let video = VideoFrame::new("match.mp4", frame_index, None);
            one.frames
                .push(Frame::from_video(video, "main".into(), ImageSize::new(64, 48)).into());
        }
        let mut other = one.clone();
        other.frames.remove(0);
        assert_eq!(
            match_frames(one.at(Path::new("/no/a")), other.at(Path::new("/no/a"))),
            [None, Some(0)]
        );
        assert_eq!(
            match_frames(one.at(Path::new("/no/a")), other.at(Path::new("/no/b"))),
            [None, Some(0)]
        );
        // One document has the frames as images, too.
        for frame in &mut one.frames {
            frame.image = frame
                .video
                .as_ref()
                .map(|video| format!("{}.jpg", video.frame_index));
        }
        for folder in ["/no/a", "/no/b"] {
            assert_eq!(
                match_frames(one.at(Path::new("/no/a")), other.at(Path::new(folder))),
                [None, Some(0)]
            );
        }
    }
}
