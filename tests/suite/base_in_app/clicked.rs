//! The clicked frames that an estimate needs: counted, left out, mirrored, too few.

use super::{Fixture, document, visible};
use touchline::app::guidance::next_step;
use touchline::app::{Action, Command, EditAction, PointerAction};
use touchline::document::{Target, document_to_string};
use touchline::field::Symmetry;
use touchline_core::testing::soccer;

#[test]
fn without_a_base_guidance_counts_and_four_landmarks_name_the_next() {
    let mut fixture = Fixture::on(document(3, 0));
    assert!(
        next_step(&fixture.app)
            .text
            .starts_with("First the program must know where the camera stands.")
    );
    let (landmarks, last) = {
        let mut landmarks = visible(0);
        let last = landmarks.pop().unwrap();
        (landmarks, last)
    };
    for (count, (target, at)) in landmarks.into_iter().enumerate() {
        fixture.act(Action::Edit(EditAction::Pick(target)));
        fixture.act(Action::Pointer(PointerAction::Press { at, on: None }));
        fixture.act(Action::Pointer(PointerAction::Release));
        if count == 1 {
            assert!(
                next_step(&fixture.app)
                    .text
                    .starts_with("2 of 4 landmarks or lines here"),
                "{}",
                next_step(&fixture.app).text
            );
        }
    }
    let missing = fixture.app.missing_base().unwrap();
    assert_eq!(missing.views.into_iter().flatten().collect::<Vec<_>>(), [0]);
    assert!(
        fixture.app.current().preview.is_some(),
        "the lines show what four landmarks tell"
    );
    fixture.act(Action::Pointer(PointerAction::Press {
        at: last.1,
        on: None,
    }));
    fixture.act(Action::Pointer(PointerAction::Release));
    assert_eq!(
        fixture.app.frame().unwrap().clicks.last().unwrap().target,
        Some(last.0),
        "it names itself"
    );
}

#[test]
fn a_frame_is_left_out_and_put_back() {
    let mut fixture = Fixture::on(document(4, 4));
    fixture.act(Action::Edit(EditAction::UseForBase {
        frame: 1,
        used: false,
    }));
    let text = document_to_string(fixture.document()).unwrap();
    assert!(text.contains("\"use_for_base\": false"), "{text}");
    assert_eq!(
        (
            fixture.app.base_readiness().frames,
            fixture.app.base_readiness().left_out
        ),
        (3, 1)
    );
    fixture.estimate();
    assert_eq!(
        fixture
            .app
            .operations
            .base_estimate
            .proposed_base()
            .unwrap()
            .frames,
        [0, 2, 3]
    );
    fixture.command(Command::DropEstimatedBase);
    fixture.act(Action::Edit(EditAction::UseForBase {
        frame: 1,
        used: true,
    }));
    assert!(
        !document_to_string(fixture.document())
            .unwrap()
            .contains("use_for_base")
    );
    fixture.command(Command::UseForBase);
    assert!(
        !fixture.document().frames[0].use_for_base,
        "the command is about the shown frame"
    );
}

#[test]
fn a_mirrored_frame_is_found_and_mended_in_one_step() {
    let mut document = document(6, 6);
    let field = soccer();
    for click in &mut document.frames[2].clicks {
        let Some(Target::Landmark(id)) = &click.target else {
            continue;
        };
        let twin = Symmetry::MirrorX
            .landmark_twin(&field, field.landmark(id.as_str()).unwrap())
            .unwrap();
        click.target = Some(Target::Landmark(twin.id.clone()));
    }
    let mut fixture = Fixture::on(document);
    fixture.estimate();
    let mirrored = fixture
        .app
        .operations
        .base_estimate
        .proposed_base()
        .unwrap()
        .estimate
        .mirrored
        .clone();
    assert_eq!(
        mirrored
            .iter()
            .map(|mirrored| mirrored.frame)
            .collect::<Vec<_>>(),
        [2]
    );
    fixture.act(Action::Edit(EditAction::MirrorNames {
        frame: 2,
        symmetry: mirrored[0].symmetry,
    }));
    assert_eq!(fixture.app.session.frame, 2);
    let names: Vec<_> = fixture
        .app
        .frame()
        .unwrap()
        .clicks
        .iter()
        .map(|click| click.target.clone().unwrap())
        .collect();
    let right: Vec<_> = visible(2).into_iter().map(|(target, _)| target).collect();
    assert_eq!(names, right);
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .estimated_base()
            .unwrap()
            .estimate
            .mirrored
            .is_empty()
    );
}

#[test]
fn too_little_is_said_and_changes_nothing() {
    let mut fixture = Fixture::on(document(3, 0));
    fixture.estimate();
    assert!(
        fixture
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("Not enough points yet."))
    );
    let mut contradicting = document(3, 3);
    for frame in &mut contradicting.frames {
        let names: Vec<_> = frame
            .clicks
            .iter()
            .map(|click| click.target.clone())
            .collect();
        let count = names.len();
        for (index, click) in frame.clicks.iter_mut().enumerate() {
            click.target.clone_from(&names[(index * 5 + 3) % count]);
        }
    }
    let mut fixture = Fixture::on(contradicting);
    let before = document_to_string(fixture.document()).unwrap();
    fixture.estimate();
    assert!(
        fixture
            .app
            .operations
            .base_estimate
            .estimated_base()
            .is_none(),
        "{:?}",
        fixture.app.operations.base_estimate
    );
    assert!(
        fixture
            .app
            .session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("No base: "))
    );
    assert_eq!(document_to_string(fixture.document()).unwrap(), before);
}
