//! Points that other programs' models gave: evidence of a frame that is no person's.

use crate::document::{Click, Document, Frame, FrameStatus};
use std::collections::BTreeMap;

impl Frame {
    /// Whether it has clicks and all of them are points of models that no person moved or renamed.
    pub fn has_points_of_models_alone(&self) -> bool {
        !self.clicks.is_empty() && self.clicks.iter().all(Click::is_by_model)
    }

    /// Removes the clicks that a person refuses: of those that a model gave, it is kept that they
    /// were refused.
    pub fn refuse_clicks(&mut self, is_refused: impl Fn(usize, &Click) -> bool) {
        let clicks = self.clicks.iter().enumerate();
        let refused = clicks
            .filter(|(place, click)| click.origin.is_some() && is_refused(*place, click))
            .map(|(_, click)| click.clone());
        let refused: Vec<Click> = refused.collect();
        self.refused_points.extend(refused);
        self.retain_clicks(|place, click| !is_refused(place, click));
    }

    /// Removes the points of a model, or of all: those that no person touched or refused, and the
    /// camera that rests on them alone unless a person accepted it. Points that a person moved are
    /// the person's and stay. Returns how many were removed.
    pub fn remove_points_of(&mut self, model: Option<&str>) -> usize {
        let is_meant = |click: &Click| {
            let origin = click.origin.as_ref();
            origin.is_some_and(|origin| model.is_none_or(|model| origin.model() == model))
        };
        let count = self.clicks.len() + self.refused_points.len();
        let rests_on_points = self.has_points_of_models_alone();
        self.refused_points.retain(|click| !is_meant(click));
        self.retain_clicks(|_, click| !(click.is_by_model() && is_meant(click)));
        let removed = count - self.clicks.len() - self.refused_points.len();
        let is_undecided = matches!(
            self.status,
            FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested
        );
        if removed > 0 && rests_on_points && is_undecided {
            if self.is_solved_by_clicks() && !self.restore_proposed() {
                (self.ptz, self.solution) = (None, None);
            }
            self.status = self.undecided_status();
        }
        removed
    }
}

impl Document {
    /// The models that gave points, by name, with the number of points: as the models gave them,
    /// moved or renamed by a person, and refused.
    pub fn points_of_models(&self) -> BTreeMap<String, [usize; 3]> {
        let mut counts: BTreeMap<String, [usize; 3]> = BTreeMap::new();
        let mut count = |click: &Click, kind: usize| {
            if let Some(origin) = &click.origin {
                counts.entry(origin.model().to_owned()).or_default()[kind] += 1;
            }
        };
        for frame in &self.frames {
            for click in &frame.clicks {
                count(click, usize::from(!click.is_by_model()));
            }
            for click in &frame.refused_points {
                count(click, 2);
            }
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{ClickOrigin, SolutionSource};
    use crate::testing::{new_frame, ptz_at, solved_by};
    use touchline_core::geometry::{ImagePoint, ImageSize};

    fn point_of(model: &str, name: &str) -> Click {
        Click {
            origin: Some(Box::new(ClickOrigin::from_model(model))),
            ..Click::landmark(name.into(), ImagePoint::new(5.0, 6.0))
        }
    }

    fn suggested() -> Frame {
        let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
        frame.clicks = vec![
            point_of("net", "centre_mark"),
            point_of("net", "halfway_far"),
        ];
        frame.ptz = ptz_at(1.0, -9.0, 900.0);
        frame.solution = solved_by(SolutionSource::Points);
        frame.status = frame.undecided_status();
        frame
    }

    #[test]
    fn points_of_a_model_are_nobodys_work_until_a_person_moves_one() {
        let mut frame = suggested();
        assert_eq!(frame.status, FrameStatus::Suggested);
        assert!(!frame.is_used_for_training());
        assert_eq!(frame.source_of_clicks(), SolutionSource::Points);
        frame.clicks[0].take_over();
        frame.clicks[0].image.x += 3.0;
        assert_eq!(frame.undecided_status(), FrameStatus::Draft);
        assert_eq!(frame.source_of_clicks(), SolutionSource::Clicks);
        let given = frame.clicks[0].origin.as_ref().unwrap().given;
        assert_eq!(given, Some(ImagePoint::new(5.0, 6.0)));
        frame.status = FrameStatus::Reference;
        assert!(frame.is_used_for_training(), "a person accepted it");
    }

    #[test]
    fn removed_points_take_their_camera_along_and_a_moved_one_stays() {
        let mut frame = suggested();
        assert_eq!(frame.remove_points_of(Some("other")), 0);
        assert_eq!(frame, suggested());
        assert_eq!(frame.remove_points_of(None), 2);
        assert_eq!(
            (frame.status, frame.ptz.is_none()),
            (FrameStatus::New, true)
        );

        let mut moved = suggested();
        moved.clicks[1].take_over();
        moved.refuse_clicks(|place, _| place == 0);
        assert_eq!((moved.clicks.len(), moved.refused_points.len()), (1, 1));
        assert_eq!(moved.remove_points_of(Some("net")), 1);
        assert_eq!((moved.clicks.len(), moved.refused_points.len()), (1, 0));
        assert!(moved.ptz.is_some(), "a person's click is left");
    }
}
