//! The controls that several panels use: rows with bars, headings, number fields, symbols, and the
//! theme with its colours and sizes. A control knows no panel. Maps and plots are in `maps`.

pub mod bar;
pub mod heading;
pub mod number;
pub mod symbol;
pub mod theme;
