//! Limits the number of features, and keeps them spread over the picture.

use super::Keypoint;
use super::grid::cell_in_grid;
use touchline_core::geometry::ImageSize;
#[cfg(feature = "opencv")]
use touchline_core::geometry::PixelBox;

/// Columns and rows of the grid over the picture.
const GRID: (usize, usize) = (8, 5);

/// A cell is filled up to this many times its even share before surplus features are used.
const CELL_SHARES: usize = 4;

/// The indices of at most `max_count` features. A cell of the grid gets at most four times its even
/// share of them, unless the other cells have too few features. In order of strength, then of
/// index; surplus features of full cells come last.
pub fn spread(keypoints: &[Keypoint], size: ImageSize, max_count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keypoints.len()).collect();
    order.sort_by(|&a, &b| {
        keypoints[b]
            .strength
            .total_cmp(&keypoints[a].strength)
            .then(a.cmp(&b))
    });
    if order.len() <= max_count {
        return order;
    }
    // Without a quota, a textured crowd would take all features and leave none near the field.
    let quota = (CELL_SHARES * max_count).div_ceil(GRID.0 * GRID.1);
    let mut in_cell = [0usize; GRID.0 * GRID.1];
    let (mut kept, mut surplus) = (Vec::with_capacity(max_count), Vec::new());
    for index in order {
        let cell = &mut in_cell[cell_in_grid(keypoints[index].point, size, GRID)];
        if *cell < quota {
            *cell += 1;
            kept.push(index);
        } else {
            surplus.push(index);
        }
    }
    // Surplus features fill what the quota has left empty.
    kept.extend(surplus);
    kept.truncate(max_count);
    kept
}

/// At most `max_count` features that lie in none of the masks, as [`spread`] chooses them.
#[cfg(feature = "opencv")]
pub(super) fn spread_unmasked<D: Copy>(
    found: impl IntoIterator<Item = (Keypoint, D)>,
    masks: &[PixelBox],
    size: ImageSize,
    max_count: usize,
) -> (Vec<Keypoint>, Vec<D>) {
    // Masked features are dropped before spreading, so that they take no other feature's share.
    let (keypoints, descriptors): (Vec<Keypoint>, Vec<D>) = found
        .into_iter()
        .filter(|(keypoint, _)| !masks.iter().any(|mask| mask.contains(keypoint.point)))
        .unzip();
    spread(&keypoints, size, max_count)
        .into_iter()
        .map(|index| (keypoints[index], descriptors[index]))
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImagePoint;

    fn keypoint(x: f64, strength: f32) -> Keypoint {
        Keypoint {
            point: ImagePoint::new(x, 50.0),
            size_px: 2.0,
            strength,
        }
    }

    #[test]
    fn a_crowded_corner_does_not_take_everything() {
        let size = ImageSize::new(800, 500);
        let strong = (0..900).map(|i| keypoint(10.0, 1000.0 + i as f32));
        let weak = (0..100).map(|i| keypoint(700.0, i as f32));
        let keypoints: Vec<_> = strong.chain(weak).collect();
        let kept = spread(&keypoints, size, 400);
        let far = kept
            .iter()
            .filter(|&&i| keypoints[i].point.x > 600.0)
            .count();
        assert_eq!((kept.len(), far), (400, 40));
        assert_eq!(kept[0], 899, "the strongest first");
        assert_eq!(
            spread(&keypoints[..30], size, 400).len(),
            30,
            "few are all kept"
        );
    }
}
