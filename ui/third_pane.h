#pragma once

/// @file
/// ThirdPane: a third picture that checks what is marked in the other two.

#include <QFrame>

#include "ui/appearance.h"
#include "ui/workbench.h"
#include "widgets/image_canvas.h"

class QToolButton;

namespace longarm::ui {

class ElidedLabel;

/// Shows both epipolar curves of the vertex that is worked on; a click marks the selected feature here.  Hidden while there is
/// no third picture.  GUI thread only.
class ThirdPane final : public QFrame {
  Q_OBJECT

 public:
  ThirdPane(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);
  widgets::ImageCanvas* canvas() const { return m_canvas; }

 private:
  void refreshPicture();
  void refreshOverlay();
  void onPointer(const vision::PointerEvent& event);

  Workbench& m_bench;
  widgets::ImageCanvas* m_canvas;
  ElidedLabel *m_title, *m_warning;
  QToolButton* m_close;
};

}  // namespace longarm::ui
