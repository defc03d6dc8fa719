//! What writing a dataset came to.

/// What was written.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetDone {
    /// How many frames it holds.
    pub frames: usize,
    /// How many pictures.
    pub pictures: usize,
    /// How many frames each split holds.
    pub counts: [usize; 3],
    /// Frames that were asked for and are not in it, by name, and why.
    pub left_out: Vec<(String, String)>,
}
