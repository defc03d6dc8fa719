//! Gestures of a mouse wheel or of two fingers on a touch pad.

use egui::{Event, MouseWheelSource, MouseWheelUnit, Vec2};

/// Zoom factor of one notch of the wheel.
const ZOOM_PER_LINE: f64 = 1.2;
/// Distance by which two fingers with Ctrl zoom by a factor of e, points.
const ZOOM_POINTS: f64 = 200.0;
/// Length of one line of a wheel, points.
const POINTS_PER_LINE: f32 = 40.0;

/// What a gesture does to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gesture {
    /// Enlarge by this factor.
    Zoom(f64),
    /// Move by this vector, points.
    Pan(Vec2),
}

impl Gesture {
    /// The gesture of an event, if it is one.
    ///
    /// A wheel zooms, two fingers pan. With Ctrl both zoom, pinching always does, and a wheel with
    /// Shift pans sideways.
    pub fn from_event(event: &Event) -> Option<Self> {
        match event {
            Event::Zoom(factor) => Some(Self::Zoom(f64::from(*factor))),
            Event::MouseWheel {
                unit,
                delta,
                source,
                modifiers,
                ..
            } => {
                // Where the platform does not report the device, points mean a touch pad.
                let is_wheel = match source {
                    MouseWheelSource::Wheel => true,
                    MouseWheelSource::Trackpad | MouseWheelSource::Momentum => false,
                    MouseWheelSource::Unknown => *unit != MouseWheelUnit::Point,
                };
                let points = match unit {
                    MouseWheelUnit::Point => *delta,
                    MouseWheelUnit::Line => *delta * POINTS_PER_LINE,
                    // A page counts as one notch: a whole page would move the picture out of view.
                    MouseWheelUnit::Page => {
                        Vec2::new(delta.x.signum(), delta.y.signum()) * POINTS_PER_LINE
                    }
                };
                // Zoom factors multiply: half a notch is the square root of a notch.
                let lines = f64::from(points.y / POINTS_PER_LINE);
                if modifiers.command || modifiers.ctrl {
                    let by_fingers = (f64::from(points.y) / ZOOM_POINTS).exp();
                    Some(Self::Zoom(if is_wheel {
                        ZOOM_PER_LINE.powf(lines)
                    } else {
                        by_fingers
                    }))
                } else if is_wheel && modifiers.shift {
                    // Some platforms report Shift and a wheel as a horizontal movement already.
                    Some(Self::Pan(Vec2::new(points.x + points.y, 0.0)))
                } else if is_wheel && points.y != 0.0 {
                    Some(Self::Zoom(ZOOM_PER_LINE.powf(lines)))
                } else {
                    Some(Self::Pan(points))
                }
            }
            _ => None,
        }
        .filter(|gesture| gesture.is_finite())
    }

    /// Whether its numbers are finite, and a zoom factor positive.
    fn is_finite(self) -> bool {
        match self {
            Self::Zoom(factor) => factor.is_finite() && factor > 0.0,
            Self::Pan(along) => along.is_finite(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, TouchPhase, vec2};

    fn wheel(unit: MouseWheelUnit, delta: Vec2, modifiers: Modifiers) -> Option<Gesture> {
        let (phase, source) = (TouchPhase::Move, MouseWheelSource::Unknown);
        Gesture::from_event(&Event::MouseWheel {
            unit,
            delta,
            phase,
            source,
            modifiers,
        })
    }

    #[test]
    fn a_wheel_zooms_and_fingers_move() {
        let (line, point) = (MouseWheelUnit::Line, MouseWheelUnit::Point);
        let none = Modifiers::NONE;
        assert_eq!(wheel(line, vec2(0.0, 1.0), none), Some(Gesture::Zoom(1.2)));
        assert_eq!(
            wheel(line, vec2(0.0, -2.0), none),
            Some(Gesture::Zoom(1.2_f64.powf(-2.0)))
        );
        assert_eq!(
            wheel(point, vec2(3.0, -7.0), none),
            Some(Gesture::Pan(vec2(3.0, -7.0)))
        );
        assert_eq!(
            wheel(line, vec2(0.0, 1.0), Modifiers::SHIFT),
            Some(Gesture::Pan(vec2(40.0, 0.0)))
        );
        assert!(
            matches!(wheel(point, vec2(0.0, 20.0), Modifiers::CTRL), Some(Gesture::Zoom(factor)) if factor > 1.0)
        );
        assert_eq!(
            Gesture::from_event(&Event::Zoom(1.5)),
            Some(Gesture::Zoom(1.5))
        );
        assert_eq!(Gesture::from_event(&Event::Zoom(f32::NAN)), None);
    }
}
