//! A stretch of selected frames accepted together: those on the paint, and what is left of it.

use crate::bench::Bench;
use touchline_application::app::guidance::next_step;
use touchline_application::app::review::{BulkAccept, LeftReason};
use touchline_application::app::selection::Selecting;
use touchline_application::app::session::{Dialog, Filter, Level};
use touchline_application::app::{
    Action, Command, EditAction, Effect, Navigation, TrainerReport, ViewAction,
};
use touchline_application::testing::proposed::{blank, proposal_in, truth};
use touchline_core::camera::Ptz;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{
    Click, Document, Frame, FramePtz, FrameStatus, PaintEvidence, Solution, SolutionSource,
};
use touchline_documents::testing::ptz_at;

/// Evidence of paint with a probability of being right, at 200 open places.
fn paint(score: f64) -> PaintEvidence {
    PaintEvidence {
        score,
        predicted: 220,
        found: 150,
        bare: 50,
        offset_px: Some(0.8),
        ..PaintEvidence::default()
    }
}

/// Gives a frame an imported camera.
fn import(frame: &mut Frame, ptz: Ptz, line_check: Option<PaintEvidence>) {
    frame.ptz = Some(FramePtz::new(ptz, None));
    frame.status = FrameStatus::Draft;
    frame.solution = Some(Solution {
        source: Some(SolutionSource::Import),
        line_check,
        ..Solution::default()
    });
}

/// Imported cameras on the paint.
fn imported_cameras(frames: usize) -> Document {
    let mut document = blank(frames);
    for (index, frame) in document.frames.iter_mut().enumerate() {
        import(frame, truth(index), Some(paint(0.99)));
    }
    document
}

impl Bench {
    /// Selects the frames from the shown one to another, as a click with Shift does.
    fn select_to(&mut self, frame: usize) {
        self.act(Action::Navigate(Navigation::SelectFrame {
            frame,
            how: Selecting::Range,
        }));
    }

    fn bulk(&self) -> BulkAccept {
        self.app.accept_sheet().unwrap().bulk.clone()
    }

    /// The places that would be accepted, and those that are left for a reason.
    fn taken_and_left(&self) -> (Vec<usize>, Vec<(LeftReason, Vec<usize>)>) {
        let bulk = self.bulk();
        let mut taken: Vec<usize> = bulk.ticked_rows().map(|row| row.frame).collect();
        taken.sort_unstable();
        let left = bulk.of_stretch.unwrap();
        (taken, left.by_reason.into_iter().collect())
    }

    fn journal_entries(&self) -> usize {
        self.effects
            .iter()
            .filter(|effect| matches!(effect, Effect::Journal { .. }))
            .count()
    }
}

#[test]
fn two_hundred_imported_cameras_are_accepted_but_for_those_that_something_speaks_against() {
    let mut document = imported_cameras(200);
    document.frames[3].ptz = None;
    import(
        &mut document.frames[17],
        Ptz::from_degrees(-0.6, -14.0, 2300.0),
        Some(paint(0.01)),
    );
    import(
        &mut document.frames[40],
        Ptz::from_degrees(4.0, -14.0, 1.0),
        Some(paint(0.99)),
    );
    import(&mut document.frames[41], truth(41), None);
    document.frames[199].status = FrameStatus::Reference;
    let mut bench = Bench::new(document);
    bench.select_to(199);
    assert_eq!(bench.app.stretch_size(), Some(200));
    let says = next_step(&bench.app).text;
    assert_eq!(
        says,
        "200 frames selected, 0 to 199. Enter counts those on the painted lines, Esc lets go."
    );

    bench.command(Command::Accept);
    assert_eq!(bench.app.session.dialog, Some(Dialog::AcceptAll));
    let (taken, left) = bench.taken_and_left();
    assert_eq!(taken.len(), 195);
    assert_eq!(
        left,
        [
            (LeftReason::NoCamera, vec![3]),
            (LeftReason::Impossible, vec![40]),
            (LeftReason::OffPaint, vec![17]),
            (LeftReason::NotChecked, vec![41]),
        ]
    );
    let bulk = bench.bulk();
    let described = bulk
        .of_stretch
        .as_ref()
        .unwrap()
        .describe(bulk.ticked_rows().count(), bench.app.open().unwrap());
    assert_eq!(
        described,
        "195 on the paint, 4 left: 1 without a camera (frame 3), 1 with an impossible camera \
         (frame 40), 1 contradicted by the painted lines (frame 17), 1 not checked against the \
         painted lines yet (frame 41). 1 is accepted already."
    );
    assert_eq!(bench.journal_entries(), 0, "the sheet only counts");

    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.app.session.dialog, None);
    let statuses = bench.statuses();
    assert_eq!(statuses.matches('R').count(), 196);
    for left in [3, 17, 40, 41] {
        assert_eq!(statuses.as_bytes()[left], b'D', "{left}");
    }
    assert_eq!(
        bench.last_notice(),
        "195 frames accepted. Ctrl+Z undoes all of it."
    );
    assert_eq!(bench.app.stretch_size(), None, "the stretch is done");
    assert_eq!(bench.journal_entries(), 1);
    bench.command(Command::Undo);
    assert_eq!(bench.statuses().matches('R').count(), 1, "one step");
}

#[test]
fn escape_leaves_the_sheet_and_then_the_selection() {
    let mut bench = Bench::new(imported_cameras(5));
    bench.select_to(4);
    bench.command(Command::Accept);
    bench.command(Command::Cancel);
    assert_eq!(bench.app.session.dialog, None);
    assert!(bench.app.accept_sheet().is_none());
    assert_eq!(bench.app.stretch_size(), Some(5));
    assert_eq!(bench.statuses(), "DDDDD");
    bench.command(Command::Cancel);
    assert_eq!(bench.app.stretch_size(), None);
    bench.command(Command::AcceptAndStay);
    assert_eq!(bench.statuses(), "RDDDD", "one frame again");
}

