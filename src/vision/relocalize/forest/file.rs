//! Serialisation of a forest, little-endian; every number is checked on reading.

use super::tree::{Branch, Child, Forest, MeanRay, Node, Tree};
use crate::features::{DESCRIPTOR_BYTES, Descriptor, Sketch};
use thiserror::Error;

/// Why bytes cannot be read as a forest.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ForestFileError {
    /// The file does not begin with the magic bytes of a forest.
    #[error("this is not a forest of touchline; `touchline train` makes one")]
    NotAForest,
    /// Written by a newer program.
    #[error(
        "this forest has version {version}, this program reads up to {newest}; update touchline or train it again"
    )]
    Newer {
        /// The file's version.
        version: u32,
        /// The newest that is known.
        newest: u32,
    },
    /// Written by an older program in a format that is no longer read; forests are trained again,
    /// not converted.
    #[error("this forest has version {version}, which is no longer read; train it again")]
    Older {
        /// The file's version.
        version: u32,
    },
    /// Cut off, altered, or inconsistent in itself.
    #[error("this forest is damaged ({what}); train it again")]
    Damaged {
        /// The inconsistency found.
        what: &'static str,
    },
}

impl ForestFileError {
    /// The error of a file that is cut off, altered or inconsistent in this way.
    pub(in crate::relocalize) const fn damaged(what: &'static str) -> Self {
        Self::Damaged { what }
    }
}

/// Minimum size of an item in bytes; a count is checked against the remaining bytes before memory
/// is reserved.
const NODE_BYTES: usize = 10;
const LEAF_BYTES: usize = 4;
const MEAN_BYTES: usize = DESCRIPTOR_BYTES + 16;
const TREE_BYTES: usize = 16;

/// Appends a forest.
pub(in crate::relocalize) fn write_forest(forest: &Forest, out: &mut Vec<u8>) {
    write_u32(out, forest.trees.len() as u32);
    for tree in &forest.trees {
        // Counts first, so that a reader can check the size before it reserves memory. They fit
        // into 32 bits: training refuses more samples than a branch can index (`MAX_ITEMS`).
        write_u32(out, tree.root.0);
        write_u32(out, tree.nodes.len() as u32);
        write_u32(out, tree.leaf_ends.len() as u32);
        write_u32(out, tree.rays.len() as u32);
        for node in &tree.nodes {
            out.extend([node.dimension, node.threshold]);
            write_u32(out, node.branches[0].0);
            write_u32(out, node.branches[1].0);
        }
        for end in &tree.leaf_ends {
            write_u32(out, *end);
        }
        for descriptor in &tree.descriptors {
            out.extend(descriptor.0);
        }
        for ray in &tree.rays {
            for value in [ray.pan_tilt[0], ray.pan_tilt[1], ray.spread] {
                out.extend(value.to_le_bytes());
            }
            write_u32(out, ray.samples);
        }
    }
}

fn write_u32(out: &mut Vec<u8>, value: u32) {
    out.extend(value.to_le_bytes());
}

