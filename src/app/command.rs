//! What a user can ask for: the menu, the keys and the palette all list the same commands.
//!
//! A command is a wish without details ("undo", "next frame"); [`super::Action`] is what changes state. Every command
//! has a name, a sentence for its tooltip, a group and default keys; whether it makes sense right now is decided by
//! [`super::App::why_not`], so that a greyed-out entry can say why.

/// Something a user can ask for by menu, key or palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "each command is described by `Command::about`, which users read")]
pub enum Command {
    OpenProject,
    OpenFolder,
    OpenVideo,
    OpenDemo,
    Save,
    SaveAs,
    Export,
    Orphans,
    Quit,
    Undo,
    Redo,
    DeleteClick,
    RenameClick,
    PlaceOnLine,
    ToggleCheck,
    NextClick,
    PreviousClick,
    Cancel,
    NextFrame,
    PreviousFrame,
    NextTenFrames,
    PreviousTenFrames,
    NextNeedsMe,
    PreviousNeedsMe,
    NextUnanswered,
    NextReference,
    PreviousReference,
    Accept,
    AcceptAndStay,
    AcceptAllAbove,
    Teaches,
    MarkGold,
    ChooseGold,
    ClickAgain,
    SkipAgain,
    UseOwnNoise,
    UseUsualNoise,
    CompareAnnotators,
    Reject,
    RejectShot,
    Comment,
    MendNames,
    SwitchRoot,
    ZoomIn,
    ZoomOut,
    ZoomToFit,
    ZoomToClick,
    HideOverlay,
    OverlayStyle,
    ShowMasks,
    ShowFieldMap,
    Compare,
    Uncertainty,
    CameraPanel,
    TrainerPanel,
    PauseTrainer,
    ShowFeatures,
    ReviewPanel,
    QualityPage,
    EstimateBase,
    UseEstimatedBase,
    DropEstimatedBase,
    UseForBase,
    LoadCamera,
    GiveToCamera,
    SelectShot,
    NewCameraFromChange,
    ConfirmFieldSize,
    FitFieldSize,
    Palette,
    Keys,
    About,
}

/// Where a command stands in the menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the menu's own titles")]
pub enum MenuGroup {
    File,
    Edit,
    Frame,
    Camera,
    View,
    Help,
}

impl MenuGroup {
    /// Every menu, in order.
    pub const ALL: [Self; 6] = [Self::File, Self::Edit, Self::Frame, Self::Camera, Self::View, Self::Help];

    /// The menu's title.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Frame => "Frame",
            Self::Camera => "Camera",
            Self::View => "View",
            Self::Help => "Help",
        }
    }
}

/// What a command acts on: whether it may be asked for while something else has the window follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The application itself: it shows no label and changes none.
    Application,
    /// The scale of what is shown: the picture, or the time axis of the quality page.
    Zoom,
    /// A blind round.
    Round,
    /// The shown picture, or what is selected in it: not while another page hides it.
    Picture,
    /// The document as a whole, another frame, a panel.
    Document,
}

impl CommandKind {
    /// Whether it may be asked for during a blind round: it neither shows the label nor leads away from the round.
    #[must_use]
    pub const fn is_blind(self) -> bool {
        matches!(self, Self::Application | Self::Zoom | Self::Round)
    }
}

/// A row of the table of commands.
struct Row {
    command: Command,
    id: &'static str,
    group: MenuGroup,
    name: &'static str,
    about: &'static str,
    keys: &'static [&'static str],
}

macro_rules! rows {
    ($($command:ident, $id:literal, $group:ident, $name:literal, $about:literal, [$($key:literal),*];)*) => {
        const ROWS: &[Row] = &[$(Row {
            command: Command::$command, id: $id, group: MenuGroup::$group, name: $name, about: $about, keys: &[$($key),*],
        },)*];
    };
}

