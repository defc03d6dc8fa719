//! From numbers to statements: means with their intervals, contrasts between methods, the numbers
//! of the paper, and the page that lists what the paper says beside what we measure. No experiment
//! runs here.

pub mod contrast;
pub mod lost_iou;
pub mod page;
pub mod paper;
pub mod statistics;
