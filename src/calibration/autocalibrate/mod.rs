//! Autocalibration: the base of a rotating camera from its frames alone, without a click.
//!
//! # Problem
//!
//! Given: sampled frames of one camera that stands still, pans, tilts and zooms, and a field whose
//! size is known or limited by rules. Wanted: the camera's position and base rotation, its lens,
//! and pan, tilt and focal length of every frame; or the reason why no answer is certain. A wrong
//! base spoils every frame that is labelled with it, so the search abstains rather than guess.
//!
//! # Idea
//!
//! One frame shows too few lines to place a camera. But a camera that only rotates and zooms sees
//! every static point in one fixed direction, so its frames can be aligned by image matches alone,
//! without knowing the field. Paint that many frames show in the same direction is on the ground;
//! players, shadows and changing boards are not there twice. What remains is a *panorama*: one
//! rigid set of directions of paint that covers most of the field. Its pose has six parameters, and
//! hardly any pose but the right one lays it onto the lines of the field.
//!
//! # Stages
//!
//! | stage | file | robust against |
//! |---|---|---|
//! | 0. Courts: a camera by the lines of single pictures | `court/` | still cameras, any colours |
//! | 1. Features and marking pixels of each sampled frame | `frames/sampled_frames.rs` | – |
//! | 2. Pairwise matches; the largest connected group; relative rotations, zoom and lens | `frames/matched_frames.rs`, [`touchline_vision::track`] | wrong matches (MAGSAC, loops of three frames), burnt-in graphics, frames of another camera |
//! | 3. Persistent paint as directions | `frames/matched_frames.rs`, [`touchline_vision::paint::persistent_paint`] | players, shadows, boards |
//! | 4. Exhaustive search of 304,425 poses on one side for each field size, and where these give no answer of all other places around the field, repeated at other focal scales; the best are improved by pattern search and fitted | `search/`: `focal_scales.rs`, `exhaustive.rs`, `places.rs`, `pose_score.rs`, `pose.rs` | a focal scale that matches bias (scrolling boards: up to 29 %) |
//! | 4′. With two clicked landmarks, poses from pairs of clicks in place of the search | `search/clicked.rs` | – |
//! | 5. Fit of the panorama with focal scale, crown and field size | `search/panorama_fit/` | low cameras, from which size and distance trade off; boards beside lines that are hardly seen (`search/bright_markings.rs`) |
//! | 6. Joint adjustment of the base and all frames to the paint in the pictures | `adjustment/`: `candidates.rs`, `hypothesis.rs`, `joint.rs`, `paint_on_lines.rs` | wrong lines at first; frames that stray; boards beside lines that are hardly seen |
//! | 7. Evidence in nats (room `evidence`), by which candidates are ordered and moves are taken; halves of the frames give one position | `adjustment/evidence.rs` | fields of another sport or size, lines of another sport on the same ground |
//! | 8. The best two are aligned to each frame's own picture and adjusted once more | `adjustment/`: `align.rs`, `refine.rs` | frames that went to other lines; a principal point that a few frames draw away |
//! | 9. Verdict; lines too faint for any single picture are looked for in the mean of all, and clicks that played no part confirm | `verdict/`: `decision.rs`, `checks.rs`, `faint_lines.rs`, `deciding_landmark.rs` | a runner-up that explains nearly as much; poor pictures |
//!
//! `camera.rs` runs the stages in this order. From stage 6 on a candidate is one `Hypothesis`,
//! which each stage refines.
//!
//! `field_prior.rs` says which field sizes are tried, `pitch_map.rs` (on `painted_curves.rs`) which
//! line a camera sees nearest to a point, and `rotations_by_focal_scale.rs` interpolates stage 2
//! between the focal scales at which it was solved. Without an answer,
//! [`Abstention`] names the stage that failed, or the [`Doubt`]s about the best candidate, and
//! `wanted_clicks.rs` the clicks that would help.
//!
//! # Why not …
//!
//! * *one homography per frame*, from detected lines or a learned segmentation? A narrow view shows
//!   one family of parallel lines, sometimes a single line, and these do not determine a
//!   homography. All frames together over-determine one panorama.
//! * *structure from motion*? A rotating camera has no baseline, so nothing can be triangulated.
//!   Position and scale come from the field.
//! * *focal lengths from self-calibration alone*? Stage 2 finds them, but their common scale is
//!   what matches determine worst, and outliers that agree with each other (scrolling boards) bias
//!   it. Paint decides it, in stages 4 and 5.
//! * *descent from one start*? Parallel lines make many local minima; hence the exhaustive search.
//!   For the same reason a good score is no answer unless it is much better than the runner-up's.
//!
//! # References
//!
//! * R. Hartley: "Self-calibration of stationary cameras", IJCV 22, 1997. L. Agapito, E. Hayman, I.
//!   Reid: "Self-calibration of rotating and zooming cameras", IJCV 45, 2001 (stage 2).
//! * M. Brown, D. Lowe: "Automatic panoramic image stitching using invariant features", IJCV 74,
//!   2007 (stage 2).
//! * Y. Chen, G. Medioni: "Object modelling by registration of multiple range images", Image and
//!   Vision Computing 10, 1992 (stages 4–6).
//! * B. Efron: "The Jackknife, the Bootstrap and Other Resampling Plans", 1982 (stage 7, for few
//!   frames).

mod adjustment;
mod answer;
mod camera;
mod court;
mod doubt;
mod error;
mod field_prior;
mod frames;
mod progress;
#[cfg(test)]
mod rotating_camera;
mod search;
mod verdict;

pub(crate) use adjustment::evidence::MIN_NATS;
pub use answer::{AutocalibrationAnswer, WantedClicks};
pub(crate) use camera::{SearchExtent, find_camera_in_stages};
pub use camera::{camera_without_clicks, find_camera};
// For the window alone: no promise to other programs.
pub use doubt::Doubt;
pub use error::{Abstention, AutocalibrationError};
pub(crate) use frames::by_shot::{frames_of_fields, spread_over_shots_and_clicks};
pub use frames::sampled_frames::PictureOfFrame;
pub use progress::{AutocalibrationProgress, SearchedPanorama};
pub(crate) use search::clicked::GroundClick;
#[doc(hidden)]
pub use search::places::is_court;
pub(crate) use verdict::checks::contradicting_click;
