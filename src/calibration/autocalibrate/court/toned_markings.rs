//! The paint of a court whose lines differ in tone: white ones on a dark area, dark ones on wood,
//! and boundaries where one colour meets another without a line.
//!
//! Each line has one tone in all pictures, which is not known. It is the one that says most for it,
//! at the price of having chosen. What is bright and lies on no line is foreign paint; dark seams
//! and borders of areas are not.

use crate::evidence::Evidence;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_vision::paint::{GroundPicture, MarkingPixels, Tone};

/// The price of a line that is not bright, nats: one tone of three.
const NATS_OF_CHOICE: f64 = 1.1;

/// The marking pixels of a picture of a court, by their tone.
pub struct TonedMarkings {
    pub bright: MarkingPixels,
    dark: MarkingPixels,
    borders: MarkingPixels,
}

impl TonedMarkings {
    pub fn detect(ground: &GroundPicture, field: &FieldModel, camera: &PtzCamera) -> Self {
        let tones = [Tone::Bright, Tone::Dark, Tone::Border];
        let [bright, dark, borders] = MarkingPixels::on_court(ground, field, camera, tones);
        Self {
            bright,
            dark,
            borders,
        }
    }
}

/// Weighs the cameras of some pictures, with each line in the tone that says most for it.
pub fn weigh_tones(field: &FieldModel, pictures: &[(PtzCamera, TonedMarkings)]) -> Evidence {
    let weigh = |of_tone: fn(&TonedMarkings) -> &MarkingPixels| {
        let pictures: Vec<(PtzCamera, &MarkingPixels)> = pictures
            .iter()
            .map(|(camera, markings)| (*camera, of_tone(markings)))
            .collect();
        Evidence::weigh(field, &pictures)
    };
    let mut evidence = weigh(|markings| &markings.bright);
    for other in [
        weigh(|markings| &markings.dark),
        weigh(|markings| &markings.borders),
    ] {
        for (nats, other) in evidence.of_lines.iter_mut().zip(other.of_lines) {
            *nats = nats.max(other - NATS_OF_CHOICE);
        }
    }
    evidence
}
