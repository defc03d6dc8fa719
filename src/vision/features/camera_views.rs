//! The pictures of a series between which the camera moved far enough to tell a graphic from the
//! stadium.

use super::displaced::CoarsePicture;
use super::reduced::{EdgeKind, ReducedPicture, count_edges};
use rayon::prelude::*;

/// Of the edges of a kind in two pictures, upright and level ones, less than this share stands once
/// a camera has moved by a few px: by chance .2 and .3. A pure pan leaves level edges where they
/// were, a pure tilt upright ones.
const MOVED_OF_KIND: [f32; 2] = [0.36, 0.45];

/// The pictures, by their places, each of which the camera moved to since the one before it, as
/// edges of each kind show: so far that a camera that turns by a degree or two in all has too few
/// of them for anything to be found.
pub(super) fn camera_views(pictures: &[ReducedPicture]) -> [Vec<usize>; 2] {
    let coarse: Vec<CoarsePicture> = pictures.par_iter().map(CoarsePicture::new).collect();
    let of_kind = |kind: EdgeKind| {
        let mut views: Vec<usize> = Vec::new();
        for (place, picture) in pictures.iter().enumerate() {
            let has_moved = |&before: &usize| {
                count_edges(&pictures[before], picture).is_some_and(|counts| {
                    let count = &counts[kind as usize];
                    count.standing < MOVED_OF_KIND[kind as usize] * count.all
                }) && coarse[before].is_displaced(&coarse[place], kind) != Some(false)
            };
            if views.last().is_none_or(has_moved) {
                views.push(place);
            }
        }
        views
    };
    EdgeKind::ALL.map(of_kind)
}
