#pragma once

/// @file
/// CalibrateIntrinsicsPanel: lens and focal lengths from pictures of a board.

#include <QWidget>

#include "ui/appearance.h"
#include "ui/board_form.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QProgressBar;
class QPushButton;
class QTableWidget;
class QTabWidget;

namespace longarm::ui {

/// Three steps (board and pictures, views, result) beside one large picture.  GUI thread only.
class CalibrateIntrinsicsPanel final : public QWidget {
  Q_OBJECT

 public:
  enum class Show { kPicture, kCoverage, kUncertainty };

  CalibrateIntrinsicsPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  widgets::ImageCanvas* canvas() const { return m_canvas; }
  QTableWidget* views() const { return m_views; }
  QTableWidget* parameters() const { return m_parameters; }
  QTabWidget* steps() const { return m_steps; }
  QComboBox* source() const { return m_source; }
  QComboBox* target() const { return m_target; }
  widgets::HoldButton* applyButton() const { return m_apply; }
  QString advice() const;
  void setBoard(const calibration::BoardSpec& board);
  void show(Show what);

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildPicture(Appearance& appearance);
  QWidget* buildBoardStep();
  QWidget* buildViewsStep();
  QWidget* buildResultStep(Appearance& appearance);
  QWidget* buildBars();
  void bind();
  void takeLens();
  void chooseSource();
  void offerLive(const QString& camera);
  void refresh();
  void refreshBars();
  void refreshViews();
  void refreshResult();
  void refreshTarget();
  void refreshLive();
  void refreshPicture();
  vision::Overlay pictureOverlay(std::size_t picture) const;
  vision::Overlay coverageOverlay() const;
  void showUncertainty();
  int selectedPicture() const;
  session::CameraChange change() const;
  void apply();
  session::IntrinsicsController& model() const { return m_bench.calibration().intrinsics(); }

  Workbench& m_bench;
  widgets::ImageCanvas* m_canvas;
  QTabWidget* m_steps;
  QComboBox *m_show, *m_source, *m_target, *m_distortion, *m_skew;
  BoardForm* m_board;
  QCheckBox* m_auto;
  QPushButton *m_add, *m_capture, *m_clear, *m_remove, *m_save;
  widgets::HoldButton* m_apply;
  QLabel *m_live_text, *m_advice, *m_info, *m_summary;
  QProgressBar *m_coverage, *m_tilt_x, *m_tilt_y, *m_size;
  QTableWidget *m_views, *m_parameters;
  bool m_live = false, m_filling = false;
};

}  // namespace longarm::ui
