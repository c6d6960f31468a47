#pragma once

/// @file
/// Actions: everything the operator can do, by menu, button or key, in one table.

#include <map>
#include <vector>

#include <QAction>
#include <QObject>
#include <QString>

#include "ui/appearance.h"

namespace longarm::ui {

enum class ActionId {
  kOpenPair, kOpenViews, kOpenSketch, kSaveSketch, kSaveSketchAs, kExportWorld, kQuit,
  kUndo, kRedo, kDelete, kRename, kDuplicate, kCopyToPictures, kNote, kNumbers, kColour, kGroup, kUngroup, kHide, kLock, kEndsDiffer, kSnap, kSelectAll, kCancel,
  kToolSelect, kToolPoint, kToolLine, kToolPipe, kToolPlane, kToolTriad, kToolMeasure, kAddToWorld, kAddKeepOut, kAddWorkspace, kClearestView,
  kReregister,
  kTaskTarget, kTaskCalibrate,
  kLiveBoth, kFitPictures, kFullSize, kUndistort, kOwnLinks, kMaximise,
  kSceneFit, kSceneReset, kSceneTop, kSceneSide, kSceneLeft, kSceneFront, kLookLeft, kLookRight,
  kMoreOpaque, kLessOpaque, kTheme, kResetLayout,
  kTakePair, kFrameThis, kGrabPipe, kHome, kStow, kReady, kLookAhead, kReplan, kOtherWay, kDiscardPlan, kCancelPlanning,
  kPlayPause, kBackUp, kStage, kStageBack, kHoldToRun, kAutoPlay, kStepBack, kStepForward, kSlower, kFaster, kToStart, kToEnd,
  kGripperOpen, kGripperClose, kRestart, kStop, kReset,
  kShortcuts, kAbout
};

/// One line of the table.
struct ActionSpec {
  ActionId id;
  const char* menu;                        ///< "File", "Edit", ...; empty: in no menu.
  const char* text;                        ///< With mnemonic.
  const char* icon;                        ///< Name below resources/icons; empty: none.
  const char* keys;                        ///< Shortcuts, separated by blanks; empty: none.
  const char* tip;                         ///< What it does, one sentence.
  bool checkable = false;
};
const std::vector<ActionSpec>& actionTable();

/// Owns the QActions.  Whoever can carry one out connects to it and keeps its reason up to date.  GUI thread only.
class Actions final : public QObject {
  Q_OBJECT

 public:
  explicit Actions(Appearance& appearance, QObject* parent = nullptr);

  QAction* at(ActionId id) const { return m_actions.at(id); }
  /// Disabled with this reason in its tooltip; empty: enabled.
  void setWhyNot(ActionId id, const QString& reason);
  QString whyNot(ActionId id) const;
  /// Text without mnemonic, e.g. to name what undo would do.
  void setText(ActionId id, const QString& text);

 private:
  void make(const ActionSpec& spec);
  void refreshTip(const ActionSpec& spec);
  void refreshIcons();

  Appearance& m_appearance;
  std::map<ActionId, QAction*> m_actions;
  std::map<ActionId, QString> m_reasons;
};

}  // namespace longarm::ui
