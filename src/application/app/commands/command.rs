//! Commands: what the user can start by menu, key or palette. All three list the same commands.
//!
//! A command has no arguments ("undo", "next frame"). Each has a name, a sentence for its tooltip,
//! a menu, a kind, what it needs and default keys, in one table. [`crate::app::App::why_not`] decides
//! whether a command is available, and why not. An [`crate::app::Action`] is more general: it has
//! arguments, and one of its variants is a command.

/// What a command acts on. Determines whether the command is available during a blind round, or
/// while another page covers the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// The application itself; labels are neither shown nor changed.
    Application,
    /// The zoom, of the picture or of the quality page's time axis.
    Zoom,
    /// A blind round.
    Round,
    /// The shown picture or the selection in it; not available while another page covers it.
    Picture,
    /// The document as a whole, another frame, a panel.
    Document,
}

impl CommandKind {
    /// Whether the command is available during a blind round, because it neither shows the label
    /// nor leaves the round.
    pub const fn is_blind(self) -> bool {
        matches!(self, Self::Application | Self::Zoom | Self::Round)
    }
}

/// What must be there for a command to be available, beside conditions of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CommandNeeds {
    Nothing,
    /// An open document.
    Document,
    /// A frame that is shown.
    Frame,
    /// A point that is selected.
    Point,
}

/// The menu that lists a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr, strum::EnumIter)]
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
    /// The menu's title.
    pub fn title(self) -> &'static str {
        self.into()
    }
}

/// A row of the table of commands.
struct CommandRow {
    command: Command,
    id: &'static str,
    group: MenuGroup,
    kind: CommandKind,
    needs: CommandNeeds,
    name: &'static str,
    about: &'static str,
    keys: &'static [&'static str],
}

macro_rules! rows {
    ($($command:ident, $id:literal, $group:ident, $kind:ident, $needs:ident, $name:literal, $about:literal, [$($key:literal),*];)*) => {
        /// Something that the user can start by menu, key or palette.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Command {
            $(#[doc = $about] $command,)*
        }

        /// The rows, in the order of [`Command`].
        const ROWS: &[CommandRow] = &[$(CommandRow {
            command: Command::$command, id: $id, group: MenuGroup::$group, kind: CommandKind::$kind,
            needs: CommandNeeds::$needs, name: $name, about: $about, keys: &[$($key),*],
        },)*];
    };
}

