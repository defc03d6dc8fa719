//! What lens, shutter and sensor do to the light: vignetting, exposure, blur, tone, noise.

use super::coverage::disc;
use super::light::{Light, encode};
use super::options::FrameOptions;
use super::texture::{hash, sub_seed, unit};
use image::RgbImage;
use rayon::prelude::*;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// A pixel on its way through the camera: red, green, blue in linear light and, fourth, the share
/// that movers cover.
pub(super) type Pixel = nalgebra::Vector4<f32>;

/// A picture in linear light.
#[derive(Clone, Debug)]
pub(super) struct Exposure {
    pub size: ImageSize,
    pub pixels: Vec<Pixel>,
}

impl Exposure {
    fn width(&self) -> usize {
        self.size.width as usize
    }

    /// A pixel; beyond the border that of the border.
    fn at(&self, x: i64, y: i64) -> Pixel {
        let x = x.clamp(0, i64::from(self.size.width) - 1) as usize;
        let y = y.clamp(0, i64::from(self.size.height) - 1) as usize;
        self.pixels[y * self.width() + x]
    }

    /// The light at a point, linear between the centres of the four pixels around it.
    fn bilinear(&self, point: ImagePoint) -> Pixel {
        // Motion blur calls this up to 64 times per pixel, so that pixels inside are not clamped
        // one by one.
        let (x, y) = (point.x - 0.5, point.y - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let (u, v) = ((x - column) as f32, (y - row) as f32);
        let (column, row) = (column as i64, row as i64);
        let width = self.width();
        let inside = column >= 0
            && row >= 0
            && column + 1 < i64::from(self.size.width)
            && row + 1 < i64::from(self.size.height);
        let [upper_left, upper_right, lower_left, lower_right] = if inside {
            let at = row as usize * width + column as usize;
            [
                self.pixels[at],
                self.pixels[at + 1],
                self.pixels[at + width],
                self.pixels[at + width + 1],
            ]
        } else {
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.at(column + dx, row + dy))
        };
        let top = upper_left * (1.0 - u) + upper_right * u;
        let bottom = lower_left * (1.0 - u) + lower_right * u;
        top * (1.0 - v) + bottom * v
    }

    /// Every pixel replaced by what `pixel` says of its column and row.
    fn map_pixels(&self, pixel: impl Fn(usize, usize) -> Pixel + Sync) -> Self {
        let width = self.width();
        let mut pixels = vec![Pixel::zeros(); self.pixels.len()];
        pixels
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, out) in row.iter_mut().enumerate() {
                    *out = pixel(x, y);
                }
            });
        Self {
            size: self.size,
            pixels,
        }
    }

    /// Motion blur. A camera that only rotates and zooms moves the whole picture by a mapping that
    /// does not depend on the depth, so smearing the picture along it is exact for everything that
    /// stands still.
    pub fn with_motion_blur(&self, camera: &PtzCamera, options: &FrameOptions) -> Self {
        // The cameras when the shutter opens and closes; the frame's own is that of mid-exposure.
        // Each comes with the rotation from its axes to those of the frame's camera.
        let ends = [-0.5, 0.5].map(|share| {
            let dt = share * options.shutter_s;
            let (ptz, motion) = (camera.ptz(), options.motion);
            let ptz = Ptz::new(
                ptz.pan + motion.pan_per_s * dt,
                ptz.tilt + motion.tilt_per_s * dt,
                ptz.focal_px * (1.0 + motion.zoom_per_s * dt),
            );
            let end = PtzCamera::new(*camera.base(), ptz);
            (
                end,
                camera.cam_from_base() * end.cam_from_base().transpose(),
            )
        });
        // Where the light of this pixel comes from at an end of the exposure.
        let source = |(end, cam_from_end): &(PtzCamera, Mat3), point: ImagePoint| {
            let ideal = end.cam_plane_from_image(point).ok()?;
            camera
                .image_from_cam(cam_from_end * Vec3::new(ideal.x, ideal.y, 1.0))
                .ok()
        };
        self.map_pixels(|x, y| {
            // A pixel beyond the fold of the lens at one end stays as it is.
            let here = ImagePoint::new(x as f64 + 0.5, y as f64 + 0.5);
            let (Some(from), Some(to)) = (source(&ends[0], here), source(&ends[1], here)) else {
                return self.at(x as i64, y as i64);
            };
            // The way is straight to first order over an exposure. A sample per px of it leaves no
            // gaps; 64 bound the time for a whip pan.
            let way = to.offset_from(from);
            let taps = way.norm().ceil().clamp(1.0, 64.0) as usize;
            let at = |tap: usize| {
                self.bilinear(from.translate(way * ((tap as f64 + 0.5) / taps as f64)))
            };
            (0..taps).map(at).sum::<Pixel>() / taps as f32
        })
    }

    /// Defocus: the mean over a disc.
    pub fn with_defocus(&self, radius_px: f64) -> Self {
        let reach = radius_px.ceil() as i64;
        let disc = disc(radius_px as f32);
        let total: f32 = disc.iter().map(|(_, _, share)| share).sum();
        let (width, height) = (i64::from(self.size.width), i64::from(self.size.height));
        // Away from the border the disc is a list of offsets in memory, without clamping.
        let offsets: Vec<(i64, f32)> = disc
            .iter()
            .map(|(dx, dy, share)| (dy * width + dx, *share))
            .collect();
        self.map_pixels(|x, y| {
            let (x, y) = (x as i64, y as i64);
            if x >= reach && y >= reach && x + reach < width && y + reach < height {
                let here = y * width + x;
                let lit = offsets
                    .iter()
                    .map(|(offset, share)| self.pixels[(here + offset) as usize] * *share);
                return lit.sum::<Pixel>() / total;
            }
            disc.iter()
                .map(|(dx, dy, share)| self.at(x + dx, y + dy) * *share)
                .sum::<Pixel>()
                / total
        })
    }

    /// Vignetting, exposure, tone, noise and the rounding to bytes.
    pub fn develop(&self, options: &FrameOptions) -> RgbImage {
        // In the order of a camera: the lens loses light towards the corners, exposure scales it,
        // the tone curve and the encoding follow, and noise is added in the levels that its σ
        // states. The loss grows with the squared distance and is `vignetting` in the corner.
        let (width, centre) = (self.width(), self.size.centre());
        let gain = options.exposure_ev.exp2() as f32;
        let corner_squared = centre.x * centre.x + centre.y * centre.y;
        let mut bytes = vec![0; self.pixels.len() * 3];
        bytes
            .par_chunks_mut(width * 3)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, out) in row.chunks_exact_mut(3).enumerate() {
                    let (dx, dy) = (x as f64 + 0.5 - centre.x, y as f64 + 0.5 - centre.y);
                    let loss = options.vignetting * (dx * dx + dy * dy) / corner_squared;
                    let light = self.pixels[y * width + x].xyz() * (gain * (1.0 - loss) as f32);
                    for (channel, byte) in out.iter_mut().enumerate() {
                        let level = 255.0 * encode(tone(light[channel]));
                        let noise = noise(options, x as i32 * 3 + channel as i32, y as i32);
                        *byte = (level + noise).round().clamp(0.0, 255.0) as u8;
                    }
                }
            });
        RgbImage::from_raw(self.size.width, self.size.height, bytes).unwrap_or_default()
    }
}

