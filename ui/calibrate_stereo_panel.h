#pragma once

/// @file
/// CalibrateStereoPanel: how two cameras stand to each other, from a board before both.

#include <array>

#include <QWidget>

#include "session/calibration/stereo_controller.h"
#include "ui/appearance.h"
#include "ui/board_form.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace longarm::ui {

/// Both pictures of a pair side by side; right of them cameras, board, the list of pairs and the answer.  GUI thread only.
class CalibrateStereoPanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateStereoPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  widgets::ImageCanvas* canvas(int side) const { return m_canvas[static_cast<std::size_t>(side)]; }
  QComboBox* camera(int side) const { return m_camera[static_cast<std::size_t>(side)]; }
  BoardForm* boardForm() const { return m_board; }
  QCheckBox* live() const { return m_live; }
  QCheckBox* refine() const { return m_refine; }
  QTableWidget* table() const { return m_pairs; }
  widgets::HoldButton* applyButton() const { return m_apply; }
  QString answer() const;

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildPicture(std::size_t side, Appearance& appearance);
  QWidget* buildSide(Appearance& appearance);
  void bind();
  void chooseCameras();
  void watch();
  void offerLive(const QString& camera);
  void refresh();
  void refreshPairs();
  void refreshPictures();
  void refreshAnswer();
  void showSide(std::size_t side, const session::BoardPicture* picture, const vision::Overlay& overlay);
  vision::Overlay overlayOf(const session::BoardPicture& picture) const;
  int selectedPair() const;
  void save();
  void apply();
  session::StereoController& model() const { return m_bench.stereo(); }

  Workbench& m_bench;
  std::array<widgets::ImageCanvas*, 2> m_canvas{};
  std::array<QComboBox*, 2> m_camera{};
  std::array<QLabel*, 2> m_caption{};
  BoardForm* m_board;
  QCheckBox *m_live, *m_auto, *m_refine;
  QPushButton *m_add, *m_capture, *m_clear, *m_remove, *m_save;
  widgets::HoldButton* m_apply;
  QLabel *m_words, *m_result;
  QTableWidget* m_pairs;
  bool m_filling = false;
};

}  // namespace longarm::ui
