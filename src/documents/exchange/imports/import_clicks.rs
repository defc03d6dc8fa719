//! Import of points from other annotation tools as a document.

use super::imported::Imported;
use super::pictures::{image_of, refuse_shared_pictures};
use crate::document::{
    Click, ClickOrigin, Document, Frame, FrameStatus, MAX_CLICKS, Target, path_between,
};
use crate::exchange::cameras::into_document::Cameras;
use crate::exchange::cameras::picture_size::{FittedSizes, has_same_proportions};
use crate::exchange::click_formats::clicked_frame::{
    ClickFormat, LabelReading, LabelledFrame, Mark, read_labels,
};
use crate::exchange::click_formats::labels::{Meaning, describe_counts};
use crate::exchange::click_formats::point_sigma::sigma_by_probability_px;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, no_files};
use crate::exchange::format::Format;
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::values::shorten;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox, pluralise};

/// The maximum distance of a point from the picture's corner, px. A picture has at most 65,535 px a
/// side, so that a point this far away is a mistake, not one dragged beyond the border.
const FARTHEST_PX: f64 = 1e6;

/// Reads a file or folder of clicks as a document of drafts.
///
/// # Errors
/// It cannot be read, is damaged, or has labels that mean nothing.
pub fn import_clicks(
    path: &Path,
    folder: &Path,
    format: Format,
    click_format: &dyn ClickFormat,
    options: &ImportOptions,
) -> Result<Imported, ExchangeError> {
    let files = Files::read_some(
        path,
        &|name| click_format.is_wanted(name),
        click_format.about().files,
    )?;
    let images = options.images_folder(folder);
    // Some formats state points as shares of the picture, so that its size is needed to read them.
    let reading = LabelReading {
        options: &options.with_any_size(),
        sizes: &|name| match options.stretched_from {
            None => image_of(name, &images).1,
            // Pictures in their own proportion do not say the size that the labels are in; shares
            // are the same in any.
            Some(size) if click_format.has_shares_alone() => Some(size),
            Some(_) => options.size,
        },
    };
    let (mut frames, unread) = read_labels(click_format, &files, &reading)?;
    if frames.is_empty() {
        return Err(no_files(path, "frame"));
    }
    refuse_damaged(&frames, path)?;
    let (read, mut rescaled) = (frames.len(), FittedSizes::default());
    for frame in &mut frames {
        let named = frame.image.as_deref().unwrap_or(&frame.name);
        if image_of(named, &images).1.is_none() {
            fit_to_options(frame, options, &mut rescaled)?;
        }
        if let Some(size) = options.stretched_from {
            unstretch(frame, size, &images)?;
        }
    }
    let field = options.field.model(folder)?;
    // A user's map is for labels that people chose; classes of a challenge mean the same for
    // everybody.
    let labels = if click_format.has_own_classes() {
        click_format.own_labels()
    } else {
        options.map.clone()
    };
    labels.refuse_other_numbering(&frames)?;
    let mut document = Document::new(options.field.clone());
    // Labels without a meaning are counted over all frames before the import fails, so that one
    // error names everything that the map must have.
    let mut unmapped: BTreeMap<String, usize> = BTreeMap::new();
    let mut twice: BTreeMap<String, usize> = BTreeMap::new();
    let mut improbable = 0;
    for frame in frames {
        let mut clicks = Vec::new();
        for mark in &frame.marks {
            if is_improbable(mark, options) {
                improbable += 1;
                continue;
            }
            match labels.meaning(&mark.label, &field)? {
                Meaning::Target(target) => clicks.push(click_of(mark, target, &frame, options)),
                Meaning::Nothing => {}
                Meaning::Unknown => *unmapped.entry(mark.label.clone()).or_default() += 1,
            }
        }
        if options.model.is_some() {
            keep_most_probable(&mut clicks);
        } else {
            drop_repeated_landmarks(&mut clicks, &mut twice);
        }
        document.frames.push(
            frame_of(
                &frame,
                clicks,
                &mut Cameras(&mut document.cameras),
                folder,
                &images,
            )
            .into(),
        );
    }
    refuse_shared_pictures(&document, path)?;
    let mut notes: Vec<String> = rescaled.note("frame").into_iter().collect();
    if !unmapped.is_empty() {
        if !options.skip_unmapped {
            return Err(ExchangeError::Unmapped {
                labels: describe_counts(&unmapped),
                format,
            });
        }
        notes.push(format!(
            "left out without meaning: {}",
            describe_counts(&unmapped)
        ));
    }
    if improbable > 0 {
        let count = pluralise(improbable, "point");
        notes.push(format!("{count} below --min-probability left out"));
    }
    notes.extend(note_repeated(&twice));
    notes.extend(field_size_note(&field));
    Ok(Imported {
        document,
        folder: folder.to_path_buf(),
        format,
        notes,
        failures: unread.describe(read).into_iter().collect(),
    })
}

