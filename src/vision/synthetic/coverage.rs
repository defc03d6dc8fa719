//! How much of a pixel a strip, a disc or a comb of strips covers: analytic anti-aliasing.

/// The share of a pixel that a strip covers. `offset` is the distance of the pixel's centre from
/// the strip's middle, `half_width` half the strip's width, `pixel` the pixel's extent across the
/// strip, all in one unit.
pub(super) fn strip(offset: f64, half_width: f64, pixel: f64) -> f64 {
    let half_pixel = 0.5 * pixel;
    let overlap = (offset + half_pixel).min(half_width) - (offset - half_pixel).max(-half_width);
    (overlap / pixel).clamp(0.0, 1.0)
}

/// The share of a pixel that lies on the inner side of an edge at signed `distance` (negative
/// inside).
pub(super) fn inside(distance: f32, pixel: f32) -> f32 {
    (0.5 - distance / pixel).clamp(0.0, 1.0)
}

/// The share of a pixel that a comb of strips covers: one strip of `width` centred on each multiple
/// of `spacing`.
pub(super) fn comb(at: f64, spacing: f64, width: f64, pixel: f64) -> f64 {
    // The integral of the comb from 0 to x, evaluated at both ends of the pixel.
    let until = |x: f64| {
        let cell = (x / spacing + 0.5).floor();
        cell * width + (x - cell * spacing).clamp(-0.5 * width, 0.5 * width)
    };
    ((until(at + 0.5 * pixel) - until(at - 0.5 * pixel)) / pixel).clamp(0.0, 1.0)
}

/// The pixels around one that a disc about its centre covers: offsets in columns and rows, and the
/// share of each, which falls over a pixel at the rim.
pub(super) fn disc(radius_px: f32) -> Vec<(i64, i64, f32)> {
    let reach = radius_px.ceil() as i64;
    (-reach..=reach)
        .flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)))
        .map(|(dx, dy)| (dx, dy, radius_px + 0.5 - (dx as f32).hypot(dy as f32)))
        .filter(|(_, _, share)| *share > 0.0)
        .map(|(dx, dy, share)| (dx, dy, share.min(1.0)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_full_in_its_middle_and_has_about_its_area() {
        for radius_px in [1.0_f32, 2.3, 4.0] {
            let shares = disc(radius_px);
            assert!(shares.contains(&(0, 0, 1.0)));
            let area: f32 = shares.iter().map(|(_, _, share)| share).sum();
            let exact = std::f32::consts::PI * radius_px * radius_px;
            assert!((area / exact - 1.0).abs() < 0.15, "{area} for {exact}");
        }
    }

    #[test]
    fn a_strip_keeps_its_area_and_its_middle_wherever_it_falls() {
        for width in [0.2, 1.0, 3.7] {
            for shift in [0.0, 0.13, 0.5, 0.77] {
                let (mut area, mut moment) = (0.0, 0.0);
                for pixel in -20..20 {
                    let centre = f64::from(pixel) + 0.5;
                    let share = strip(centre - shift, 0.5 * width, 1.0);
                    area += share;
                    moment += share * centre;
                }
                assert!((area - width).abs() < 1e-12);
                // A sub-pixel strip is only known to lie in its pixel; wider ones keep their
                // middle.
                let slack = if width < 1.0 { 0.5 } else { 0.2 };
                assert!((moment / area - shift).abs() < slack);
            }
        }
    }

    #[test]
    fn a_comb_covers_width_over_spacing_on_average() {
        for pixel in [0.03, 0.12, 0.5, 2.0] {
            let mean = (0..1000)
                .map(|i| comb(f64::from(i) * 0.0123, 0.12, 0.01, pixel))
                .sum::<f64>()
                / 1000.0;
            assert!((mean - 0.01 / 0.12).abs() < 0.005, "{mean} at {pixel}");
        }
    }
}