/// Linear up to two thirds, then a shoulder that never clips hard.
fn tone(light: f32) -> f32 {
    const KNEE: f32 = 0.66;
    if light <= KNEE {
        light
    } else {
        KNEE + (1.0 - KNEE) * (1.0 - (-(light - KNEE) / (1.0 - KNEE)).exp())
    }
}

/// Gaussian noise of one channel of one pixel, in levels (Box–Muller on two hashes).
fn noise(options: &FrameOptions, x: i32, y: i32) -> f32 {
    if options.noise_levels == 0.0 {
        return 0.0;
    }
    // Hashed by place, so that the noise does not depend on which thread draws a row. The lower
    // bound keeps the logarithm finite.
    let seed = sub_seed(options.noise_seed, 0x4015);
    let draw = hash(seed, x, y);
    let (a, b) = (unit(draw).max(1e-7), unit(hash(draw, y, x)));
    options.noise_levels as f32 * (-2.0 * a.ln()).sqrt() * (std::f32::consts::TAU * b).cos()
}

/// The light of a pixel without movers.
pub(super) fn still(light: Light) -> Pixel {
    Pixel::new(light.x, light.y, light.z, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_sigma_it_says() {
        let options = FrameOptions {
            noise_levels: 3.0,
            noise_seed: 9,
            ..FrameOptions::default()
        };
        let draws: Vec<f64> = (0..40_000)
            .map(|i| f64::from(noise(&options, i % 200, i / 200)))
            .collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / draws.len() as f64;
        assert!(
            mean.abs() < 0.06 && (variance.sqrt() - 3.0).abs() < 0.05,
            "{mean} ± {}",
            variance.sqrt()
        );
    }

    #[test]
    fn defocus_keeps_the_light_and_spreads_it() {
        let mut exposure = Exposure {
            size: ImageSize::new(21, 21),
            pixels: vec![Pixel::zeros(); 441],
        };
        exposure.pixels[10 * 21 + 10] = Pixel::repeat(1.0);
        let blurred = exposure.with_defocus(2.3);
        let sum: f32 = blurred.pixels.iter().map(|pixel| pixel.x).sum();
        assert!((sum - 1.0).abs() < 1e-5 && blurred.pixels[10 * 21 + 10].x < 0.1);
    }
}