#[test]
fn a_stretch_with_nothing_to_accept_says_why_and_changes_nothing() {
    let mut bench = Bench::new(blank(6));
    bench.select_to(3);
    bench.command(Command::Accept);
    let (taken, left) = bench.taken_and_left();
    assert_eq!(taken, [0; 0]);
    assert_eq!(left, [(LeftReason::NoCamera, vec![0, 1, 2, 3])]);
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "NNNNNN");
    assert_eq!(
        bench.last_notice(),
        "None of the selected frames can be accepted together."
    );
    assert!(bench.app.open().unwrap().history.next_undo().is_none());
}

#[test]
fn the_list_stays_as_it_was_counted_while_the_sheet_is_open() {
    let mut document = imported_cameras(4);
    document.frames[1] = blank(4).frames[1].clone();
    let mut bench = Bench::new(document);
    bench.select_to(3);
    bench.command(Command::Accept);
    let before = bench.taken_and_left();
    assert_eq!(before.0, [0, 2, 3]);

    // The forest answers for the frame without a camera.
    let document = &bench.app.open().unwrap().document;
    let proposal = proposal_in(document, 1, 1, Some(-3.8));
    bench.act(Action::Trainer(TrainerReport::Proposals(vec![proposal])));
    assert_eq!(bench.statuses(), "DSDD");
    assert_eq!(bench.taken_and_left(), before);

    // The guide lies over it for a while.
    bench.command(Command::Guide);
    assert!(bench.app.accept_sheet().is_none());
    bench.act(Action::View(ViewAction::CloseDialog));
    assert_eq!(bench.taken_and_left(), before);

    // A frame that is taken out stays out.
    bench.act(Action::View(ViewAction::TickSuggestion {
        frame: 2,
        ticked: false,
    }));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "RSDR");
}

#[test]
fn what_speaks_against_a_frame_beside_the_paint_keeps_it_out() {
    let mut document = imported_cameras(6);
    let at = ImagePoint::new(900.0, 500.0);
    document.frames[0].clicks.push(Click::without_name(at));
    document.frames[1].status = FrameStatus::Rejected;
    let solution = document.frames[2].solution.as_mut().unwrap();
    solution.line_check = Some(paint(0.5));
    document.frames[3].status = FrameStatus::Suggested;
    let solution = document.frames[3].solution.as_mut().unwrap();
    (solution.source, solution.confidence) = (Some(SolutionSource::Forest), Some(0.3));
    let mut bench = Bench::new(document);
    bench.select_to(5);
    bench.command(Command::AcceptStretch);
    let (taken, left) = bench.taken_and_left();
    assert_eq!(taken, [4, 5]);
    assert_eq!(
        left,
        [
            (LeftReason::UnnamedPoint, vec![0]),
            (LeftReason::Unlikely, vec![3]),
            (LeftReason::PaintUndecided, vec![2]),
            (LeftReason::Rejected, vec![1]),
        ]
    );
}

#[test]
fn a_camera_out_of_line_with_its_neighbours_is_accepted_only_where_a_person_says_so() {
    let mut document = imported_cameras(5);
    document.frames[2].ptz = ptz_at(7.0, -14.0, 2300.0);
    let mut bench = Bench::new(document);
    bench.select_to(4);
    bench.command(Command::Accept);
    let bulk = bench.bulk();
    assert_eq!((bulk.ticked_rows().count(), bulk.left_out), (4, 1));
    bench.act(Action::View(ViewAction::SetWithDisagreeing(true)));
    assert_eq!(bench.bulk().ticked_rows().count(), 5);
    bench.act(Action::View(ViewAction::SetWithDisagreeing(false)));
    bench.act(Action::Edit(EditAction::AcceptAll));
    assert_eq!(bench.statuses(), "RRDRR");
}

#[test]
fn without_a_selection_there_is_no_stretch_and_hidden_frames_are_not_part_of_one() {
    let mut document = imported_cameras(5);
    document.frames[2].status = FrameStatus::Rejected;
    let mut bench = Bench::new(document);
    bench.command(Command::AcceptStretch);
    assert_eq!(
        bench.last_notice(),
        "No frames are selected: click with Shift on the filmstrip or the timeline."
    );
    bench.act(Action::View(ViewAction::SetFilter(Filter::ToDo)));
    bench.select_to(4);
    bench.command(Command::Accept);
    assert_eq!(bench.taken_and_left(), (vec![0, 1, 3, 4], Vec::new()));
}

#[test]
fn enter_on_a_single_frame_that_the_paint_contradicts_asks_first() {
    let mut document = imported_cameras(2);
    let solution = document.frames[0].solution.as_mut().unwrap();
    solution.line_check = Some(paint(0.01));
    let mut bench = Bench::new(document);
    bench.command(Command::Accept);
    assert_eq!(bench.statuses(), "DD");
    let notices = &bench.app.session.messages.notices;
    assert!(
        notices
            .iter()
            .any(|notice| notice.level == Level::Question && notice.offers(Command::AcceptAnyway)),
        "{notices:?}"
    );
    assert_eq!(
        next_step(&bench.app).text,
        "The painted lines lie elsewhere: drag a drawn line or ring to where it belongs."
    );
    // A click gives the frame another camera: the question is none any more.
    bench.click(ImagePoint::new(900.0, 500.0));
    assert!(!bench.app.session.offers(Command::AcceptAnyway));
    bench.command(Command::Cancel);
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    bench.command(Command::Accept);
    assert_eq!(bench.statuses(), "DD");
    bench.command(Command::AcceptAnyway);
    assert_eq!(bench.statuses(), "RD");
}