/// Whether a model thinks too little of a point.
fn is_improbable(mark: &Mark, options: &ImportOptions) -> bool {
    let least = options.model.as_ref().map(|model| model.min_probability);
    least
        .zip(mark.probability)
        .is_some_and(|(least, probability)| probability < least)
}

/// The click of a mark: a person's, or a point of the model of the options.
fn click_of(mark: &Mark, target: Target, frame: &LabelledFrame, options: &ImportOptions) -> Click {
    let by_probability = mark
        .probability
        .map(|probability| sigma_by_probability_px(probability, frame.size));
    let origin = options.model.as_ref().map(|model| ClickOrigin {
        label: Some(mark.label.clone()),
        probability: mark.probability,
        sigma_px: mark.sigma_px.or(by_probability),
        ..ClickOrigin::from_model(&model.name)
    });
    Click {
        origin: origin.map(Box::new),
        ..Click::new(target, mark.image)
    }
}

/// Keeps one of the points that a model gives of a landmark: the most probable, of equal ones the
/// first. A line keeps all its points.
fn keep_most_probable(clicks: &mut Vec<Click>) {
    let probability = |click: &Click| {
        let origin = click.origin.as_ref();
        origin.and_then(|origin| origin.probability).unwrap_or(1.0)
    };
    let mut best: BTreeMap<Target, (usize, f64)> = BTreeMap::new();
    for (index, click) in clicks.iter().enumerate() {
        if let Some(target) = click
            .target
            .clone()
            .filter(|target| target.line().is_none())
        {
            let here = (index, probability(click));
            let known = best.entry(target).or_insert(here);
            if here.1 > known.1 {
                *known = here;
            }
        }
    }
    let best: BTreeSet<usize> = best.into_values().map(|(index, _)| index).collect();
    let mut index = 0..;
    clicks.retain(|click| {
        let here = index.next();
        click.is_on_line() || here.is_some_and(|here| best.contains(&here))
    });
}

/// Rescales a frame whose picture is not there to the size that the user gave, or to that of the
/// video that the frames may be attached to.
///
/// # Errors
/// The size that the user gave has other proportions.
fn fit_to_options(
    frame: &mut LabelledFrame,
    options: &ImportOptions,
    rescaled: &mut FittedSizes,
) -> Result<(), ExchangeError> {
    let Some(size) = options.picture_size() else {
        return Ok(());
    };
    let stated = frame.size;
    if stated == size {
        return Ok(());
    }
    if !has_same_proportions(stated, size) {
        // A video of other proportions is not that of these labels, which the attachment says.
        return match options.size {
            None => Ok(()),
            Some(_) => Err(ExchangeError::OtherProportions {
                what: "the labels",
                frame: shorten(&frame.name),
                stated,
                picture: size,
            }),
        };
    }
    let factor = f64::from(size.width) / f64::from(stated.width);
    for mark in &mut frame.marks {
        mark.image = ImagePoint::new(mark.image.x * factor, mark.image.y * factor);
        mark.sigma_px = mark.sigma_px.map(|sigma_px| sigma_px * factor);
    }
    for mask in &mut frame.masks {
        *mask = mask.scale_by(factor);
    }
    frame.size = size;
    rescaled.count(stated, size);
    Ok(())
}

