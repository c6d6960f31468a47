#pragma once

/// @file
/// JogPanel: moves the arm while a button or key is held.

#include <vector>

#include "session/controllers/jog_controller.h"
#include "ui/actions.h"
#include "ui/hold_panel.h"

class QButtonGroup;
class QCheckBox;
class QGridLayout;
class QLabel;
class QSlider;
class QToolButton;

namespace longarm::ui {

/// With the panel focused the arrow keys and Page Up / Down jog along the frame's axes, with Shift about them.
/// GUI thread only.
class JogPanel final : public HoldPanel {
  Q_OBJECT

 public:
  JogPanel(Workbench& bench, QWidget* parent = nullptr);

  void setFrame(planning::JogFrame frame);
  /// The button that jogs axis (as JogController::hold) one way; null when this frame has none.
  QToolButton* button(int axis, int way) const;

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  void keyReleaseEvent(QKeyEvent* event) override;

 private:
  struct Pair {
    QLabel* name;
    QToolButton *minus, *plus;
    int axis;
  };
  QWidget* makeChoices();
  void fillAxes();
  void addPair(const QString& name, const QString& minus, const QString& plus, int axis);
  QToolButton* holdButton(const QString& text, int axis, int way);
  void refresh() override;
  bool keyHeld() const override { return m_key != 0; }
  void forgetKeys() override { m_key = 0; }
  void showSpeed();

  QButtonGroup* m_frames;
  QSlider* m_speed;
  QLabel* m_speed_text;
  QCheckBox* m_creep;
  QWidget* m_axes;
  QGridLayout* m_grid;
  std::vector<Pair> m_pairs;
  int m_key = 0;                         // that is held
};

}  // namespace longarm::ui
