//! The names that are suggested for a point, and the one that it gets.

use super::document;
use crate::bench::Bench;
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, Command, EditAction};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

#[test]
fn once_solved_a_third_click_takes_its_name_by_itself() {
    let mut bench = Bench::new(document(2, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.click(bench.image_of("centre_circle_halfway_near"));
    assert_eq!(
        bench.app.session.mode,
        Mode::Idle,
        "no list: one name is plausible"
    );
    let target = bench.frame().clicks[2].target.clone();
    assert_eq!(
        target,
        Some(Target::Landmark("centre_circle_halfway_near".into()))
    );
}

#[test]
fn the_names_suggested_for_the_second_click_put_the_right_one_first_beside_a_solved_neighbour() {
    let mut bench = Bench::new(document(3, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.command(Command::Accept);
    bench.click(bench.image_of("centre_mark"));
    if let Mode::Naming(naming) = &bench.app.session.mode {
        assert_eq!(naming.listed_candidates()[0].target.as_str(), "centre_mark");
        bench.act(Action::Edit(EditAction::TakeName(0)));
    }
    bench.click(bench.image_of("centre_circle_halfway_far"));
    let name = match &bench.app.session.mode {
        Mode::Naming(naming) => naming.listed_candidates()[0].target.clone(),
        _ => bench.frame().clicks[1].target.clone().unwrap(),
    };
    assert_eq!(name.as_str(), "centre_circle_halfway_far");
}

#[test]
fn in_a_new_shot_the_names_follow_where_the_camera_usually_looks() {
    let mut bench = Bench::new(document(6, true));
    for _ in 0..4 {
        bench.place("centre_mark");
        bench.place("halfway_far");
        bench.command(Command::Accept);
    }
    assert_eq!(
        bench.app.session.frame, 4,
        "the first frame of the second shot"
    );
    bench.click(bench.image_of("halfway_far"));
    let Mode::Naming(naming) = &bench.app.session.mode else {
        panic!("one click of a new shot is never certain")
    };
    assert!(
        naming
            .listed_candidates()
            .iter()
            .take(2)
            .any(|name| name.target.as_str() == "halfway_far"),
        "{naming:?}"
    );
    bench.act(Action::Edit(EditAction::Name {
        click: 0,
        target: Target::Landmark("halfway_far".into()),
    }));
    bench.click(bench.image_of("centre_circle_halfway_near"));
    let Mode::Naming(naming) = &bench.app.session.mode else {
        panic!("a camera of another shot vouches for no name")
    };
    assert_eq!(
        naming.listed_candidates()[0].target.as_str(),
        "centre_circle_halfway_near"
    );
}

#[test]
fn a_name_is_given_once_in_a_frame() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.act(Action::Edit(EditAction::Name {
        click: 1,
        target: Target::Landmark("centre_mark".into()),
    }));
    assert_eq!(
        bench.last_notice(),
        "Points 2 and 1 have swapped their names."
    );
    let named = |bench: &Bench, click: usize| bench.frame().clicks[click].target.clone();
    let [mark, far] = ["centre_mark", "halfway_far"].map(|id| Some(Target::Landmark(id.into())));
    assert_eq!([named(&bench, 0), named(&bench, 1)], [far, mark.clone()]);
    // A point without a name has none to give back.
    bench.click(ImagePoint::new(3.0, 3.0));
    bench.act(Action::Edit(EditAction::Name {
        click: 2,
        target: Target::Landmark("centre_mark".into()),
    }));
    bench.assert_notice("already point 2");
    assert_eq!([named(&bench, 1), named(&bench, 2)], [mark, None]);
}
