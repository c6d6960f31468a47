#pragma once

/// @file
/// SnapshotPane: one of the two pictures: a snapshot that is sketched on, or a camera live.

#include <array>
#include <optional>

#include <QFrame>
#include <opencv2/core/mat.hpp>

#include "ui/appearance.h"
#include "ui/workbench.h"
#include "widgets/image_canvas.h"

class QComboBox;
class QToolButton;

namespace longarm::ui {

class ElidedLabel;
class ZoomBar;

/// In a snapshot the pointer and keys belong to the sketch tool.  In a live picture double-click or Ctrl+click brings
/// that place to the middle, and the arrow keys turn the head.  GUI thread only.
class SnapshotPane final : public QFrame {
  Q_OBJECT

 public:
  SnapshotPane(vision::PaneSide side, Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  widgets::ImageCanvas* canvas() const { return m_canvas; }
  vision::PaneSide side() const { return m_side; }
  QToolButton* liveButton() const { return m_live_button; }
  ZoomBar* zoomBar() const { return m_zoom_bar; }
  QToolButton* snapshotButton() const { return m_snapshot_button; }
  bool live() const { return m_live; }
  void showLive(const QString& camera);
  void showSnapshot();
  void setUndistorted(bool on);
  bool undistorted() const;

  /// What is shown now and from where; empty while there is nothing or its place is unknown.
  std::optional<vision::View> view() const;
  const cv::Mat& picture() const;

 Q_SIGNALS:
  void shownChanged();                             ///< Another picture, view or mode.
  void undistortedChanged(bool on);
  void menuRequested(const QPoint& global_position);

 private:
  void buildHeader();
  void applyTheme();
  void setLive(bool live);
  void refreshChooser();
  void choose(int index);
  void refreshPicture();
  void refreshLive();
  void refreshOverlay();
  void refreshAge();
  void onPointer(const vision::PointerEvent& event);
  void onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers);
  void onLivePointer(const vision::PointerEvent& event);
  void endFrame(const vision::PointerEvent& event);
  void turnHead(vision::SketchKey key, bool far);
  QString emptyText() const;
  QToolButton* button(const char* icon, const QString& tip);

  vision::PaneSide m_side;
  Workbench& m_bench;
  Appearance& m_appearance;
  bool m_live = true;
  SnapshotId m_snapshot;                   // The document's for this pane, as last seen.
  widgets::ImageCanvas* m_canvas;
  QToolButton *m_live_button, *m_snapshot_button, *m_fit, *m_full_size, *m_undistort;
  QComboBox* m_chooser;
  ElidedLabel* m_info;
  ZoomBar* m_zoom_bar;
  std::optional<std::array<Eigen::Vector2d, 2>> m_frame;   // being drawn in a live picture
};

}  // namespace longarm::ui