/// Reads bytes from the front, never beyond their end.
pub(in crate::relocalize) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(in crate::relocalize) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next `count` bytes.
    pub(in crate::relocalize) fn bytes(
        &mut self,
        count: usize,
    ) -> Result<&'a [u8], ForestFileError> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or(ForestFileError::damaged("it ends too early"))?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], ForestFileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N)?);
        Ok(array)
    }

    pub(in crate::relocalize) fn u32(&mut self) -> Result<u32, ForestFileError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(in crate::relocalize) fn u64(&mut self) -> Result<u64, ForestFileError> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    /// A finite number.
    pub(in crate::relocalize) fn f64(&mut self) -> Result<f64, ForestFileError> {
        let value = f64::from_le_bytes(self.array()?);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ForestFileError::damaged("a number is not finite"))
        }
    }

    fn f32(&mut self) -> Result<f32, ForestFileError> {
        let value = f32::from_le_bytes(self.array()?);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ForestFileError::damaged("a ray is not finite"))
        }
    }

    /// Reads a number of items of at least `item_bytes` each, and checks that so much data is left.
    pub(in crate::relocalize) fn count(
        &mut self,
        item_bytes: usize,
    ) -> Result<usize, ForestFileError> {
        let count = self.u32()? as usize;
        if count > self.rest.len() / item_bytes {
            return Err(ForestFileError::damaged("it ends too early"));
        }
        Ok(count)
    }

    /// Reads text preceded by its length.
    pub(in crate::relocalize) fn text(&mut self) -> Result<&'a str, ForestFileError> {
        let length = self.count(1)?;
        std::str::from_utf8(self.bytes(length)?)
            .map_err(|_| ForestFileError::damaged("text is not UTF-8"))
    }

    /// Checks that no bytes are left.
    pub(in crate::relocalize) fn finish(&self) -> Result<(), ForestFileError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(ForestFileError::damaged("bytes are left over"))
        }
    }

    /// Reads a forest written by [`write_forest`].
    pub(in crate::relocalize) fn forest(&mut self) -> Result<Forest, ForestFileError> {
        let count = self.count(TREE_BYTES)?;
        if count == 0 {
            return Err(ForestFileError::damaged("it has no trees"));
        }
        Ok(Forest {
            trees: (0..count).map(|_| self.tree()).collect::<Result<_, _>>()?,
        })
    }

    fn tree(&mut self) -> Result<Tree, ForestFileError> {
        let root = Branch(self.u32()?);
        let [nodes, leaves, means] = [
            self.u32()? as usize,
            self.u32()? as usize,
            self.u32()? as usize,
        ];
        let needed = [
            (nodes, NODE_BYTES),
            (leaves, LEAF_BYTES),
            (means, MEAN_BYTES),
        ];
        // Check the sizes before reserving memory: a damaged count must not allocate gigabytes.
        let needed = needed.iter().try_fold(0usize, |sum, (count, bytes)| {
            sum.checked_add(count.checked_mul(*bytes)?)
        });
        if needed.is_none_or(|needed| needed > self.rest.len()) {
            return Err(ForestFileError::damaged("it ends too early"));
        }
        // Branches lead forward only, so that a damaged file cannot make a descent go round.
        check_branch(root, 0, nodes, leaves)?;
        let nodes: Vec<Node> = (0..nodes)
            .map(|index| {
                let [dimension, threshold] = self.array()?;
                let branches = [Branch(self.u32()?), Branch(self.u32()?)];
                for branch in branches {
                    check_branch(branch, index + 1, nodes, leaves)?;
                }
                if usize::from(dimension) >= DESCRIPTOR_BYTES {
                    return Err(ForestFileError::damaged(
                        "a node tests a byte that is not there",
                    ));
                }
                Ok(Node {
                    dimension,
                    threshold,
                    branches,
                })
            })
            .collect::<Result<_, ForestFileError>>()?;
        let leaf_ends: Vec<u32> = (0..leaves).map(|_| self.u32()).collect::<Result<_, _>>()?;
        // Leaves must partition the means in order: `Tree::leaf_range` slices by these ends without
        // a check. There is at least one leaf, else the root's branch would have led nowhere.
        if !leaf_ends.is_sorted() || leaf_ends.last().is_some_and(|&last| last as usize != means) {
            return Err(ForestFileError::damaged("a leaf ends before it begins"));
        }
        let (descriptors, _) = self
            .bytes(means * DESCRIPTOR_BYTES)?
            .as_chunks::<DESCRIPTOR_BYTES>();
        let descriptors: Vec<Descriptor> =
            descriptors.iter().map(|bytes| Descriptor(*bytes)).collect();
        // Sketches follow from the descriptors and are computed on reading, so that the two cannot
        // disagree.
        let sketches = descriptors.iter().map(Sketch::from_descriptor).collect();
        let rays = (0..means)
            .map(|_| {
                Ok(MeanRay {
                    pan_tilt: [self.f32()?, self.f32()?],
                    spread: self.f32()?,
                    samples: self.u32()?,
                })
            })
            .collect::<Result<_, ForestFileError>>()?;
        Ok(Tree {
            root,
            nodes,
            leaf_ends,
            descriptors,
            sketches,
            rays,
        })
    }
}

/// Checks that a branch leads to an existing leaf, or to an existing node of index `first` or more:
/// since nodes point forward only, every descent ends.
fn check_branch(
    branch: Branch,
    first: usize,
    nodes: usize,
    leaves: usize,
) -> Result<(), ForestFileError> {
    let leads_forward = match branch.child() {
        Child::Node(index) => (first..nodes).contains(&index),
        Child::Leaf(index) => index < leaves,
    };
    if leads_forward {
        Ok(())
    } else {
        Err(ForestFileError::damaged("a branch leads nowhere"))
    }
}
