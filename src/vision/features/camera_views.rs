//! Selects the pictures of a series between which the camera moved far enough to distinguish a
//! graphic from the stadium.

use super::displaced::CoarsePicture;
use super::reduced::{EdgeKind, ReducedPicture, count_edges};
use rayon::prelude::*;

/// The camera moved if less than this share of the edges of a kind, upright or level, is static. By
/// chance it is 0.2 and 0.3. A pure pan leaves level edges in place, a pure tilt upright ones.
const MOVED_OF_KIND: [f32; 2] = [0.36, 0.45];

/// For each kind of edge, the indices of pictures such that the camera moved from each to the next.
/// The motion must be so large that a camera which moves by only a degree or two in all has too few
/// of them for anything to be found.
pub(super) fn camera_views(pictures: &[ReducedPicture]) -> [Vec<usize>; 2] {
    let coarse: Vec<CoarsePicture> = pictures.par_iter().map(CoarsePicture::new).collect();
    EdgeKind::ALL.map(|kind| views_of_kind(kind, pictures, &coarse))
}

/// The indices of pictures such that the camera moved from each to the next, by edges of one kind.
fn views_of_kind(
    kind: EdgeKind,
    pictures: &[ReducedPicture],
    coarse: &[CoarsePicture],
) -> Vec<usize> {
    let mut views: Vec<usize> = Vec::new();
    for (place, picture) in pictures.iter().enumerate() {
        // Few static edges, and no block match that says otherwise: edges alone are unreliable
        // while a camera pans slowly along boards. Undecided blocks (None) are no objection.
        let is_new_view = views.last().is_none_or(|&before| {
            count_edges(&pictures[before], picture).is_some_and(|counts| {
                let count = &counts[kind as usize];
                count.standing < MOVED_OF_KIND[kind as usize] * count.all
            }) && coarse[before].is_displaced(&coarse[place], kind) != Some(false)
        });
        if is_new_view {
            views.push(place);
        }
    }
    views
}
