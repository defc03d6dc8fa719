//! Colours for the field's lines over a picture, and on which grounds people with any kind of
//! colour vision can see them.

/// What a sport is played on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Grass.
    Turf,
    /// Planks, or a floor of their colour.
    Wood,
    Ice,
    /// A painted court: blue, green or clay.
    Painted,
}

/// A colour for lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineColour {
    /// Name for the user.
    pub name: &'static str,
    /// Red, green, blue, 0–255.
    pub rgb: [u8; 3],
    /// The grounds on which people with any kind of colour vision can distinguish it.
    pub safe_on: &'static [Ground],
}

/// The colours that are the default of a sport.
const YELLOW: [u8; 3] = [255, 221, 64];
const CYAN: [u8; 3] = [90, 225, 255];
const ORANGE: [u8; 3] = [255, 150, 60];

/// The colours that a user can choose.
pub const LINE_COLOURS: [LineColour; 10] = [
    line_colour("Yellow", YELLOW, &[Ground::Turf, Ground::Painted]),
    line_colour("Cyan", CYAN, &[Ground::Turf, Ground::Wood, Ground::Painted]),
    line_colour("Pink", [255, 120, 220], &[Ground::Turf]),
    line_colour("White", [255, 255, 255], &[Ground::Turf, Ground::Painted]),
    line_colour("Magenta", [214, 40, 190], &[Ground::Turf, Ground::Ice]),
    line_colour("Orange", ORANGE, &[Ground::Ice]),
    line_colour("Lime", [170, 255, 90], &[Ground::Painted]),
    line_colour("Sky blue", [86, 180, 233], &[Ground::Wood]),
    line_colour("Deep blue", [0, 114, 178], &[Ground::Wood, Ground::Ice]),
    line_colour("Vermilion", [213, 94, 0], &[Ground::Ice]),
];

const fn line_colour(name: &'static str, rgb: [u8; 3], safe_on: &'static [Ground]) -> LineColour {
    LineColour { name, rgb, safe_on }
}

/// A sport and the default colour of its lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sport {
    /// Prefix of the names of its field templates, and its key in the settings.
    pub id: &'static str,
    /// Name for the user.
    pub name: &'static str,
    /// What it is played on.
    pub ground: Ground,
    /// Default colour of its lines: red, green, blue, 0–255.
    pub colour: [u8; 3],
}

/// All sports whose lines have a colour of their own.
pub const SPORTS: [Sport; 8] = [
    sport("soccer", "Soccer", Ground::Turf, YELLOW),
    sport(
        "american_football",
        "American football",
        Ground::Turf,
        YELLOW,
    ),
    sport("basketball", "Basketball", Ground::Wood, CYAN),
    sport("handball", "Handball", Ground::Wood, CYAN),
    sport("volleyball", "Volleyball", Ground::Wood, CYAN),
    sport("futsal", "Futsal", Ground::Wood, CYAN),
    sport("ice_hockey", "Ice hockey", Ground::Ice, ORANGE),
    sport("tennis", "Tennis", Ground::Painted, YELLOW),
];

/// Field templates whose lines have the colour of another sport on a like ground.
const COLOURED_ALIKE: [(&str, &str); 7] = [
    ("badminton", "tennis"),
    ("pickleball", "tennis"),
    ("padel", "tennis"),
    ("beach_volleyball", "volleyball"),
    ("field_hockey", "soccer"),
    ("rugby_union", "soccer"),
    ("squash", "basketball"),
];

const fn sport(id: &'static str, name: &'static str, ground: Ground, colour: [u8; 3]) -> Sport {
    Sport {
        id,
        name,
        ground,
        colour,
    }
}

impl Sport {
    /// The sport that gives the lines of a built-in field template their colour. `None` for a
    /// user's own template.
    pub fn from_template(template: &str) -> Option<&'static Self> {
        let alike = COLOURED_ALIKE.iter().find(|(other, _)| *other == template);
        let template = alike.map_or(template, |(_, sport)| sport);
        SPORTS.iter().find(|sport| {
            template
                .strip_prefix(sport.id)
                .is_some_and(|rules| rules.is_empty() || rules.starts_with('_'))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::field::builtin_names;

    /// Typical colours of grounds in camera pictures.
    const GROUNDS: [(Ground, &[[u8; 3]]); 4] = [
        (Ground::Turf, &[[62, 118, 66], [110, 150, 80], [45, 85, 40]]),
        (
            Ground::Wood,
            &[[200, 160, 110], [165, 115, 70], [222, 184, 135]],
        ),
        (Ground::Ice, &[[235, 240, 245], [215, 225, 235]]),
        (
            Ground::Painted,
            &[[60, 100, 160], [70, 120, 90], [180, 90, 60]],
        ),
    ];
    /// Minimum difference (CIE 1976 ΔE) at which colours in a thin line are distinguishable.
    const MIN_DIFFERENCE: f64 = 40.0;
    /// Colour visions: normal, then protanopia, deuteranopia and tritanopia as matrices of linear
    /// RGB (Machado, Oliveira and Fernandes 2009, severity 1).
    const VISIONS: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ];

    fn lab(colour: [u8; 3], vision: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = colour.map(|value| {
            let value = f64::from(value) / 255.0;
            if value <= 0.04045 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        });
        let mixed = |weights: &[f64; 3]| {
            weights
                .iter()
                .zip(linear)
                .map(|(weight, value)| weight * value)
                .sum::<f64>()
        };
        let seen = [mixed(&vision[0]), mixed(&vision[1]), mixed(&vision[2])]
            .map(|value| value.clamp(0.0, 1.0));
        let xyz = [
            (0.4124 * seen[0] + 0.3576 * seen[1] + 0.1805 * seen[2]) / 0.9505,
            0.2126 * seen[0] + 0.7152 * seen[1] + 0.0722 * seen[2],
            (0.0193 * seen[0] + 0.1192 * seen[1] + 0.9505 * seen[2]) / 1.089,
        ];
        let [x, y, z] = xyz.map(|t| {
            if t > 0.008_856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// The difference of two colours for the colour vision that distinguishes them least.
    fn apart(one: [u8; 3], other: [u8; 3]) -> f64 {
        let distance = |vision: &[[f64; 3]; 3]| {
            let (one, other) = (lab(one, vision), lab(other, vision));
            one.iter()
                .zip(other)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        VISIONS.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_colour_is_called_safe_exactly_if_every_colour_vision_distinguishes_it_from_the_ground() {
        for colour in LINE_COLOURS {
            for (ground, shades) in GROUNDS {
                let least = shades
                    .iter()
                    .map(|shade| apart(colour.rgb, *shade))
                    .fold(f64::INFINITY, f64::min);
                assert_eq!(
                    colour.safe_on.contains(&ground),
                    least >= MIN_DIFFERENCE,
                    "{} on {ground:?}: {least:.1}",
                    colour.name
                );
            }
        }
    }

    #[test]
    fn every_template_has_a_sport_whose_own_colour_is_safe_on_its_ground() {
        for template in builtin_names() {
            assert!(Sport::from_template(template).is_some(), "{template}");
        }
        assert_eq!(Sport::from_template("soccerish"), None);
        for sport in SPORTS {
            let colour = LINE_COLOURS
                .iter()
                .find(|colour| colour.rgb == sport.colour);
            assert!(
                colour.is_some_and(|colour| colour.safe_on.contains(&sport.ground)),
                "{} {colour:?}",
                sport.name
            );
        }
    }
}