/// Moves the points of a frame to where its picture showed them before it was stretched.
///
/// # Errors
/// The picture that is there is stretched as the labels are.
fn unstretch(
    frame: &mut LabelledFrame,
    size: ImageSize,
    images: &Path,
) -> Result<(), ExchangeError> {
    let stretched = frame.size;
    let named = frame.image.as_deref().unwrap_or(&frame.name);
    if stretched != size && image_of(named, images).1 == Some(stretched) {
        return Err(ExchangeError::StretchedPicture {
            frame: shorten(named),
            folder: images.to_path_buf(),
            stretched,
            size,
        });
    }
    let wider = f64::from(size.width) / f64::from(stretched.width);
    let higher = f64::from(size.height) / f64::from(stretched.height);
    for mark in &mut frame.marks {
        mark.image = ImagePoint::new(mark.image.x * wider, mark.image.y * higher);
    }
    for mask in &mut frame.masks {
        *mask = PixelBox::new(
            mask.x * wider,
            mask.y * higher,
            mask.width * wider,
            mask.height * higher,
        );
    }
    frame.size = size;
    Ok(())
}

/// Rejects a duplicate picture, and points far outside their picture.
fn refuse_damaged(frames: &[LabelledFrame], path: &Path) -> Result<(), ExchangeError> {
    let mut names = BTreeSet::new();
    for frame in frames {
        // The same picture in two files would be two frames of the document, each with half of the
        // clicks.
        let name = frame.image.as_ref().unwrap_or(&frame.name);
        if !names.insert(name) {
            return Err(ExchangeError::SameFrame {
                path: path.to_path_buf(),
                name: shorten(name),
            });
        }
        if frame.marks.len() > MAX_CLICKS {
            let (path, frame, found) = (path.to_path_buf(), shorten(name), frame.marks.len());
            return Err(ExchangeError::TooManyPoints {
                path,
                frame,
                found,
                limit: MAX_CLICKS,
            });
        }
        if let Some(mark) = frame.marks.iter().find(|mark| !is_near(mark)) {
            return Err(ExchangeError::NoPlace {
                path: path.to_path_buf(),
                frame: shorten(name),
                label: shorten(&mark.label),
                x: mark.image.x,
                y: mark.image.y,
            });
        }
    }
    Ok(())
}

/// Whether a point is near enough to its picture to be meant.
fn is_near(mark: &Mark) -> bool {
    mark.image.x.abs() <= FARTHEST_PX && mark.image.y.abs() <= FARTHEST_PX
}

/// The note about a field of unconfirmed size.
fn field_size_note(field: &FieldModel) -> Option<String> {
    (field.template == "soccer").then(|| {
        format!(
            "the field is taken as {} × {} m; --set length_m=… and width_m=… give another",
            field.length_m, field.width_m
        )
    })
}

/// The note about landmarks that occur twice; none where there is none.
pub fn note_repeated(twice: &BTreeMap<String, usize>) -> Option<String> {
    (!twice.is_empty()).then(|| {
        format!(
            "left out because a frame has them more than once: {}",
            describe_counts(twice)
        )
    })
}

/// Drops all clicks on a landmark that occurs twice, because it is unknown which one is right. A
/// line keeps all its clicks.
pub fn drop_repeated_landmarks(clicks: &mut Vec<Click>, twice: &mut BTreeMap<String, usize>) {
    // Points of a line may lie anywhere on it, so that several are no contradiction.
    let mut counts: BTreeMap<Target, usize> = BTreeMap::new();
    for target in clicks.iter().filter_map(|click| click.target.clone()) {
        *counts.entry(target).or_default() += 1;
    }
    counts.retain(|target, count| target.line().is_none() && *count > 1);
    for (target, count) in &counts {
        *twice.entry(target.as_str().to_owned()).or_default() += count;
    }
    clicks.retain(|click| {
        click
            .target
            .as_ref()
            .is_none_or(|target| !counts.contains_key(target))
    });
}

fn frame_of(
    frame: &LabelledFrame,
    clicks: Vec<Click>,
    cameras: &mut Cameras<'_>,
    folder: &Path,
    images: &Path,
) -> Frame {
    let named = frame.image.as_deref().unwrap_or(&frame.name);
    let path = path_between(folder, &images.join(image_of(named, images).0));
    // A frame that was opened in the other tool and got no point counts as not begun, and so does
    // one with points of a model alone.
    let status = if clicks.iter().all(Click::is_by_model) {
        FrameStatus::New
    } else {
        FrameStatus::Draft
    };
    Frame {
        status,
        clicks,
        masks: frame.masks.clone(),
        ..Frame::from_image(&path, cameras.find_or_add(frame.size), frame.size)
    }
}