rows! {
    OpenProject, "open_project", File, Document, Nothing, "Open project…", "Open a project folder, a project.json or a dataset file.", ["Ctrl+O"];
    OpenFolder, "open_folder", File, Document, Nothing, "Open folder of frames…", "Start a project from a folder of images, or continue it.", ["Ctrl+Shift+O"];
    OpenVideo, "open_video", File, Document, Nothing, "Open video…", "Start a project from a video, or continue it.", ["Ctrl+Alt+O"];
    OpenQueue, "open_queue", File, Document, Nothing, "Open queue…",
        "Open a queue of matches, or of frames of a season: the next frame to do is then the next \
         of all its matches.",
        [];
    NextMatch, "next_match", File, Document, Nothing, "Next match",
        "Save, and open the next match of the queue.",
        ["Ctrl+PageDown"];
    PreviousMatch, "previous_match", File, Document, Nothing, "Previous match",
        "Save, and open the previous match of the queue.",
        ["Ctrl+PageUp"];
    QueuePanel, "queue_panel", File, Document, Nothing, "Queue panel",
        "Show or hide the matches of the queue beside the picture.",
        ["F6"];
    OpenDemo, "open_demo", File, Document, Nothing, "Try the demo match",
        "Open a synthetic match and try the two-click method (2 minutes).",
        [];
    Save, "save", File, Application, Document, "Save now",
        "Write project.json now. Every edit is already in the journal.",
        ["Ctrl+S"];
    SaveAs, "save_as", File, Document, Document, "Save a copy…",
        "Write the project to another folder; its paths keep pointing at the same files.",
        ["Ctrl+Shift+S"];
    Import, "import", File, Document, Document, "Import labels…", "Read clicks or cameras from another program, preview them, and merge them into this document. One step of undo.", [];
    Export, "export", File, Document, Document, "Export…", "Write the document in one of many formats; anything that a format cannot hold is listed first.", ["Ctrl+E"];
    ExportDataset, "export_dataset", File, Document, Document, "Export dataset…", "Write a folder with pictures, labels, splits, a card and a manifest.", ["Ctrl+Shift+E"];
    StopExport, "stop_export", File, Application, Frame, "Stop the export", "End the export or dataset that is being written; nothing is written.", [];
    ShowExported, "show_exported", File, Application, Frame, "Show the last export", "Open the folder of the last export in the system's file manager.", [];
    AddNewImages, "add_new_images", File, Document, Frame, "Add new images", "Add the images that came to the folder of the frames since the project was made. One step of undo.", [];
    Orphans, "orphans", File, Document, Document, "Edits set aside…", "Edits that were made to another version of this document: merge them, or keep them as a separate document.", [];
    Quit, "quit", File, Application, Nothing, "Quit", "Save and close the window.", ["Ctrl+Q"];
    Undo, "undo", Edit, Application, Document, "Undo", "Undo the last change. If it is on another frame, the first press goes to that frame.", ["Ctrl+Z"];
    Redo, "redo", Edit, Document, Document, "Redo", "Redo the last change that was undone.", ["Ctrl+Shift+Z", "Ctrl+Y"];
    DeleteClick, "delete_click", Edit, Picture, Point, "Delete point", "Delete the selected point.", ["Delete"];
    RenameClick, "rename_click", Edit, Picture, Point, "Name point…", "Give the selected point another name.", ["C"];
    NameNext, "name_next", Edit, Picture, Frame, "Name the next point…", "Go to the first point of this frame that has no name, and name it.", [];
    PointTool, "point_tool", Edit, Picture, Frame, "Place points",
        "A press in the picture places a point, or drags the point, landmark or line under it.",
        ["A"];
    SelectTool, "select_tool", Edit, Picture, Frame, "Select and move",
        "A press in the picture selects or drags a point, or moves the picture; it places none.",
        ["V"];
    LineTool, "line_tool", Edit, Picture, Frame, "Place points on lines",
        "Every point that you place lies on a line of the field, not on a landmark.",
        ["Shift+L"];
    CheckTool, "check_tool", Edit, Picture, Frame, "Place check points",
        "Every point that you place is a check point: left out of the solve, its error shown.",
        ["Shift+K"];
    ShowMasks, "show_masks", Edit, Picture, Frame, "Draw masks",
        "Show the boxes that are excluded from feature detection, and draw new ones.",
        ["M"];
    PlaceOnLine, "place_on_line", Edit, Picture, Frame, "Point on a line",
        "Mark the next or the selected point as lying on a line of the field, not on a landmark.",
        ["L"];
    ToggleCheck, "toggle_check", Edit, Picture, Point, "Check point",
        "Leave the selected point out of the solve and show its error instead.",
        ["K"];
    NextClick, "next_click", Edit, Picture, Frame, "Next point",
        "Select the next point of this frame.",
        ["Tab"];
    PreviousClick, "previous_click", Edit, Picture, Frame, "Previous point",
        "Select the previous point of this frame.",
        ["Shift+Tab"];
    Cancel, "cancel", Edit, Application, Nothing, "Cancel", "Cancel the current action, or deselect.", ["Escape"];
    Preferences, "preferences", Edit, Application, Nothing, "Preferences…", "Size of texts, panels, snapping, overlay, keys: what belongs to you and not to a project.", ["Ctrl+Comma"];
    NextFrame, "next_frame", Frame, Document, Frame, "Next frame", "Go one frame forward; hold to play.", ["Period"];
    PreviousFrame, "previous_frame", Frame, Document, Frame, "Previous frame", "Go one frame back.", ["Comma"];
    NextTenFrames, "next_ten_frames", Frame, Document, Frame, "Ten frames forward", "Go ten frames forward.", ["Shift+Period"];
    PreviousTenFrames, "previous_ten_frames", Frame, Document, Frame, "Ten frames back", "Go ten frames back.", ["Shift+Comma"];
    NextNeedsMe, "next_needs_me", Frame, Document, Frame, "Next frame to do", "Go to the next frame that is neither accepted nor rejected; in the order of the list while the review panel is open.", ["N"];
    PreviousNeedsMe, "previous_needs_me", Frame, Document, Frame, "Previous frame to do", "Go to the previous frame that is neither accepted nor rejected.", ["Shift+N"];
    NextUnanswered, "next_unanswered", Frame, Document, Frame, "Where to label next", "Go to the frame whose label would help most frames without a confident proposal.", [];
    FirstFrame, "first_frame", Frame, Document, Frame, "First frame", "Go to the first frame, number 0.", ["Home"];
    LastFrame, "last_frame", Frame, Document, Frame, "Last frame", "Go to the last frame.", ["End"];
    GoToPlace, "go_to_place", Frame, Document, Frame, "Go to frame or time…", "Type a frame's number or a time: 500 or 1:23.4.", ["Ctrl+G"];
    PlayPause, "play_pause", Frame, Document, Frame, "Play or pause", "Play the video at its own rate, or at the speed beside the timeline.", ["P"];
    AcceptPlayed, "accept_played", Frame, Document, Frame, "Accept what was played",
        "Accept the suggestions that were played since the video was started, or since a jump in \
         it. One step of undo.",
        ["Shift+P"];
    StopAtWrong, "stop_at_wrong", Frame, Document, Frame, "Wrong from here",
        "Stop the video where the lines begin to be off: what was played before is accepted, the \
         frames from here on wait. One step of undo.",
        ["W"];
    NextShot, "next_shot", Frame, Document, Frame, "Next shot", "Go to the first frame of the next shot of this video.", ["PageDown"];
    PreviousShot, "previous_shot", Frame, Document, Frame, "Previous shot", "Go to the first frame of this shot, or of the one before.", ["PageUp"];
    FindShots, "find_shots", Frame, Document, Frame, "Find the cuts", "Look at every frame of this video for cuts between shots, in the background; shots marked before are replaced. One step of undo.", [];
    StopShotSearch, "stop_shot_search", Frame, Document, Frame, "Stop looking for cuts", "Stop the search for cuts; nothing is changed.", [];
    AddCut, "add_cut", Frame, Picture, Frame, "Cut before this frame", "Start a new shot at this frame and end the previous one before it. One step of undo.", [];
    MoveCutHere, "move_cut_here", Frame, Picture, Frame, "Move the cut here", "Move the nearest cut to just before this frame, so that its shot starts here. One step of undo.", [];
    RemoveCut, "remove_cut", Frame, Picture, Frame, "Join with previous shot", "Remove the cut before this shot and merge it with the previous one. One step of undo.", [];
    ShotContent, "shot_content", Frame, Picture, Frame, "Shot shows no field, or a field",
        "Correct what this shot shows: shots without a field get no camera and want none. One \
         step of undo.",
        ["Ctrl+Shift+K"];
    NextReference, "next_reference", Frame, Document, Frame, "Next reference", "Go to the next accepted frame.", ["R"];
    PreviousReference, "previous_reference", Frame, Document, Frame, "Previous reference", "Go to the previous accepted frame.", ["Shift+R"];
    Accept, "accept", Frame, Picture, Frame, "Accept and next", "Make this frame a reference and go to the next frame to do.", ["Enter"];
    AcceptAndStay, "accept_and_stay", Frame, Picture, Frame, "Accept and stay", "Make this frame a reference and stay on it.", ["Shift+Enter"];
    AcceptAnyway, "accept_anyway", Frame, Picture, Frame, "Accept although it looks wrong", "Make this frame a reference although something contradicts it. It is not used for training unless you say so.", [];
    AcceptAllAbove, "accept_all_above", Frame, Picture, Frame, "Accept all above…", "Accept every suggestion above a confidence you choose, after a preview. One step of undo.", ["Ctrl+Enter"];
    AcceptStretch, "accept_stretch", Frame, Picture, Frame, "Accept the selected frames…", "Count the selected frames that lie on their painted lines, and accept these after a look; Enter does this while frames are selected. One step of undo.", [];
    UseForTraining, "use_for_training", Frame, Picture, Frame, "Use for training", "Train the forest with this reference. Accepted suggestions are not used unless you say so.", [];
    Reject, "reject", Frame, Picture, Frame, "Not calibratable…", "Mark this frame as not calibratable, with the reason (1–6).", ["X"];
    AcceptShot, "accept_shot", Frame, Picture, Frame, "Accept this shot…",
        "Accept the frames of this shot that lie on their painted lines, after a preview. One \
         step of undo.",
        ["Ctrl+Shift+Enter"];
    RejectShot, "reject_shot", Frame, Picture, Frame, "Whole shot not calibratable…", "Mark every frame of this shot as not calibratable, with the reason (1–6).", ["Shift+X"];
    Comment, "comment", Frame, Picture, Frame, "Comment…", "Write a comment on this frame.", ["Ctrl+M"];
    MendNames, "mend_names", Frame, Picture, Frame, "Use the names that fit", "Where other names fit the points better or equally well: swap, mirror or rename them.", [];
    SwitchRoot, "switch_root", Frame, Picture, Frame, "Switch to the other focal length", "Where two focal lengths fit the two clicks, use the other one.", [];
    Snap, "snap", Frame, Picture, Frame, "Snap to the painted lines", "Refine pan, tilt and focal length on the painted lines of the picture, held by the points. Hold the key to see the camera before. One step of undo.", ["S"];
    SearchLines, "search_lines", Frame, Picture, Frame, "Search the painted lines", "Find this frame's camera from its painted lines alone; for wide views of a camera whose base is known. The result is a suggestion. One step of undo.", [];
    Track, "track", Frame, Picture, Frame, "Track cameras through the shot", "Propagate the known cameras to every frame of this shot: points are tracked from frame to frame, and all frames are adjusted together on the painted lines. The results are suggestions. One step of undo.", ["T"];
    DiscardTracked, "discard_carried", Frame, Picture, Frame, "Discard the tracked cameras", "Restore what the frames showed before they were tracked. Frames that you have changed or accepted since are kept. One step of undo.", [];
    DiscardBatch, "discard_batch", Frame, Picture, Frame, "Discard this batch of suggestions", "Discard this frame's suggestion and all others that came with it: from the same forest, shot or search. Frames that you have changed or accepted since are kept; the others show what was suggested before; a camera that was imported comes back. One step of undo.", [];
    RemoveModelPoints, "remove_model_points", Edit, Picture, Frame, "Remove the points of this model",
        "Remove the points that another program's model gave, from all frames, with the cameras \
         that rest on them alone. Points that you moved or renamed and frames that you accepted \
         are kept. One step of undo.",
        [];
    TakeLength, "take_length", Frame, Picture, Frame, "Take the measured length of the field", "Use the length of the field that the painted lines of the tracked frames indicate, if no length is stated. One step of undo.", [];
    RefineBaseOnShot, "refine_base_on_shot", Frame, Picture, Frame, "Refine the base on this shot", "Track the shot, correct the camera's base and an assumed field size by the painted lines of all its frames, and repeat that until the base settles; then track cameras through the shot. One clicked frame is enough. Undo restores the base and removes the tracked cameras.", ["Shift+T"];
    StopTracking, "stop_tracking", Frame, Picture, Frame, "Stop tracking cameras", "Stop tracking cameras through the shot; nothing is changed.", [];
    MendCameras, "mend_cameras", Frame, Application, Frame, "Mend the imported cameras", "Put the cameras that another program gave on one place, base and lens, and every frame on its painted lines; track the frames that do not fit from their neighbours. The results are suggestions. One step of undo.", [];
    StopMending, "stop_mending", Frame, Application, Frame, "Stop mending cameras", "Stop mending the imported cameras; nothing is changed.", [];
    StopSearch, "stop_search", Frame, Picture, Frame, "Stop searching the painted lines", "Stop the search for this frame's camera; nothing is changed.", [];
    SnapPoints, "snap_points", Edit, Application, Frame, "Snap points to the paint", "A point that you place or drop moves to the painted corner, crossing or spot that it names, where that is certain. Hold Alt while releasing to keep it where it is.", [];
    SnapSuggestions, "snap_suggestions", Edit, Application, Frame, "Snap suggestions to the paint", "Refine the forest's proposals on the painted lines before you review them, wherever the lines are clear. Switching this asks the forest again.", [];
    PictureLook, "picture_look", View, Application, Nothing, "Brightness and contrast…", "Brightness, contrast and gamma of the picture as you see it, kept between frames. Exports never change.", ["I"];
    ZoomIn, "zoom_in", View, Zoom, Frame, "Zoom in", "Enlarge the picture.", ["Plus", "Equals"];
    ZoomOut, "zoom_out", View, Zoom, Frame, "Zoom out", "Show more of the picture.", ["Minus"];
    ZoomToFit, "zoom_to_fit", View, Zoom, Frame, "Fit", "Show the whole picture.", ["F"];
    ZoomToClick, "zoom_to_click", View, Picture, Point, "Zoom to the point", "Show the selected point at 800 %.", ["Z"];
    HideOverlay, "hide_overlay", View, Picture, Frame, "Hide overlay (hold)", "Hide the overlay while the key is held.", ["H"];
    OverlayStyle, "overlay_style", View, Picture, Nothing, "Overlay style…", "Colour, width and opacity of the field's lines.", ["O"];
    ShowCurves, "show_curves", View, Picture, Document, "Curves over time", "Show or hide pan, tilt and focal length over time below the picture; a click on a curve goes to the frame, and the ringed point can be dragged.", [];
    ShowFieldMap, "show_field_map", View, Picture, Document, "Field map", "Show or hide the field map.", ["G"];
    Compare, "compare", View, Picture, Frame, "Compare (hold)", "Draw the other solution dashed while the key is held: the other focal length, the camera with other names, or a mended camera as it was imported.", ["B"];
    Uncertainty, "uncertainty", View, Picture, Frame, "Uncertainty", "How precise the lines are: a 1-σ band around them, a heat map, or nothing.", ["U"];
    CameraPanel, "camera_panel", Camera, Document, Document, "Camera panel", "Position, base rotation, lens and masks of this frame's camera.", ["F2"];
    TrainerPanel, "trainer_panel", View, Document, Document, "Trainer panel", "What the forest is trained on, how accurate it is, and where references are missing.", ["F3"];
    PauseTrainer, "pause_trainer", Frame, Application, Nothing, "Pause the trainer", "Stop training and proposing in the background until you resume it.", [];
    ShowFeatures, "show_features", View, Picture, Nothing, "Features", "Show the features of this frame: those that look like the references, and those that agree on its camera.", [];
    ReviewPanel, "review_panel", View, Document, Document, "Review panel", "All proposals, by confidence, by disagreement between neighbours or by time.", ["F4"];
    Gallery, "gallery", Frame, Document, Document, "Gallery",
        "All suggestions as pictures over the whole window, in the order of the review panel: \
         select, accept or reject many at once.",
        ["Shift+F4"];
    QualityPage, "quality_page", View, Document, Document, "Quality page", "How good labels and proposals are: the camera over time, errors at points, where the references look.", ["F5"];
    CompareAnnotators, "compare_annotators", View, Document, Frame, "Compare two annotators…", "Choose another annotator's document of the same frames and compare on the quality page.", [];
    FindCamera, "find_camera", Camera, Picture, Frame, "Find the camera automatically", "Find the camera's position and the cameras of its frames from the pictures alone, without a click. Results are given only where they are certain, as suggestions. One step of undo.", [];
    StopFindCamera, "stop_find_camera", Camera, Picture, Frame, "Stop finding the camera", "Stop the search for the camera, or dismiss the answers that it left to decide; nothing is changed.", [];
    FindCameras, "find_cameras", Camera, Picture, Frame, "Find the cameras of this video",
        "Find the cuts of the video, all its cameras, and the camera of every frame, without a \
         click or from the clicks that there are. What is certain becomes suggestions. One step \
         of undo.", [];
    StopFindCameras, "stop_find_cameras", Camera, Picture, Frame, "Stop finding the cameras",
        "Stop finding the cameras of the video; what was found until then is kept, and the same \
         command goes on from there.", [];
    EstimateBase, "estimate_base", Camera, Picture, Frame, "Estimate the base from these frames", "Estimate the camera's position and base rotation from the points of all its frames.", [];
    BaseOnPaint, "base_on_paint", Camera, Application, Frame, "Use the painted lines for the base", "Also fit the base to the painted lines in the frames' pictures, then refine each frame on its lines. Takes longer: every picture is read twice.", [];
    ShowForBase, "show_for_base", Camera, Picture, Frame, "Where to click for the base", "Go to the frame whose points would help this camera's base most: it looks where no frame with four landmarks or lines does.", [];
    UseEstimatedBase, "use_estimated_base", Camera, Picture, Frame, "Use the estimated base", "Apply the estimated base and solve every frame with it.", [];
    DropEstimatedBase, "drop_estimated_base", Camera, Picture, Frame, "Discard the estimated base", "Keep the current base, or stop the estimation.", [];
    StopSolving, "stop_solving", Camera, Picture, Frame, "Stop solving frames again", "Stop the change that solves many frames again; nothing is changed.", [];
    UseForBase, "use_for_base", Camera, Picture, Frame, "Leave this frame out of the base", "Exclude this frame's points from the estimation of the base, or include them again.", [];
    LoadCamera, "load_camera", Camera, Document, Frame, "Load a camera…", "Copy the camera's base from another project or dataset, or from a venue file.", [];
    AssignToCamera, "assign_to_camera", Camera, Picture, Frame, "Assign frames to a camera…", "Set which camera took this frame, the selected frames, the shot, or all frames from here on.", [];
    NewCameraFromChange, "new_camera_from_change", Camera, Picture, Frame, "New camera from where it stopped fitting", "If the camera was moved, create a new camera for the frames from there on.", [];
    KeepBurntIn, "keep_burnt_in", Camera, Picture, Frame, "Mask burned-in graphics", "Turn the score bugs, banners, watermarks and black boxes that were found into masks of the camera, each for the frames that show it. One step of undo.", [];
    ChangeBurntIn, "change_burnt_in", Camera, Picture, Frame, "Edit burned-in graphics…", "Mask them and open the masks, to move, delete or add some.", [];
    ConfirmFieldSize, "confirm_field_size", Camera, Picture, Frame, "Confirm the field's size", "Confirm length and width. Until then they are marked as assumed in the dataset.", [];
    FitFieldSize, "fit_field_size", Camera, Picture, Frame, "Fit the field's size to the points", "Estimate length and width together with the base, within what the rules allow. Uncertain with few frames.", [];
    ChooseSport, "choose_sport", Camera, Document, Frame, "Sport and field…", "Choose the sport: soccer, basketball, ice hockey and others, each with its pitch, court or rink. Free until points are named.", [];
    SelectShot, "select_shot", Frame, Picture, Frame, "Select this shot", "Select every frame of this shot. Shift-click or Ctrl-click on the filmstrip selects single frames.", [];
    MarkGold, "mark_gold", Frame, Picture, Frame, "Gold frame", "Click this reference again later without seeing its label, to measure your click noise.", [];
    ChooseGold, "choose_gold", Frame, Document, Frame, "Choose gold frames", "Mark a few references as gold, spread over pan and landmarks. One step of undo.", [];
    ClickAgain, "click_again", Frame, Round, Frame, "Click gold frames again…", "A blind round: click the points of the gold frames again, one after another, with labels and lines hidden. Labels stay as they are.", [];
    SkipAgain, "skip_again", Frame, Round, Frame, "Skip this point of the blind round", "Skip a point that cannot be seen well enough and go on with the next.", ["Shift+S"];
    UseOwnNoise, "use_own_noise", Frame, Document, Frame, "Use my click noise", "Weight points by the click noise that your blind clicks show, instead of the usual one. One step of undo.", [];
    UseUsualNoise, "use_usual_noise", Frame, Document, Frame, "Use the usual click noise", "Points are weighted by the field template's click noise again; yours stays in the project.", [];
    Guide, "guide", Help, Application, Nothing, "User guide", "The guide, at the page of what is shown.", ["F1"];
    StartTour, "start_tour", Help, Document, Nothing, "Take the tour", "Five steps on the demo match, each done by you: place two points, refine one, accept, decide (2 minutes).", [];
    LeaveTour, "leave_tour", Help, Document, Nothing, "Leave the tour", "End the tour; what you labelled stays.", [];
    Palette, "palette", Help, Application, Nothing, "Command palette…", "Find any command by typing.", ["Ctrl+K"];
    Keys, "keys", Help, Application, Nothing, "Keys", "Every command and its key; keys can be changed here.", ["?"];
    Messages, "messages", Help, Application, Nothing, "Messages…", "Every message of this session, the latest first.", [];
    DismissNotices, "dismiss_notices", Help, Application, Nothing, "Dismiss all messages",
        "Clear the row of messages; they stay in the list of messages.",
        [];
    About, "about", Help, Application, Nothing, "About", "Version, licence, citation and a diagnostic report.", [];
}