rows! {
    OpenProject, "open_project", File, "Open project…", "Open a project folder, a project.json or a dataset file.", ["Ctrl+O"];
    OpenFolder, "open_folder", File, "Open folder of frames…", "Start a project from a folder of images, or go on with it.", ["Ctrl+Shift+O"];
    OpenVideo, "open_video", File, "Open video…", "Start a project from a video, or go on with it.", ["Ctrl+Alt+O"];
    OpenDemo, "open_demo", File, "Try the demo match", "Open a drawn match to try the two clicks on (2 minutes).", [];
    Save, "save", File, "Save now", "Write project.json now. Every edit is already in the journal.", ["Ctrl+S"];
    SaveAs, "save_as", File, "Save a copy…", "Write the project into another folder; file paths keep pointing at the same files.", ["Ctrl+Shift+S"];
    Export, "export", File, "Export dataset…", "Write the labelled frames as one JSON file.", ["Ctrl+E"];
    Orphans, "orphans", File, "Edits set aside…", "Edits made to another version of this document: take them in, or keep them as a document of their own.", [];
    Quit, "quit", File, "Quit", "Save and close the window.", ["Ctrl+Q"];
    Undo, "undo", Edit, "Undo", "Take back the last change; one on another frame is gone to first.", ["Ctrl+Z"];
    Redo, "redo", Edit, "Redo", "Do again what was taken back.", ["Ctrl+Shift+Z", "Ctrl+Y"];
    DeleteClick, "delete_click", Edit, "Delete point", "Delete the selected point.", ["Delete"];
    RenameClick, "rename_click", Edit, "Name point…", "Give the selected point another name.", ["C"];
    PlaceOnLine, "place_on_line", Edit, "Point on a line", "The next or the selected point lies on a line of the field, not on a landmark.", ["L"];
    ToggleCheck, "toggle_check", Edit, "Check point", "Hold the selected point out of the solve; its error is shown instead.", ["K"];
    NextClick, "next_click", Edit, "Next point", "Select the next point of this frame.", ["Tab"];
    PreviousClick, "previous_click", Edit, "Previous point", "Select the previous point of this frame.", ["Shift+Tab"];
    Cancel, "cancel", Edit, "Cancel", "Leave what is begun; then deselect.", ["Escape"];
    NextFrame, "next_frame", Frame, "Next frame", "Step one frame; held down it plays.", ["Period"];
    PreviousFrame, "previous_frame", Frame, "Previous frame", "Step one frame back.", ["Comma"];
    NextTenFrames, "next_ten_frames", Frame, "Ten frames on", "Step ten frames.", ["Shift+Period"];
    PreviousTenFrames, "previous_ten_frames", Frame, "Ten frames back", "Step ten frames back.", ["Shift+Comma"];
    NextNeedsMe, "next_needs_me", Frame, "Next frame that needs me", "Go to the next frame that somebody has to look at; along the list while the review panel is open.", ["N"];
    PreviousNeedsMe, "previous_needs_me", Frame, "Previous frame that needs me", "Go to the previous frame that somebody has to look at.", ["Shift+N"];
    NextUnanswered, "next_unanswered", Frame, "Where to label next", "Go to the frame whose label helps most of those without an answer, or without a sure one.", [];
    NextReference, "next_reference", Frame, "Next reference", "Go to the next accepted frame.", ["R"];
    PreviousReference, "previous_reference", Frame, "Previous reference", "Go to the previous accepted frame.", ["Shift+R"];
    Accept, "accept", Frame, "Accept and next", "Make this frame a reference and go to the next that needs you.", ["Enter"];
    AcceptAndStay, "accept_and_stay", Frame, "Accept and stay", "Make this frame a reference and stay on it.", ["Shift+Enter"];
    AcceptAllAbove, "accept_all_above", Frame, "Accept all above…", "Accept every suggestion that is certain enough, after a look at what they are; one step of undo.", ["Ctrl+Enter"];
    Teaches, "teaches", Frame, "This reference teaches", "The forest learns from this reference. Accepted suggestions do not teach unless you say so.", [];
    Reject, "reject", Frame, "Not calibratable…", "Mark this frame as not calibratable, with the reason (1–6).", ["X"];
    RejectShot, "reject_shot", Frame, "Whole shot not calibratable…", "Mark every frame of this shot as not calibratable, with the reason (1–6).", ["Shift+X"];
    Comment, "comment", Frame, "Comment…", "Write a comment on this frame.", ["Ctrl+M"];
    MendNames, "mend_names", Frame, "Take the names that fit", "Where other names fit the points better, or as well: swap, exchange or rename them.", [];
    SwitchRoot, "switch_root", Frame, "Switch to the other focal length", "Where two focal lengths fit the two clicks, use the other one.", [];
    ZoomIn, "zoom_in", View, "Zoom in", "Enlarge the picture.", ["Plus", "Equals"];
    ZoomOut, "zoom_out", View, "Zoom out", "Show more of the picture.", ["Minus"];
    ZoomToFit, "zoom_to_fit", View, "Fit", "Show the whole picture.", ["F"];
    ZoomToClick, "zoom_to_click", View, "Zoom to the point", "Show the selected point at 800 %.", ["Z"];
    HideOverlay, "hide_overlay", View, "Hide overlay (hold)", "While held down the overlay is hidden.", ["H"];
    OverlayStyle, "overlay_style", View, "Overlay style…", "Colour, width and opacity of the field's lines.", ["O"];
    ShowMasks, "show_masks", View, "Masks", "Show the boxes whose pixels give no features, and draw new ones.", ["M"];
    ShowFieldMap, "show_field_map", View, "Field map", "Show or fold the field map.", ["G"];
    Compare, "compare", View, "Compare (hold)", "While held down the other solution is drawn dashed: the other focal length, or the camera under other names.", ["B"];
    Uncertainty, "uncertainty", View, "Uncertainty", "How far the lines are to be trusted: a 1-σ band around them, a heat map, off.", ["U"];
    CameraPanel, "camera_panel", Camera, "Camera panel", "Position, base rotation, lens and masks of this frame's camera.", ["F2"];
    TrainerPanel, "trainer_panel", View, "Trainer panel", "What the forest learns from, what it is worth, and where a reference is missing.", ["F3"];
    PauseTrainer, "pause_trainer", Frame, "Pause the trainer", "No training and no proposals in the background until it is resumed.", [];
    ShowFeatures, "show_features", View, "Features", "Show the features of this frame: those that look like the references, and those that agree on its camera.", [];
    ReviewPanel, "review_panel", View, "Review panel", "What is proposed, by confidence, by disagreement between neighbours or by time.", ["F4"];
    QualityPage, "quality_page", View, "Quality page", "How good labels and proposals are: the camera over time, errors at points, where references look.", ["F5"];
    CompareAnnotators, "compare_annotators", View, "Compare two annotators…", "Choose another annotator's document of the same frames and see on the quality page how far you agree.", [];
    EstimateBase, "estimate_base", Camera, "Estimate the base from these frames", "Find out where the camera stands from the points of all its frames.", [];
    UseEstimatedBase, "use_estimated_base", Camera, "Use the estimated base", "Take the estimated base over and solve every frame with it.", [];
    DropEstimatedBase, "drop_estimated_base", Camera, "Discard the estimated base", "Keep the base as it is, or stop the estimation.", [];
    UseForBase, "use_for_base", Camera, "Leave this frame out of the base", "This frame's points take no part in the estimation of the base, or take part again.", [];
    LoadCamera, "load_camera", Camera, "Load a camera…", "Take the camera base from another project or dataset.", [];
    GiveToCamera, "give_to_camera", Camera, "Give frames to a camera…", "Say which camera took this frame, the selected frames, the shot, or all from here on.", [];
    NewCameraFromChange, "new_camera_from_change", Camera, "New camera from where it stopped fitting", "Where somebody moved the camera, the frames from there on get a camera of their own.", [];
    ConfirmFieldSize, "confirm_field_size", Camera, "Confirm the field's size", "Length and width are right; until then they are assumed, and the dataset says so.", [];
    FitFieldSize, "fit_field_size", Camera, "Fit the field's size to the points", "Find length and width together with the base, within what the rules allow; with few frames they are unsure.", [];
    SelectShot, "select_shot", Frame, "Select this shot", "Select every frame of this shot; Shift or Ctrl and a click on the filmstrip select single ones.", [];
    MarkGold, "mark_gold", Frame, "Gold frame", "This reference is clicked again later, without a look at its label: that shows how far your hand scatters.", [];
    ChooseGold, "choose_gold", Frame, "Choose gold frames", "Make a few references gold, spread over pan and landmarks; one step of undo.", [];
    ClickAgain, "click_again", Frame, "Click gold frames again…", "A blind round: the points of the gold frames are asked for one after another, their labels and lines hidden. Labels stay as they are.", [];
    SkipAgain, "skip_again", Frame, "Skip this point of the blind round", "It cannot be seen well enough; the round goes on with the next.", ["Shift+S"];
    UseOwnNoise, "use_own_noise", Frame, "Weigh points by my click noise", "What your blind clicks show takes the place of everybody's click noise wherever points are solved; one step of undo.", [];
    UseUsualNoise, "use_usual_noise", Frame, "Use the usual click noise", "Points are weighted by the field template's click noise again; yours stays in the project.", [];
    Palette, "palette", Help, "Command palette…", "Find any command by typing.", ["Ctrl+K"];
    Keys, "keys", Help, "Keys", "Every command and its key; keys can be changed here.", ["?"];
    About, "about", Help, "About", "Version, licence, citation and a diagnostic report.", [];
}

