//! Writes labels over a finished picture on the CPU. A window draws them with its own fonts
//! instead.

use super::view::View;
use crate::scene::drawing::{Colour, Label};
use ab_glyph::{Font as _, FontRef, InvalidFont, PxScale, ScaleFont as _, point};
use image::{Rgba, RgbaImage};

/// The typeface of the window.
const TYPEFACE: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// Margin of the plate around the text, as a share of the type's height.
const PADDING: f32 = 0.28;

/// Writes labels over a picture that shows `view`.
///
/// # Errors
/// The built-in typeface cannot be read.
pub(super) fn write_labels<'a>(
    picture: &mut RgbaImage,
    view: &View,
    labels: impl Iterator<Item = &'a Label>,
) -> Result<(), InvalidFont> {
    let font = FontRef::try_from_slice(TYPEFACE)?;
    for label in labels {
        write_label(picture, view, &font, label);
    }
    Ok(())
}

/// Writes one label, moved into the canvas where it would protrude.
fn write_label(picture: &mut RgbaImage, view: &View, font: &FontRef<'_>, label: &Label) {
    let scale = PxScale::from(label.size_pt * view.pixels_per_point);
    let font = font.as_scaled(scale);
    let [x, y] = view.canvas_from_image(label.at);
    let [width, height] = view.size_px.map(|side| side as f32);
    // A label is shown whole if its point is on the canvas, and not at all otherwise.
    if !((0.0..=width).contains(&x) && (0.0..=height).contains(&y)) {
        return;
    }
    // Shift the label so that its plate lies within the canvas.
    // The left and upper borders win where the canvas is too small for it.
    let padding = PADDING * scale.y;
    let text_width: f32 = label
        .text
        .chars()
        .map(|character| font.h_advance(font.glyph_id(character)))
        .sum();
    let left = (x + label.offset_pt[0] * view.pixels_per_point)
        .min(width - padding - text_width)
        .max(padding);
    let half_height = scale.y / 2.0;
    let middle = (y + label.offset_pt[1] * view.pixels_per_point)
        .min(height - half_height)
        .max(half_height);
    let baseline = middle + f32::midpoint(font.ascent(), font.descent());
    // Place the glyphs from left to right, with kerning.
    let mut pen = left;
    let mut outlines = Vec::new();
    let mut previous = None;
    for character in label.text.chars() {
        let id = font.glyph_id(character);
        pen += previous.map_or(0.0, |previous| font.kern(previous, id));
        outlines.extend(
            font.font()
                .outline_glyph(id.with_scale_and_position(scale, point(pen, baseline))),
        );
        pen += font.h_advance(id);
        previous = Some(id);
    }
    // Draw the plate, then the glyphs.
    let (top, bottom) = (baseline - font.ascent(), baseline - font.descent());
    fill_box(
        picture,
        [
            left - padding,
            top - padding / 3.0,
            pen + padding,
            bottom + padding / 3.0,
        ],
        label.plate,
    );
    for outline in outlines {
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, covered| {
            blend(
                picture,
                corner.x + dx as f32,
                corner.y + dy as f32,
                label.colour,
                covered.min(1.0),
            );
        });
    }
}

/// Fills a box (left, top, right, bottom), rounded to whole pixels.
fn fill_box(picture: &mut RgbaImage, [left, top, right, bottom]: [f32; 4], colour: Colour) {
    let columns =
        left.round().max(0.0) as u32..(right.round().max(0.0) as u32).min(picture.width());
    for y in top.round().max(0.0) as u32..(bottom.round().max(0.0) as u32).min(picture.height()) {
        for x in columns.clone() {
            blend(picture, x as f32, y as f32, colour, 1.0);
        }
    }
}

/// Blends a colour over a pixel; does nothing outside the picture.
fn blend(picture: &mut RgbaImage, x: f32, y: f32, colour: Colour, covered: f32) {
    if !(x >= 0.0 && y >= 0.0 && x < picture.width() as f32 && y < picture.height() as f32) {
        return;
    }
    let alpha = covered * f32::from(colour.a) / 255.0;
    let Rgba([r, g, b, a]) = picture.get_pixel_mut(x as u32, y as u32);
    for (channel, over) in [(r, colour.r), (g, colour.g), (b, colour.b), (a, 255)] {
        *channel = (f32::from(over) * alpha + f32::from(*channel) * (1.0 - alpha)).round() as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str, at: [f32; 2]) -> RgbaImage {
        let mut picture = RgbaImage::from_pixel(60, 30, Rgba([0, 0, 0, 255]));
        let label = Label {
            at,
            offset_pt: [4.0, 0.0],
            text: text.to_owned(),
            size_pt: 14.0,
            colour: Colour::rgb(255, 255, 255),
            plate: Colour::rgb(0, 0, 90),
        };
        write_labels(
            &mut picture,
            &View::one_to_one([60, 30]),
            [&label].into_iter(),
        )
        .unwrap();
        picture
    }

    #[test]
    fn a_label_stands_on_its_plate_beside_its_point() {
        let picture = written("cm", [10.0, 15.0]);
        let bright: Vec<(u32, u32)> = picture
            .enumerate_pixels()
            .filter(|(_, _, p)| p.0[0] > 120)
            .map(|(x, y, _)| (x, y))
            .collect();
        assert!(bright.len() > 20, "{} bright pixels", bright.len());
        assert!(
            bright
                .iter()
                .all(|&(x, y)| (13..45).contains(&x) && (8..24).contains(&y)),
            "{bright:?}"
        );
        assert_eq!(
            picture.get_pixel(12, 15).0[2],
            90,
            "the plate begins left of the text"
        );
        assert_eq!(picture.get_pixel(8, 15).0[2], 0);
    }

    #[test]
    fn a_label_at_the_border_is_whole_and_one_of_a_point_outside_is_gone() {
        let bright = |at| {
            written("cm", at)
                .pixels()
                .filter(|pixel| pixel.0[0] > 120)
                .count()
        };
        let whole = bright([10.0, 15.0]);
        for at in [[59.0, 15.0], [0.0, 0.0], [60.0, 30.0]] {
            assert!(
                bright(at).abs_diff(whole) <= 12,
                "{at:?}: {} bright pixels instead of {whole}",
                bright(at)
            );
        }
        for at in [[-500.0, 10.0], [5.0, -3.0], [f32::NAN, 0.0], [1e9, 1e9]] {
            assert_eq!(bright(at), 0, "{at:?}");
        }
    }
}