impl Command {
    /// Every command, in the order of the menus.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.command)
    }

    const fn row(self) -> &'static CommandRow {
        &ROWS[self as usize]
    }

    /// The name in the settings file; it never changes.
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// The text in the menu.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// The text of the tooltip.
    pub const fn about(self) -> &'static str {
        self.row().about
    }

    /// The menu that lists the command.
    pub const fn group(self) -> MenuGroup {
        self.row().group
    }

    /// What the command acts on.
    pub const fn kind(self) -> CommandKind {
        self.row().kind
    }

    /// What must be there for it to be available.
    pub const fn needs(self) -> CommandNeeds {
        self.row().needs
    }

    pub const fn default_keys(self) -> &'static [&'static str] {
        self.row().keys
    }

    /// Whether the command acts while its key is down, rather than once.
    pub const fn is_held(self) -> bool {
        matches!(self, Self::HideOverlay | Self::Compare | Self::Snap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_command_has_one_row_an_id_a_name_and_a_description() {
        let ids: BTreeSet<_> = Command::all().map(Command::id).collect();
        assert_eq!(ids.len(), Command::all().count());
        for command in Command::all() {
            assert_eq!(command.row().command, command);
            assert!(
                command.about().ends_with('.') || command.about().ends_with(')'),
                "{command:?}"
            );
        }
    }
}