impl Command {
    /// Every command, in the order of the menus.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.command)
    }

    fn row(self) -> &'static Row {
        // The table's order need not be the enum's; it is short.
        ROWS.iter().find(|row| row.command == self).unwrap_or(&ROWS[0])
    }

    /// The stable name in the settings file.
    #[must_use]
    pub fn id(self) -> &'static str {
        self.row().id
    }

    /// The command of a stable name.
    #[must_use]
    pub fn from_id(id: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.id == id).map(|row| row.command)
    }

    /// What the menu says.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// What the tooltip says.
    #[must_use]
    pub fn about(self) -> &'static str {
        self.row().about
    }

    /// The menu it stands in.
    #[must_use]
    pub fn group(self) -> MenuGroup {
        self.row().group
    }

    /// The keys it has unless the user changes them.
    #[must_use]
    pub fn default_keys(self) -> &'static [&'static str] {
        self.row().keys
    }

    /// What it acts on.
    #[must_use]
    pub const fn kind(self) -> CommandKind {
        match self {
            Self::Save
            | Self::Quit
            | Self::Undo
            | Self::Cancel
            | Self::PauseTrainer
            | Self::Palette
            | Self::Keys
            | Self::About => CommandKind::Application,
            Self::ZoomIn | Self::ZoomOut | Self::ZoomToFit => CommandKind::Zoom,
            Self::ClickAgain | Self::SkipAgain => CommandKind::Round,
            Self::DeleteClick
            | Self::RenameClick
            | Self::PlaceOnLine
            | Self::ToggleCheck
            | Self::NextClick
            | Self::PreviousClick
            | Self::Accept
            | Self::AcceptAndStay
            | Self::AcceptAllAbove
            | Self::Teaches
            | Self::MarkGold
            | Self::Reject
            | Self::RejectShot
            | Self::Comment
            | Self::MendNames
            | Self::SwitchRoot
            | Self::ZoomToClick
            | Self::HideOverlay
            | Self::OverlayStyle
            | Self::ShowMasks
            | Self::ShowFieldMap
            | Self::Compare
            | Self::Uncertainty
            | Self::ShowFeatures
            | Self::EstimateBase
            | Self::UseEstimatedBase
            | Self::DropEstimatedBase
            | Self::UseForBase
            | Self::GiveToCamera
            | Self::SelectShot
            | Self::NewCameraFromChange
            | Self::ConfirmFieldSize
            | Self::FitFieldSize => CommandKind::Picture,
            Self::OpenProject
            | Self::OpenFolder
            | Self::OpenVideo
            | Self::OpenDemo
            | Self::SaveAs
            | Self::Export
            | Self::Orphans
            | Self::Redo
            | Self::NextFrame
            | Self::PreviousFrame
            | Self::NextTenFrames
            | Self::PreviousTenFrames
            | Self::NextNeedsMe
            | Self::PreviousNeedsMe
            | Self::NextUnanswered
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
            | Self::LoadCamera => CommandKind::Document,
        }
    }

    /// Acts for as long as its key is held down.
    #[must_use]
    pub const fn is_held(self) -> bool {
        matches!(self, Self::HideOverlay | Self::Compare)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_command_has_one_row_an_id_and_words() {
        let ids: BTreeSet<_> = Command::all().map(Command::id).collect();
        assert_eq!(ids.len(), Command::all().count());
        for command in Command::all() {
            assert_eq!(command.row().command, command, "{command:?} has no row");
            assert_eq!(Command::from_id(command.id()), Some(command));
            assert!(command.about().ends_with('.') || command.about().ends_with(')'), "{command:?}");
        }
    }
}
