//! The result of writing a dataset.

/// The contents of the written dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct DatasetDone {
    /// The number of frames.
    pub frames: usize,
    /// The number of pictures.
    pub pictures: usize,
    /// The number of frames of each split.
    pub counts: [usize; 3],
    /// Chosen frames that are not in it, by name, with the reason.
    pub left_out: Vec<(String, String)>,
}
