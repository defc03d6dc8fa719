//! SIFT, SURF, ORB and AKAZE on the same frames, by nearest neighbours and through both forests:
//! what the paper says of SURF beside table 4, and whether a forest can use bits.
//!
//! | what | where |
//! |---|---|
//! | the kinds of features, their gates, and a set described with them | `described.rs` |
//! | cameras from nearest neighbours | `neighbours.rs` |
//! | cameras from forests | [`crate::scoring::forests`] |

mod described;
mod neighbours;

use super::sequences::{introduce_again, on_both};
use crate::progress::{Progress, step_counter};
use crate::report::contrast::{Contrast, Statement};
use crate::report::paper::SIFT_SURF;
use crate::report::{Report, Stated};
use crate::scoring::answers::{FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::SetKind;
use crate::{ExperimentError, SharedInputs};
use described::{Described, FeatureKind, MOST_FEATURES};
use neighbours::ask_neighbours;
use touchline::report::{Cell, Table};

/// Every n-th test frame is used, the same ones with every kind of features.
const STRIDE: usize = 2;

/// How a frame's features get their rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    Forest(ForestKind),
    /// Each feature gets the ray of its nearest neighbour among all references' features.
    Neighbours,
}

impl Method {
    /// All of them, the paper's first.
    const ALL: [Self; 3] = [
        Self::Forest(ForestKind::Published),
        Self::Forest(ForestKind::Default),
        Self::Neighbours,
    ];

    /// Its name in tables.
    const fn describe(self) -> &'static str {
        match self {
            Self::Forest(kind) => kind.key(),
            Self::Neighbours => "nearest neighbours",
        }
    }

    /// Its name in the name of a way.
    const fn key(self) -> &'static str {
        match self {
            Self::Forest(kind) => kind.key(),
            Self::Neighbours => "neighbours",
        }
    }

    /// Solves the cameras of the test frames. `repeat` is the index of the set among those of other
    /// seeds.
    fn ask(self, described: &Described, repeat: usize) -> Vec<FrameAnswer> {
        let set = &described.set;
        match self {
            Self::Forest(kind) => {
                let mut asking = kind.asking(set.seed);
                // The gate is in the unit of the stored descriptors, which differs for SURF.
                asking.predict.max_squared_distance = described.kind.forest_gate();
                Trained::train(set, repeat, &kind.training(set.seed)).ask_plainly(&asking)
            }
            Self::Neighbours => ask_neighbours(described, repeat),
        }
    }
}

/// The answers of a method with a kind of features.
struct Way {
    method: Method,
    features: FeatureKind,
    answers: Vec<FrameAnswer>,
}

impl Way {
    /// Its name in the table of frames: "SURF published".
    fn name(&self) -> String {
        format!("{} {}", self.features.name(), self.method.key())
    }

    /// The mean `IoU` that the paper states for it.
    fn stated_iou(&self) -> Option<f64> {
        let [sift, surf] = SIFT_SURF;
        match (self.method, self.features) {
            (Method::Forest(ForestKind::Published), FeatureKind::Sift) => Some(sift),
            (Method::Forest(ForestKind::Published), FeatureKind::Surf) => Some(surf),
            _ => None,
        }
    }
}

/// Runs the experiment.
///
/// # Errors
/// The frames or their pictures cannot be drawn or read.
pub fn run(inputs: &SharedInputs, progress: Progress) -> Result<Report, ExperimentError> {
    let sets = inputs.highlights(progress)?;
    let mut report = Report::new(
        "descriptors",
        &sets[0].heading("Descriptors: SIFT, SURF, ORB, AKAZE"),
    );
    introduce_again(
        &mut report,
        sets,
        "highlights",
        &format!("One frame in {STRIDE} is tested, the same ones with every kind."),
    );
    report.text(&format!(
        "At most {MOST_FEATURES} features a picture, spread over it. SIFT, ORB and AKAZE are \
         OpenCV's, with its own settings; SURF is upright SURF-64, written from its publication \
         (Bay, Ess, Tuytelaars, Van Gool, CVIU 2008), with a gate that lets as many unrelated \
         features pass as SIFT's. Forests split bytes: of ORB and AKAZE they see 128 bits, each \
         as a byte, as in `touchline train --detector`. *Nearest neighbours* is no forest: each \
         feature has the ray of its nearest neighbour among all references' features, and all \
         bits are compared."
    ));

    let mut ways: Vec<Way> = Vec::new();
    for method in Method::ALL {
        ways.extend(FeatureKind::ALL.map(|features| Way {
            method,
            features,
            answers: Vec::new(),
        }));
    }
    let step = step_counter(sets.len() * ways.len(), progress);
    for (repeat, set) in sets.iter().enumerate() {
        for kind in FeatureKind::ALL {
            // One kind at a time, so that only its features are in memory.
            let described = Described::from_set(set, kind, STRIDE)?;
            for way in ways.iter_mut().filter(|way| way.features == kind) {
                way.answers.extend(way.method.ask(&described, repeat));
                step();
            }
        }
    }

    let mut table = tabulate(&ways);
    if sets[0].kind != SetKind::Own {
        let stated = ways
            .iter()
            .map(|way| way.stated_iou().map(|iou| Cell::Fixed(iou, 2)).into());
        table = table.with_column("paper_iou", "paper: IoU", stated);
    }
    report.table("kinds", "By method and kind of features.", table);
    let each = ways.iter().map(|way| (way.name(), &way.answers[..]));
    report.data(
        "frames",
        "Every frame, by kind of features and method.",
        frame_table(sets, each),
    );
    if sets[0].kind == SetKind::Drawn {
        claim(&mut report);
    }
    Ok(report)
}

/// Adds the paper's sentence on SURF.
fn claim(report: &mut Report) {
    let [sift, surf] = SIFT_SURF;
    let lead = |kind: &str| {
        Contrast::over_frames("iou_part")
            .plus(&[("way", &format!("SIFT {kind}"))])
            .minus(&[("way", &format!("SURF {kind}"))])
    };
    Statement::new(
        &format!("SIFT beats SURF: IoU {sift} and {surf}"),
        Stated::difference(sift, surf),
        "SURF is upright SURF-64 with a gate of its own; the paper does not say which it used",
    )
    .test(report, &on_both(lead));
}

/// A row for each way: method, features, and the statistics of its frames.
fn tabulate(ways: &[Way]) -> Table {
    let tallies: Vec<(Cell, Tally)> = ways
        .iter()
        .map(|way| {
            (
                way.features.name().into(),
                Tally::from_answers(way.answers.iter()),
            )
        })
        .collect();
    // The columns of a tally behind a first column with the method.
    let mut by_features = tally_table(("features", "features"), &tallies);
    let mut table = Table::new(&[("method", "method")]);
    table.columns.append(&mut by_features.columns);
    for (way, cells) in ways.iter().zip(by_features.rows) {
        let mut row = vec![way.method.describe().into()];
        row.extend(cells);
        table.push(row);
    }
    table
}
