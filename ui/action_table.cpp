#include "ui/actions.h"

namespace longarm::ui {

// Space and Pause are STOP everywhere (StopKeys), and 1 to 9 choose cameras (CamerasPanel): they are no actions.
const std::vector<ActionSpec>& actionTable() {
  using I = ActionId;
  static const std::vector<ActionSpec> table = {
      {I::kOpenPair, "File", "&Open pictures...", "pair-open", "Ctrl+O", "Open a pair of pictures with their camera files"},
      {I::kOpenViews, "File", "Open &views file...", "pair-open", "Ctrl+Shift+O", "Open every picture of a views.yaml"},
      {I::kOpenSketch, "File", "Open s&ketch...", "sketch-open", "Ctrl+E", "Open a saved sketch with its pictures"},
      {I::kSaveSketch, "File", "&Save sketch", "sketch-save", "Ctrl+S", "Save pictures and sketch to a folder"},
      {I::kSaveSketchAs, "File", "Save sketch &as...", "sketch-save", "Ctrl+Shift+S", "Save pictures and sketch to another folder"},
      {I::kExportWorld, "File", "E&xport world...", "sketch-save", "", "Write the bodies of the sketched world to a glTF, OBJ or JSON file"},
      {I::kQuit, "File", "&Quit", "", "Ctrl+Q", "Stop the robot and close the window"},

      {I::kUndo, "Edit", "&Undo", "edit-undo", "Ctrl+Z", "Take back the last edit of pictures or sketch"},
      {I::kRedo, "Edit", "&Redo", "edit-redo", "Ctrl+Shift+Z Ctrl+Y", "Do again what was taken back"},
      {I::kDelete, "Edit", "&Delete", "feature-delete", "Del", "Delete the selected features"},
      {I::kRename, "Edit", "Re&name", "feature-rename", "F2", "Give the selected feature another name"},
      {I::kDuplicate, "Edit", "D&uplicate", "", "Ctrl+D", "Copy the selected feature"},
      {I::kNote, "Edit", "No&te...", "", "F4", "Write a note on the selected feature; it is shown beside its name"},
      {I::kNumbers, "Edit", "Edit &numbers...", "", "Ctrl+I", "Move the selected feature's vertices by numbers, in millimetres or pixels"},
      {I::kColour, "Edit", "C&olour...", "", "", "Give the selected features a colour of their own"},
      {I::kGroup, "Edit", "&Group", "", "Ctrl+J", "Select and move the selected features as one from now on"},
      {I::kUngroup, "Edit", "Ungrou&p", "", "Ctrl+Shift+J", "Take the selected features out of their group"},
      {I::kHide, "Edit", "&Hide or show", "feature-hide", "H", "Hide the selected features, or show them again"},
      {I::kLock, "Edit", "&Lock or unlock", "", "K", "Keep the selected features from being moved, or let them go"},
      {I::kSelectAll, "Edit", "Select &all", "", "Ctrl+A", "Select every feature"},
      {I::kCancel, "Edit", "&Cancel, deselect", "", "Esc", "Cancel the drag or the tool, then deselect"},

      {I::kToolSelect, "Sketch", "&Select", "tool-select", "A", "Select, drag and nudge features", true},
      {I::kToolPoint, "Sketch", "&Point", "tool-point", "D", "Mark a point in both pictures", true},
      {I::kToolLine, "Sketch", "&Line", "tool-line", "N", "Mark the two ends of a line in both pictures", true},
      {I::kToolPipe, "Sketch", "P&ipe", "tool-pipe", "I", "Mark both outlines of a round pipe in both pictures: gives its axis and radius", true},
      {I::kToolPlane, "Sketch", "Pla&ne", "tool-plane", "W", "Mark three corners of a flat face in both pictures", true},
      {I::kToolTriad, "Sketch", "&Triad (box)", "tool-triad", "X", "Mark a box's corner and the ends of its three edges in both pictures", true},
      {I::kToolMeasure, "Sketch", "&Measure", "tool-measure", "M", "Distance between two handles, or the angle at the second of three", true},
      {I::kAddToWorld, "Sketch", "Add to &world", "world-add", "Ctrl+B", "Make the selected box, plane, pipe or points a body that plans keep clear of"},
      {I::kAddKeepOut, "Sketch", "Add as &keep-out zone", "", "Ctrl+Shift+B", "Make the selected box, plane, pipe or points a zone that the arm and what it holds never enter"},
      {I::kAddWorkspace, "Sketch", "Add workspace bo&x", "", "", "Put a box around the arm that it does not leave; change its numbers in the list of bodies"},

      {I::kTaskTarget, "View", "Tar&get", "", "F5", "Take pictures, mark what matters, plan and play"},
      {I::kTaskCalibrate, "View", "&Calibrate", "", "F7", "Find out lenses and places of the cameras"},
      {I::kLiveBoth, "View", "&Live pictures", "", "V", "Switch both panes between live pictures and snapshots", true},
      {I::kFitPictures, "View", "&Fit pictures", "view-fit", "Ctrl+0", "Show both pictures whole"},
      {I::kFullSize, "View", "Pictures at &100 %", "view-full-size", "Ctrl+1", "One picture pixel per screen pixel in both panes"},
      {I::kUndistort, "View", "&Undistorted pictures", "view-undistort", "U", "Show both pictures without lens distortion; picks keep their meaning", true},
      {I::kMaximise, "View", "&Maximise pane", "", "F11", "Give the whole middle to the pane that has the focus, or back", true},
      {I::kSceneFit, "View", "Frame &selection in 3-D", "scene-fit", "F", "Bring the selection, or everything, into view in the 3-D scene"},
      {I::kSceneReset, "View", "&Reset 3-D view", "scene-reset", "R", "Look at robot and surroundings from the usual side"},
      {I::kSceneTop, "View", "&Top view", "scene-top", "T Num+7", "Look at the 3-D scene from above"},
      {I::kSceneSide, "View", "Right s&ide view", "", "S Num+3", "Look at the 3-D scene from the robot's right"},
      {I::kSceneLeft, "View", "Left sid&e view", "", "L", "Look at the 3-D scene from the robot's left"},
      {I::kSceneFront, "View", "Fr&ont view", "", "G Num+1", "Look at the robot's face"},
      {I::kLookLeft, "View", "Look from left pane's camera", "aim-camera", "Alt+Left", "See the 3-D scene as the left pane's camera saw it"},
      {I::kLookRight, "View", "Look from right pane's camera", "aim-camera", "Alt+Right", "See the 3-D scene as the right pane's camera saw it"},
      {I::kMoreOpaque, "View", "Embedded pictures more opaque", "", "]", "Draw the pictures in the 3-D scene 10 % more opaque"},
      {I::kLessOpaque, "View", "Embedded pictures less opaque", "", "[", "Draw the pictures in the 3-D scene 10 % less opaque"},
      {I::kTheme, "View", "Dark or light theme", "theme-switch", "Ctrl+Shift+T", "Switch between the dark and the light theme"},
      {I::kResetLayout, "View", "Reset layout", "", "", "Put all panels back where they were at first"},

      {I::kTakePair, "Robot", "&Take pair", "snapshot-take", "Ctrl+T", "Take one picture with each pane's camera, with the robot's state at each exposure"},
      {I::kFrameThis, "Robot", "&Frame this", "aim-camera", "Z", "Turn and zoom the panes' cameras so that the selected features fill their pictures"},
      {I::kGrabPipe, "Robot", "&Grab Pipe", "macro-grab-pipe", "Ctrl+P", "Plan to grab the selected line's pipe at its middle"},
      {I::kHome, "Robot", "&Home", "robot-home", "", "Plan a motion to the home pose"},
      {I::kStow, "Robot", "&Stow", "macro-run", "", "Plan a motion to the stow pose"},
      {I::kReady, "Robot", "R&eady", "macro-run", "", "Plan a motion to the ready pose"},
      {I::kLookAhead, "Robot", "&Look ahead", "macro-run", "", "Plan a motion that clears the view ahead"},
      {I::kReplan, "Robot", "&Plan again", "link-restart", "Ctrl+R", "Plan the same motion from where the robot is now"},
      {I::kOtherWay, "Robot", "&Other way", "plan-other", "O", "Plan the same another way: other joints, another side; after the last the first comes again"},
      {I::kDiscardPlan, "Robot", "&Discard plan", "plan-cancel", "Ctrl+Backspace", "Take the plan off the table; moves nothing"},
      {I::kCancelPlanning, "Robot", "&Cancel planning", "plan-cancel", "Ctrl+.", "Give up planning"},
      {I::kPlayPause, "Robot", "Play or pause", "transport-play", "P", "Move the arm along the plan, or slow down and hold"},
      {I::kBackUp, "Robot", "Back up", "transport-back-up", "B", "Move the arm back along its path"},
      {I::kStepBack, "Robot", "Step back", "", ",", "Show the motion 0.1 s earlier; moves nothing"},
      {I::kStepForward, "Robot", "Step forward", "", ".", "Show the motion 0.1 s later; moves nothing"},
      {I::kSlower, "Robot", "Slower", "", "-", "Lower the speed by 10 %; below zero it backs up"},
      {I::kFaster, "Robot", "Faster", "", "+ =", "Raise the speed by 10 %"},
      {I::kToStart, "Robot", "Show start", "transport-to-start", "Home", "Show the start of the motion; moves nothing"},
      {I::kToEnd, "Robot", "Show end", "transport-to-end", "End", "Show the end of the motion; moves nothing"},
      {I::kGripperOpen, "Robot", "&Open gripper", "gripper-open", "Ctrl+Shift+G", "Open the gripper"},
      {I::kGripperClose, "Robot", "&Close gripper", "gripper-close", "Ctrl+G", "Close the gripper on what is between its fingers"},
      {I::kRestart, "Robot", "&Restart robot link", "link-restart", "Ctrl+Shift+R", "Start the robot's process and the link anew; nothing sketched is lost"},
      {I::kStop, "Robot", "STOP", "", "", "Stop the robot now (Space or Pause, everywhere)"},
      {I::kReset, "Robot", "Reset after STOP", "stop-reset", "", "Let motion through again; nothing moves by itself"},

      {I::kShortcuts, "Help", "&Keys and mouse", "help-shortcuts", "F1 ?", "List every key and mouse gesture"},
      {I::kAbout, "Help", "&About Longarm", "", "", "Version and licence"},
  };
  return table;
}

}  // namespace longarm::ui
