//! What the menus list, and in which order: sections, submenus, and the texts of their titles.
//! A command that is in no submenu is a row of its group's menu.

use touchline_application::app::{Command, MenuGroup};

/// Commands with a line above them.
pub(super) const SECTIONS: [Command; 12] = [
    Command::Save,
    Command::Quit,
    Command::Cancel,
    Command::Preferences,
    Command::PlayPause,
    Command::Comment,
    Command::HideOverlay,
    Command::Compare,
    Command::TrainerPanel,
    Command::CameraPanel,
    Command::KeepBurntIn,
    Command::About,
];

/// The command below which the submenu of recent documents stands: the last of the menu that opens
/// something.
pub(super) const RECENT_BELOW: Command = Command::OpenVideo;

/// Groups of commands that are submenus at the top of their menu. No menu is longer than twelve
/// rows.
const SUBMENUS: [(&str, &[Command]); 15] = [
    (
        "Open other",
        &[
            Command::OpenDemo,
            Command::AddNewImages,
            Command::Orphans,
            Command::StopExport,
            Command::ShowExported,
        ],
    ),
    (
        "Queue",
        &[
            Command::OpenQueue,
            Command::NextMatch,
            Command::PreviousMatch,
            Command::QueuePanel,
        ],
    ),
    (
        "Points",
        &[
            Command::DeleteClick,
            Command::RenameClick,
            Command::NameNext,
            Command::PlaceOnLine,
            Command::ToggleCheck,
            Command::NextClick,
            Command::PreviousClick,
            Command::RemoveModelPoints,
        ],
    ),
    (
        "Tools",
        &[
            Command::PointTool,
            Command::LineTool,
            Command::CheckTool,
            Command::SelectTool,
            Command::ShowMasks,
        ],
    ),
    (
        "Go to",
        &[
            Command::NextFrame,
            Command::PreviousFrame,
            Command::NextTenFrames,
            Command::PreviousTenFrames,
            Command::FirstFrame,
            Command::LastFrame,
            Command::GoToPlace,
            Command::NextNeedsMe,
            Command::PreviousNeedsMe,
            Command::NextUnanswered,
            Command::NextReference,
            Command::PreviousReference,
        ],
    ),
    (
        "Shots",
        &[
            Command::NextShot,
            Command::PreviousShot,
            Command::SelectShot,
            Command::FindShots,
            Command::StopShotSearch,
            Command::AddCut,
            Command::MoveCutHere,
            Command::RemoveCut,
            Command::ShotContent,
        ],
    ),
    (
        "Accept and reject",
        &[
            Command::Accept,
            Command::AcceptAndStay,
            Command::AcceptAnyway,
            Command::AcceptStretch,
            Command::AcceptShot,
            Command::AcceptAllAbove,
            Command::Gallery,
            Command::AcceptPlayed,
            Command::StopAtWrong,
            Command::Reject,
            Command::RejectShot,
        ],
    ),
    (
        "Lines and tracking",
        &[
            Command::Snap,
            Command::SearchLines,
            Command::StopSearch,
            Command::Track,
            Command::RefineBaseOnShot,
            Command::StopTracking,
            Command::MendCameras,
            Command::StopMending,
            Command::DiscardTracked,
            Command::DiscardBatch,
            Command::TakeLength,
        ],
    ),
    (
        "Gold frames",
        &[
            Command::MarkGold,
            Command::ChooseGold,
            Command::ClickAgain,
            Command::SkipAgain,
            Command::UseOwnNoise,
            Command::UseUsualNoise,
        ],
    ),
    (
        "Training",
        &[Command::UseForTraining, Command::PauseTrainer],
    ),
    (
        "Find without a click",
        &[
            Command::FindCameras,
            Command::StopFindCameras,
            Command::FindCamera,
            Command::StopFindCamera,
        ],
    ),
    (
        "Base",
        &[
            Command::EstimateBase,
            Command::BaseOnPaint,
            Command::ShowForBase,
            Command::UseEstimatedBase,
            Command::DropEstimatedBase,
            Command::StopSolving,
            Command::UseForBase,
        ],
    ),
    (
        "Field",
        &[
            Command::ChooseSport,
            Command::ConfirmFieldSize,
            Command::FitFieldSize,
        ],
    ),
    (
        "Map and curves",
        &[Command::ShowFieldMap, Command::ShowCurves],
    ),
    (
        "Zoom",
        &[
            Command::ZoomIn,
            Command::ZoomOut,
            Command::ZoomToFit,
            Command::ZoomToClick,
        ],
    ),
];

/// The tooltip of a menu.
pub(super) const fn tip(group: MenuGroup) -> &'static str {
    match group {
        MenuGroup::File => "Open, save, export.",
        MenuGroup::Edit => "Undo, and editing points.",
        MenuGroup::Frame => "Navigate, accept and reject frames.",
        MenuGroup::Camera => "The camera's base: estimate it, load it, enter it.",
        MenuGroup::View => "What is shown, and zoom.",
        MenuGroup::Help => "Commands, keys, about.",
    }
}

/// The submenus of a menu, with their titles.
pub(super) fn submenus(
    group: MenuGroup,
) -> impl Iterator<Item = (&'static str, &'static [Command])> {
    SUBMENUS
        .into_iter()
        .filter(move |(_, commands)| commands[0].group() == group)
}

/// The commands of a menu that are in no submenu.
pub(super) fn rows(group: MenuGroup) -> impl Iterator<Item = Command> {
    Command::all().filter(move |command| command.group() == group && !is_in_submenu(*command))
}

fn is_in_submenu(command: Command) -> bool {
    SUBMENUS
        .iter()
        .any(|(_, commands)| commands.contains(&command))
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::IntoEnumIterator as _;

    #[test]
    fn no_menu_is_longer_than_twelve_rows_and_lines_are_above_its_own_commands() {
        for group in MenuGroup::iter() {
            // The menu of files lists recent documents, too.
            let recent = rows(group).filter(|row| *row == RECENT_BELOW).count();
            assert_eq!(recent, usize::from(group == MenuGroup::File));
            let length = submenus(group).count() + rows(group).count() + recent;
            assert!(length <= 12, "{}: {length} rows", group.title());
        }
        for (title, commands) in SUBMENUS {
            assert!(commands.len() <= 12, "{title}: {} rows", commands.len());
            let group = commands[0].group();
            assert!(
                commands.iter().all(|command| command.group() == group),
                "{title}"
            );
        }
        let of_menus: Vec<Command> = MenuGroup::iter().flat_map(rows).collect();
        assert!(SECTIONS.iter().all(|command| of_menus.contains(command)));
    }
}
