//! Connected components of the view graph.

use super::ViewGraphEdge;

/// The connected components of `count` frames under pairwise matches, the largest first, each
/// ascending; a frame without a match is a component of its own.
pub fn groups(count: usize, edges: &[ViewGraphEdge]) -> Vec<Vec<usize>> {
    // Union–find; the root of a component is its smallest frame, so that the result does not depend
    // on the order of the edges.
    let mut group_of: Vec<usize> = (0..count).collect();
    for edge in edges {
        let (one, other) = (
            root(&mut group_of, edge.first),
            root(&mut group_of, edge.second),
        );
        group_of[one.max(other)] = one.min(other);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); count];
    for frame in 0..count {
        let of = root(&mut group_of, frame);
        groups[of].push(frame);
    }
    groups.retain(|group| !group.is_empty());
    groups.sort_by_key(|group| (std::cmp::Reverse(group.len()), group[0]));
    groups
}

/// The root of a frame's component, with path halving.
fn root(group_of: &mut [usize], mut frame: usize) -> usize {
    while group_of[frame] != frame {
        group_of[frame] = group_of[group_of[frame]];
        frame = group_of[frame];
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::Mat3;

    #[test]
    fn frames_hang_together_over_others_and_the_largest_group_is_first() {
        let edge = |(first, second)| ViewGraphEdge {
            first,
            second,
            matches: Vec::new(),
            agreeing: 20,
            second_from_first: Mat3::identity(),
        };
        let edges: Vec<ViewGraphEdge> = [(1, 4), (0, 2), (4, 5)].map(edge).to_vec();
        assert_eq!(groups(6, &edges), [vec![1, 4, 5], vec![0, 2], vec![3]]);
        assert_eq!(groups(2, &[]), [vec![0], vec![1]]);
        assert!(groups(0, &[]).is_empty());
    }
}
