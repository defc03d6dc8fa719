//! The pan-tilt forest: from a descriptor to the rays it may show (section 3.2 of the paper).
//!
//! A split tests one byte of the descriptor against a threshold. A leaf holds descriptors with
//! their rays: samples of one place, seen from several references, become one, their mean. A
//! descriptor is looked up in all trees; what the leaves reached hold is compared with it byte by
//! byte, and then, best first, what the branches hold that were missed by least. The squared
//! distance gates what is no match, and the nearest places stay as candidates.
//!
//! Rays are directions in `base`, exact, so that one scene point has one label whichever frame saw
//! it.
//!
//! # Where it departs from the paper, and what was tried
//!
//! The published forest ([`TrainOptions::published`]) goes on until a leaf has one sample or depth
//! 20 is reached, and knows a leaf by the mean of its samples. That loses twice: one miss on a long
//! way down ends at an outlier, and at depth 20 leaves mix places. On the drawn references and
//! frames of the bench, 1000 SIFT features a frame (all 120 000 samples known; a search through all
//! of them names .675 of the rays within 0.5°), share of rays within 0.5° and time for a frame's
//! features on a busy machine, by a search of one descriptor after another:
//!
//! | forest | rays | ms |
//! |---|---|---|
//! | published, 4 leaves per tree | .448 | 9.6 |
//! | the same without a limit to its depth | .585 | 25 |
//! | leaves of 8 samples, published splits, 5 trees, 7 leaves in all | .620 | 16 |
//! | the same splits among the 24 bytes that vary most, 2 trees | .610 | 4.4 |
//! | widest gap among them instead, 2 trees, leaves of 16 | .604 | 0.9 |
//! | and places merged in the leaves, 2 trees, 2 leaves in all | .575 | 0.6 |
//! | 3 trees, leaves of 32, 3 leaves in all (the default) | .614 | 1.0 |
//! | 5 trees, leaves of 32, 5 leaves in all | .638 | 2.4 |
//!
//! Now descriptors are looked up in groups, and outliers are recognised by sketches of a quarter of
//! their bytes: 0.7 ms for the default and .604 of the rays, 1.2 ms and .633 for 5 trees. Of what a
//! leaf holds, .12 are within the gate; left to compare with one in a hundred of these lost: .15 by
//! sketches of two by two cells that are allowed half of the gate, .16 by those of rows of four
//! cells, .22 by a bit for each byte. A bound that loses none leaves .41 by two by two cells, .54
//! by rows, .19 by sketches of twice the size.
//!
//! Lost: the mean as threshold (as in other randomised k-d trees), more than 2 bytes tried at a
//! split (nothing gained), leaves of 64 (slower than they gain), following branches that were
//! missed by more than a quarter of the best distance (nothing gained), letting several near
//! neighbours vote (.676 falls to .663 as more vote), three and more samples in the least leaf.
//!
//! Lost as well: leaving out what overlapping references do not confirm. Each sample was looked for
//! in up to six references that see its ray at a similar focal length, and confirmed by a
//! descriptor within the gate at that ray. On the drawn frames, and on real ones (300 features,
//! every clip of three matches answered by the others, 141 frames) given with all references and
//! with eight:
//!
//! | kept | drawn: places, rays | real: samples, given |
//! |---|---|---|
//! | all | 220 000, .604 | 100 %, 139 and 137 |
//! | never a likeness at another ray without being confirmed | 199 000, .595 | 92 %, 140 and 137 |
//! | confirmed as often as there is a likeness at another ray | 192 000, .586 | 91 %, 141 and 136 |
//! | confirmed, where four references or more overlap | 130 000, .578 | 41 %, 141 and 132 |
//! | confirmed, where any overlap | 88 000, .560 | 35 %, 139 and 121 |
//! | confirmed by a quarter | 73 000, .533 | 19 %, 138 and 99 |
//!
//! Accuracy was the same throughout. What one reference alone shows is what a frame between the
//! references needs, and consensus leaves outliers out at no cost; the search for confirmation
//! costs more than the training.

mod file;
mod leaf;
mod options;
mod predict;
mod samples;
mod search;
mod split;
mod train;
mod tree;

pub use file::ForestFileError;
pub(super) use file::{Reader, write_forest};
pub use options::{PredictOptions, SplitRule, TrainOptions};
pub use predict::RayCandidate;
pub use samples::Samples;
pub use search::Search;
pub use train::{Stopped, TrainProgress, train, train_without};
pub use tree::Forest;
