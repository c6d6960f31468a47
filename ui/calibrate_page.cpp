#include "ui/calibrate_page.h"

#include <algorithm>

#include <QComboBox>
#include <QHBoxLayout>
#include <QListWidget>
#include <QScrollArea>
#include <QStackedWidget>

namespace longarm::ui {

CalibratePage::CalibratePage(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(4, 4, 4, 4);
  row->setSpacing(4);
  m_list = new QListWidget(this);
  m_list->setFixedWidth(128);
  m_list->setObjectName(QStringLiteral("tools"));
  m_stack = new QStackedWidget(this);
  row->addWidget(m_list);
  row->addWidget(m_stack, 1);
  m_intrinsics = new CalibrateIntrinsicsPanel(bench, appearance);
  addTool(tr("Lens (board)"), tr("Focal lengths, principal point and distortion from pictures of a board"), m_intrinsics);
  m_stereo = new CalibrateStereoPanel(bench, appearance);
  addTool(tr("Stereo pair"), tr("How two cameras stand to each other, from a board before both"), m_stereo);
  m_lens = new CalibrateLensPanel(bench, appearance);
  m_fixture = new CalibrateFixturePanel(bench, appearance);
  m_pose = new CalibratePosePanel(bench, appearance);
  m_zoom = new CalibrateZoomPanel(bench, appearance);
  m_library = new CalibrateLibraryPanel(bench, appearance);
  addTool(tr("Lens (by hand)"), tr("Distortion by sliders or from straight edges"), m_lens);
  addTool(tr("Fixture"), tr("A camera from one picture of points known in 3-D"), m_fixture);
  addTool(tr("Pose"), tr("Where a camera, a pan-tilt or an object is, from known corners"), m_pose);
  addTool(tr("Zoom"), tr("The table of a zoom camera"), m_zoom);
  addTool(tr("Library, health"), tr("How the cameras do, and every calibration that was accepted"), m_library);
  connect(m_library, &CalibrateLibraryPanel::poseWanted, this, [this](const QString& camera) {
    showTool(m_pose);
    m_pose->camera()->setCurrentIndex(std::max(0, m_pose->camera()->findData(camera)));
  });
  connect(m_list, &QListWidget::currentRowChanged, m_stack, &QStackedWidget::setCurrentIndex);
  m_list->setCurrentRow(0);
}

void CalibratePage::addTool(const QString& name, const QString& tip, QWidget* panel) {
  auto* item = new QListWidgetItem(name, m_list);
  item->setToolTip(tip);
  item->setSizeHint({100, 34});
  // Whatever a page has to say, STOP below it keeps its place.
  auto* scroll = new QScrollArea(m_stack);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setWidget(panel);
  m_stack->addWidget(scroll);
}

void CalibratePage::showTool(QWidget* panel) {
  for (int row = 0; row < m_stack->count(); ++row) {
    if (static_cast<QScrollArea*>(m_stack->widget(row))->widget() == panel) m_list->setCurrentRow(row);
  }
}

}  // namespace longarm::ui
