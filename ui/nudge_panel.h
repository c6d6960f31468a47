#pragma once

/// @file
/// NudgePanel: corrects a motion under way by small steps of the tool.

#include <array>

#include <QWidget>

#include "ui/workbench.h"

class QComboBox;
class QLabel;
class QToolButton;

namespace longarm::ui {

/// Two buttons per axis for moving and two for turning; size and axes are chosen beside them.  GUI thread only.
class NudgePanel final : public QWidget {
  Q_OBJECT

 public:
  explicit NudgePanel(Workbench& bench, QWidget* parent = nullptr);

  /// @param axis 0 x, 1 y, 2 z  @param sign -1 or 1
  QToolButton* moveButton(int axis, int sign) const { return m_move[index(axis, sign)]; }
  QToolButton* turnButton(int axis, int sign) const { return m_turn[index(axis, sign)]; }
  QComboBox* frameBox() const { return m_frame; }
  QComboBox* stepBox() const { return m_step; }
  QComboBox* angleBox() const { return m_angle; }

 private:
  static std::size_t index(int axis, int sign) { return static_cast<std::size_t>(2 * axis + (sign > 0 ? 1 : 0)); }
  QToolButton* button(const QString& text, int axis, int sign, bool turn);
  void nudge(int axis, int sign, bool turn);
  void refresh();

  Workbench& m_bench;
  QComboBox *m_frame, *m_step, *m_angle;
  QLabel* m_state;
  std::array<QToolButton*, 6> m_move{}, m_turn{};
};

}  // namespace longarm::ui
