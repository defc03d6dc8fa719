//! The window, driven through its accessibility nodes and looked at in small pictures.
//!
//! It runs without a display on whatever adapter there is; on a machine without any its tests are
//! ignored.

mod base;
mod cameras;
mod closing;
mod commands;
mod filmstrip;
mod gold;
mod guide;
mod harness;
mod inspector;
mod labelling;
mod names;
mod panels;
mod preferences;
mod quality;
mod queue;
mod review;
mod solved_frame;
mod timeline;
mod tour;
mod trainer;
mod transfer;
mod typed;
mod viewport;

use crate::parts::Test;

pub const TESTS: &[&[Test]] = &[
    base::TESTS,
    cameras::TESTS,
    closing::TESTS,
    commands::TESTS,
    filmstrip::TESTS,
    gold::TESTS,
    guide::TESTS,
    inspector::TESTS,
    labelling::TESTS,
    names::TESTS,
    panels::TESTS,
    preferences::TESTS,
    quality::TESTS,
    queue::TESTS,
    review::TESTS,
    timeline::TESTS,
    tour::TESTS,
    trainer::TESTS,
    transfer::TESTS,
    typed::TESTS,
    viewport::TESTS,
];
