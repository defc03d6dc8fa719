//! The kind of each action.

use super::transfer::TransferAction;
use super::{Action, VideoAction};

/// The kind of an action. It decides whether the action is allowed while something else is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionKind {
    /// A command; see [`super::Command::kind`].
    Command,
    /// The pointer over the picture: what has been begun decides what it means.
    Pointer,
    /// How something is shown, nothing of a label.
    View,
    /// Another frame or click is shown, or more of the label.
    Navigation,
    /// The document changes.
    Edit,
    /// Something is asked of the outside (disk, jobs), has come to an end there, or tells how far it is.
    Report,
    /// What belongs to the user and not to the document.
    Settings,
}

impl ActionKind {
    /// Whether it is allowed during a blind round: it changes and shows no label and does not leave the round. For a command its
    /// own kind decides.
    #[must_use]
    pub const fn is_blind(self) -> bool {
        !matches!(self, Self::Edit | Self::Navigation)
    }
}

impl Action {
    /// What it is.
    #[must_use]
    pub const fn kind(&self) -> ActionKind {
        match self {
            Self::Command(_) => ActionKind::Command,
            Self::Hover(_) | Self::Press { .. } | Self::Drag(_) | Self::Release | Self::ReleaseExactly => {
                ActionKind::Pointer
            }
            Self::Video(VideoAction::SetSpeed(_) | VideoAction::Pause)
            | Self::View(_)
            | Self::FitScale(_)
            | Self::SelectNoFrames
            | Self::SetFilter(_)
            | Self::HoldReview(_)
            | Self::SetReviewOrder(_)
            | Self::SetReviewThreshold(_)
            | Self::SetWithDisagreeing(_)
            | Self::TickSuggestion { .. }
            | Self::SetOnePerShot(_)
            | Self::SetQualityCamera(_)
            | Self::SetTimeAxis(_)
            | Self::ShowSpan(_)
            | Self::ReadFailedTemplatesAgain
            | Self::CloseDialog
            | Self::ShowGuidePage(_)
            | Self::DismissNotice(_)
            | Self::Notify(..)
            | Self::TypePath(_) => ActionKind::View,
            Self::Video(VideoAction::GoToPlace(_))
            | Self::Hold(..)
            | Self::Select(_)
            | Self::GoTo(_)
            | Self::SelectFrame { .. }
            | Self::AskCamera(_)
            | Self::LookAt { .. }
            | Self::TypeName(_)
            | Self::RefineName(_)
            | Self::ConfirmName
            | Self::HighlightName(_)
            | Self::OfferLines(_) => ActionKind::Navigation,
            Self::Transfer(TransferAction::TakeOver)
            | Self::Video(VideoAction::MoveCut { .. })
            | Self::Nudge { .. }
            | Self::TakeName(_)
            | Self::Pick(_)
            | Self::Name { .. }
            | Self::DeleteClick(_)
            | Self::SetCheck { .. }
            | Self::AssignToCamera { .. }
            | Self::RejectAs(_)
            | Self::SetComment(_)
            | Self::AddMask { .. }
            | Self::ScopeMask { .. }
            | Self::RemoveMask { .. }
            | Self::BeginEdit(_)
            | Self::EditPtz(_)
            | Self::EditCamera(_)
            | Self::EditField(_)
            | Self::ChooseSport(_)
            | Self::EndEdit
            | Self::AbortEdit
            | Self::SolveAgain
            | Self::AcceptAll
            | Self::SetUseForTraining { .. }
            | Self::UseForBase { .. }
            | Self::MirrorNames { .. } => ActionKind::Edit,
            Self::Video(_)
            | Self::Proposals(_)
            | Self::CarriedProposals(_)
            | Self::Trainer(_)
            | Self::Features(_)
            | Self::Report(_)
            | Self::Transfer(_)
            | Self::Compare(_)
            | Self::Answer(..)
            | Self::Open(_)
            | Self::Progress(_)
            | Self::Opened(_)
            | Self::TemplateRead { .. }
            | Self::Failed(_)
            | Self::CameraLoaded(_)
            | Self::Saved { .. }
            | Self::SaveFailed(_)
            | Self::AlreadyOpen(_)
            | Self::WholeWanted
            | Self::ChangedOutside { .. }
            | Self::AskOutside
            | Self::ResolveOutside(_)
            | Self::Outside(_)
            | Self::MergeOrphan(_)
            | Self::OrphanRead { .. }
            | Self::SaveOrphan(_)
            | Self::OrphanSaved { .. }
            | Self::OrphanPutAway { .. }
            | Self::LeaveUnsaved
            | Self::Copied(_)
            | Self::CloseRequested => ActionKind::Report,
            Self::SetOverlayStyle(_)
            | Self::SetTheme(_)
            | Self::SetLineColour(..)
            | Self::SetLoupe(_)
            | Self::SetPictureMemory(_)
            | Self::SetPictureLook(_)
            | Self::SetTextSize(_)
            | Self::SetPanelSizes { .. }
            | Self::AssignKey(..)
            | Self::ResetKeys
            | Self::SetDetails(_) => ActionKind::Settings,
        }
    }
}
