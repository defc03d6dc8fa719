//! What each command acts on.

use super::Command;

/// What a command acts on. It decides whether the command is available during a blind round or behind another page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The application itself: shows and changes no label.
    Application,
    /// The zoom: of the picture, or of the quality page's time axis.
    Zoom,
    /// A blind round.
    Round,
    /// The shown picture or the selection in it: not available while another page hides it.
    Picture,
    /// The document as a whole, another frame, a panel.
    Document,
}

impl CommandKind {
    /// Whether it is available during a blind round: it neither shows the label nor leaves the round.
    #[must_use]
    pub const fn is_blind(self) -> bool {
        matches!(self, Self::Application | Self::Zoom | Self::Round)
    }
}

impl Command {
    /// What it acts on.
    #[must_use]
    pub const fn kind(self) -> CommandKind {
        match self {
            Self::Save
            | Self::Quit
            | Self::Undo
            | Self::Cancel
            | Self::PauseTrainer
            | Self::SnapPoints
            | Self::SnapSuggestions
            | Self::BaseOnPaint
            | Self::Palette
            | Self::Keys
            | Self::Messages
            | Self::DismissNotices
            | Self::PictureLook
            | Self::Preferences
            | Self::Guide
            | Self::About => CommandKind::Application,
            Self::ZoomIn | Self::ZoomOut | Self::ZoomToFit => CommandKind::Zoom,
            Self::ClickAgain | Self::SkipAgain => CommandKind::Round,
            Self::DeleteClick
            | Self::RenameClick
            | Self::NameNext
            | Self::PlaceOnLine
            | Self::ToggleCheck
            | Self::NextClick
            | Self::PreviousClick
            | Self::Accept
            | Self::AcceptAndStay
            | Self::AcceptAnyway
            | Self::AcceptAllAbove
            | Self::UseForTraining
            | Self::MarkGold
            | Self::Reject
            | Self::RejectShot
            | Self::Comment
            | Self::MendNames
            | Self::SwitchRoot
            | Self::Snap
            | Self::SearchLines
            | Self::Track
            | Self::DiscardCarried
            | Self::StopTracking
            | Self::ZoomToClick
            | Self::HideOverlay
            | Self::OverlayStyle
            | Self::ShowMasks
            | Self::ShowFieldMap
            | Self::Compare
            | Self::Uncertainty
            | Self::ShowFeatures
            | Self::FindCamera
            | Self::StopFindCamera
            | Self::TryFirstCamera
            | Self::TryOtherCamera
            | Self::EstimateBase
            | Self::ShowForBase
            | Self::UseEstimatedBase
            | Self::DropEstimatedBase
            | Self::StopSolving
            | Self::StopSearch
            | Self::UseForBase
            | Self::AssignToCamera
            | Self::SelectShot
            | Self::AddCut
            | Self::MoveCutHere
            | Self::RemoveCut
            | Self::NewCameraFromChange
            | Self::KeepBurntIn
            | Self::ChangeBurntIn
            | Self::ConfirmFieldSize
            | Self::FitFieldSize => CommandKind::Picture,
            Self::OpenProject
            | Self::OpenFolder
            | Self::OpenVideo
            | Self::OpenDemo
            | Self::StartTour
            | Self::LeaveTour
            | Self::SaveAs
            | Self::Export
            | Self::ExportDataset
            | Self::Import
            | Self::Orphans
            | Self::Redo
            | Self::NextFrame
            | Self::PreviousFrame
            | Self::NextTenFrames
            | Self::PreviousTenFrames
            | Self::NextNeedsMe
            | Self::PreviousNeedsMe
            | Self::NextUnanswered
            | Self::FirstFrame
            | Self::LastFrame
            | Self::GoToPlace
            | Self::PlayPause
            | Self::NextShot
            | Self::PreviousShot
            | Self::FindShots
            | Self::StopShotSearch
            | Self::NextReference
            | Self::PreviousReference
            | Self::ChooseGold
            | Self::UseOwnNoise
            | Self::UseUsualNoise
            | Self::CompareAnnotators
            | Self::CameraPanel
            | Self::TrainerPanel
            | Self::ReviewPanel
            | Self::QualityPage
            | Self::ChooseSport
            | Self::LoadCamera => CommandKind::Document,
        }
    }
}
