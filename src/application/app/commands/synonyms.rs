//! Other words by which users may search for a command.

use crate::app::Command;

/// Words that find a command in addition to its name; empty if there are none.
pub const fn synonyms(command: Command) -> &'static str {
    use Command as C;
    match command {
        C::ChooseSport => {
            "pitch court rink field template soccer football basketball NBA FIBA NCAA ice hockey NHL tennis volleyball handball futsal badminton pickleball padel own editor draw"
        }
        C::ConfirmFieldSize | C::FitFieldSize => "pitch dimensions length width",
        C::Accept | C::AcceptAndStay => "approve confirm reference keyframe",
        C::AcceptAllAbove => "bulk approve batch confidence",
        C::AcceptPlayed | C::StopAtWrong => "review approve watch playback",
        C::AcceptStretch => "bulk approve range span selection",
        C::Reject | C::RejectShot => "skip discard unusable close-up replay",
        C::DeleteClick => "remove landmark keypoint",
        C::RenameClick => "rename relabel landmark keypoint",
        C::PointTool | C::SelectTool | C::CheckTool => "tool mode",
        C::LineTool => "tool mode line point touchline",
        C::PlaceOnLine => "line point touchline",
        C::ToggleCheck => "hold out validation",
        C::EstimateBase => "calibrate position extrinsics bundle adjustment",
        C::LoadCamera => "base extrinsics import camera",
        C::CameraPanel => "position rotation lens distortion intrinsics principal point masks",
        C::TrainerPanel | C::PauseTrainer => "forest learn model training relocalization",
        C::OpenQueue | C::NextMatch | C::PreviousMatch | C::QueuePanel => {
            "batch clips several videos games playlist"
        }
        C::ReviewPanel => "suggestions proposals list",
        C::Gallery => "thumbnails contact sheet overview grid approve",
        C::QualityPage => "statistics errors residuals report",
        C::Track | C::DiscardTracked | C::StopTracking | C::RefineBaseOnShot => {
            "propagate interpolate carry follow tracking"
        }
        C::MendCameras | C::StopMending => "repair fix correct calibration import",
        C::DiscardBatch => "remove delete proposals suggested reject all",
        C::RemoveModelPoints => "delete keypoints network predictions pre-labels",
        C::FindCamera => "automatic zero clicks",
        C::FindCameras | C::StopFindCameras => "automatic match whole calibrate shots",
        C::Snap | C::SearchLines | C::SnapPoints | C::SnapSuggestions => {
            "refine lines paint register"
        }
        C::Export => "save as format JSON CSV SoccerNet COCO",
        C::ExportDataset => "training set images splits",
        C::Import => "load annotations labels",
        C::OverlayStyle => "colour color lines opacity width",
        C::PictureLook => "exposure gamma lighten darken dark bright",
        C::ShowMasks | C::KeepBurntIn | C::ChangeBurntIn => "ignore logo score bug watermark",
        C::Keys => "shortcuts hotkeys keyboard bindings",
        C::Guide => "help manual documentation tutorial glossary",
        C::StartTour => "tutorial introduction learn getting started onboarding",
        C::Preferences => "settings options configuration font size text telemetry cache",
        C::Messages | C::DismissNotices => "notifications warnings history log",
        C::NextNeedsMe | C::PreviousNeedsMe => "needs me todo unfinished",
        C::NextUnanswered => "unanswered no answer",
        C::FindShots | C::AddCut | C::MoveCutHere | C::RemoveCut => "scene split shot boundary",
        C::ShotContent => "close-up crowd replay kind",
        C::AcceptShot => "bulk approve scene",
        C::GoToPlace => "jump seek time frame number",
        C::AssignToCamera | C::NewCameraFromChange => "second camera",
        C::Undo => "back revert",
        C::Palette => "search command",
        C::Quit => "exit close",
        _ => "",
    }
}
