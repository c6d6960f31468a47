#include "ui/third_pane.h"

#include <QHBoxLayout>
#include <QToolButton>
#include <QVBoxLayout>

#include "session/tools/third_view.h"
#include "ui/elided_label.h"
#include "ui/picture_text.h"

namespace longarm::ui {

using session::TargetingController;

ThirdPane::ThirdPane(Workbench& bench, Appearance& appearance, QWidget* parent)
    : QFrame(parent), m_bench(bench), m_canvas(new widgets::ImageCanvas(vision::PaneSide::kLeft, this)), m_title(new ElidedLabel(this)),
      m_warning(new ElidedLabel(this)), m_close(new QToolButton(this)) {
  setObjectName(QStringLiteral("panel"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->setSpacing(3);
  auto* row = new QHBoxLayout;
  column->addLayout(row);
  row->addWidget(m_title, 1);
  m_close->setText(tr("Put away"));
  m_close->setFocusPolicy(Qt::TabFocus);
  m_close->setToolTip(tr("Hide the third picture; picks made in it stay"));
  row->addWidget(m_close);
  column->addWidget(m_canvas, 1);
  column->addWidget(m_warning);
  const auto style = [this, &appearance] { m_canvas->setTheme(appearance.theme()); };
  style();
  connect(&appearance, &Appearance::changed, this, style);
  auto& targeting = m_bench.targeting();
  connect(m_close, &QToolButton::clicked, this, [&targeting] { targeting.setThird({}); });
  connect(m_canvas, &widgets::ImageCanvas::pointer, this, &ThirdPane::onPointer);
  connect(&targeting, &TargetingController::thirdChanged, this, &ThirdPane::refreshPicture);
  connect(&targeting, &TargetingController::overlayChanged, this, &ThirdPane::refreshOverlay);
  connect(&targeting, &TargetingController::featuresChanged, this, &ThirdPane::refreshOverlay);
  refreshPicture();
}

void ThirdPane::refreshPicture() {
  const auto snapshot = m_bench.document().snapshot(m_bench.targeting().third());
  setVisible(snapshot != nullptr);
  if (!snapshot) return m_canvas->clearPicture({});
  m_canvas->setCamera(snapshot->view.camera);
  m_canvas->setPicture(snapshot->image);
  m_title->setFullText(tr("Third: %1  %2").arg(QString::fromStdString(snapshot->view.name), pictureTime(snapshot->wall_time_s)));
  refreshOverlay();
}

void ThirdPane::refreshOverlay() {
  if (!m_canvas->hasPicture()) return;
  auto& targeting = m_bench.targeting();
  m_canvas->setOverlay(targeting.thirdOverlay());
  const QString warning = QString::fromStdString(session::thirdViewWarning(m_bench.document(), targeting.third()));
  m_warning->setFullText(warning.isEmpty() ? tr("A click marks the selected feature here: its curves should cross there.") : warning);
}

void ThirdPane::onPointer(const vision::PointerEvent& event) {
  if (event.phase != vision::PointerPhase::kPress || !event.left) return;
  const Status marked = m_bench.targeting().pickInThird(event.pixel);
  if (!marked) m_bench.say(QString::fromStdString(marked.error().message));
}

}  // namespace longarm::ui
