#pragma once

/// @file
/// ModeFrame: a border around everything that says whether the robot is real.

#include <QWidget>

#include "widgets/theme.h"

class QVBoxLayout;

namespace longarm::widgets {

enum class ModeLook { kLive, kVirtual, kReplay };

/// Live: plain solid border.  Virtual: hatched.  Replay: dotted.
class ModeFrame final : public QWidget {
  Q_OBJECT

 public:
  static constexpr int kWidth = 7;               ///< Of the border [px].

  explicit ModeFrame(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  void setMode(ModeLook mode);
  ModeLook mode() const { return m_mode; }
  /// What stands inside, top to bottom.
  QVBoxLayout* content() const { return m_content; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  Theme m_theme = Theme::dark();
  ModeLook m_mode = ModeLook::kVirtual;
  QVBoxLayout* m_content;
};

}  // namespace longarm::widgets
