#include "ui/calibrate_stereo_panel.h"

#include <algorithm>

#include <QCheckBox>
#include <QComboBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/calibrate_parts.h"

namespace longarm::ui {

using vision::OverlayRole;

namespace {

constexpr int kColumnWidth = 356;

}  // namespace

CalibrateStereoPanel::CalibrateStereoPanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  for (const std::size_t side : {0U, 1U}) row->addWidget(buildPicture(side, appearance), 1);
  row->addWidget(buildSide(appearance));
  bind();
  refresh();
}

QWidget* CalibrateStereoPanel::buildPicture(std::size_t side, Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas[side] = canvas;
  m_camera[side] = new QComboBox(frame);
  m_camera[side]->setToolTip(side == 0 ? tr("The left camera: the pose is given in its frame") : tr("The right camera: its pose is found"));
  row->addWidget(new QLabel(side == 0 ? tr("Left") : tr("Right"), frame));
  row->addWidget(m_camera[side], 1);
  m_caption[side] = wordLabel(frame, true);
  column->addWidget(m_caption[side]);
  return frame;
}

QWidget* CalibrateStereoPanel::buildSide(Appearance& appearance) {
  const auto [side, column] = framedColumn(this, kColumnWidth);
  m_board = new BoardForm(side);
  column->addWidget(m_board);
  auto* take = new QHBoxLayout;
  m_live = new QCheckBox(tr("live"), side);
  m_live->setToolTip(tr("Look through both cameras and keep pairs in which the board rests"));
  m_auto = new QCheckBox(tr("keep by itself"), side);
  m_auto->setChecked(true);
  m_capture = new QPushButton(tr("Keep this pair"), side);
  take->addWidget(m_live);
  take->addWidget(m_auto);
  take->addWidget(m_capture, 1);
  column->addLayout(take);
  m_words = wordLabel(side, true);
  column->addWidget(m_words);
  m_pairs = plainTable({tr("Use"), tr("Pair"), tr("rms px"), tr("Why")}, side);
  column->addWidget(m_pairs, 1);
  auto* row = new QHBoxLayout;
  m_add = new QPushButton(tr("Add pictures..."), side);
  m_remove = new QPushButton(tr("Remove"), side);
  m_clear = new QPushButton(tr("Start anew"), side);
  for (auto* each : {m_add, m_remove, m_clear}) row->addWidget(each);
  column->addLayout(row);
  m_refine = new QCheckBox(tr("refine both lenses too"), side);
  m_refine->setToolTip(tr("Estimates focal lengths, principal points and distortion with the pose. Needs many pairs, well spread."));
  column->addWidget(m_refine);
  m_result = wordLabel(side);
  m_result->setMinimumHeight(84);
  m_result->setTextInteractionFlags(Qt::TextSelectableByMouse);
  column->addWidget(m_result);
  auto* last = new QHBoxLayout;
  m_save = new QPushButton(tr("Save both..."), side);
  m_apply = holdButton(tr("Hold to use"), appearance, side);
  last->addWidget(m_save);
  last->addWidget(m_apply, 1);
  column->addLayout(last);
  return side;
}

void CalibrateStereoPanel::bind() {
  for (auto* box : m_camera) connect(box, qOverload<int>(&QComboBox::currentIndexChanged), this, &CalibrateStereoPanel::chooseCameras);
  connect(m_board, &BoardForm::boardChanged, this, [this] { model().setBoard(m_board->board()); });
  connect(m_board, &BoardForm::refused, &m_bench, &Workbench::said);
  connect(m_live, &QCheckBox::toggled, this, &CalibrateStereoPanel::watch);
  connect(m_auto, &QCheckBox::toggled, this, [this](bool on) { model().setAutoCapture(on); });
  connect(m_refine, &QCheckBox::toggled, this, [this](bool on) { model().setRefine(on); });
  connect(m_capture, &QPushButton::clicked, this, [this] { model().capture(); });
  connect(m_clear, &QPushButton::clicked, this, [this] { model().clear(); });
  connect(m_remove, &QPushButton::clicked, this, [this] {
    if (selectedPair() >= 0) model().remove(static_cast<std::size_t>(selectedPair()));
  });
  connect(m_add, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("Pictures of the board: left and right"), {tr("Pictures (*.png *.jpg *.jpeg *.bmp *.tif *.tiff *.pgm *.ppm)"), tr("All files (*)")}, true,
                [this](const QStringList& files) { model().addFiles(files); });
  });
  connect(m_pairs, &QTableWidget::itemSelectionChanged, this, &CalibrateStereoPanel::refreshPictures);
  connect(m_pairs, &QTableWidget::itemChanged, this, [this](QTableWidgetItem* item) {
    if (!m_filling && item->column() == 0) model().setIncluded(static_cast<std::size_t>(item->row()), item->checkState() == Qt::Checked);
  });
  connect(m_save, &QPushButton::clicked, this, &CalibrateStereoPanel::save);
  connect(m_apply, &widgets::HoldButton::held, this, &CalibrateStereoPanel::apply);
  connect(&model(), &session::StereoController::changed, this, &CalibrateStereoPanel::refresh);
  connect(&model(), &session::StereoController::liveChanged, this, &CalibrateStereoPanel::refreshPictures);
  connect(&model(), &session::StereoController::saved, this, [this](const QString& left, const QString& right) { m_bench.say(tr("Cameras saved to %1 and %2").arg(left, right)); });
  connect(&m_bench.live(), &LivePictures::pictureArrived, this, &CalibrateStereoPanel::offerLive);
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateStereoPanel::refreshAnswer);
}

QString CalibrateStereoPanel::answer() const { return m_result->text(); }

void CalibrateStereoPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  const bool first = m_camera[0]->count() == 0;
  for (auto* box : m_camera) fillCameras(box, m_bench.document().workcell().get());
  if (first) {
    // The head's pair at first.
    for (const auto side : {vision::PaneSide::kLeft, vision::PaneSide::kRight}) {
      auto* box = m_camera[static_cast<std::size_t>(side)];
      const QSignalBlocker quiet(box);
      box->setCurrentIndex(std::max(0, box->findData(m_bench.paneCamera(side))));
    }
  }
  chooseCameras();
}

void CalibrateStereoPanel::hideEvent(QHideEvent* event) {
  m_bench.live().setWatched({});
  QWidget::hideEvent(event);
}

void CalibrateStereoPanel::chooseCameras() {
  model().setCameras(m_camera[0]->currentData().toString(), m_camera[1]->currentData().toString());
  watch();
}

void CalibrateStereoPanel::watch() {
  const bool on = m_live->isChecked();
  m_bench.live().setWatched(on && isVisible() ? QStringList{m_camera[0]->currentData().toString(), m_camera[1]->currentData().toString()} : QStringList());
  if (!on) model().leaveLive();
  refresh();
}

void CalibrateStereoPanel::offerLive(const QString& camera) {
  if (!m_live->isChecked() || !isVisible()) return;
  for (const int side : {0, 1}) {
    if (camera.toStdString() == model().camera(side)) model().offerLive(side, m_bench.live().picture(camera), m_bench.live().stamp_s(camera));
  }
}

int CalibrateStereoPanel::selectedPair() const { return m_pairs->selectionModel()->hasSelection() ? m_pairs->currentRow() : -1; }

void CalibrateStereoPanel::refresh() {
  const QString none = model().pairs().empty() ? tr("there is nothing.") : QString();
  setWhyNot(m_clear, none, tr("Forget all pairs"));
  setWhyNot(m_remove, none, tr("Remove the selected pair"));
  setWhyNot(m_auto, m_live->isChecked() ? QString() : tr("look through the cameras live first."), tr("Every new place of the board is kept once it rests there and is sharp"));
  refreshPairs();
  refreshPictures();
  refreshAnswer();
}

void CalibrateStereoPanel::refreshPairs() {
  m_filling = true;
  const auto& pairs = model().pairs();
  const auto& outcome = model().outcome();
  m_pairs->setRowCount(static_cast<int>(pairs.size()));
  for (int row = 0; row < m_pairs->rowCount(); ++row) {
    const auto& pair = pairs[static_cast<std::size_t>(row)];
    setTick(m_pairs, row, 0, pair.usable(), pair.included);
    setCell(m_pairs, row, 1, QFileInfo(QString::fromStdString(pair.side[0].name)).fileName());
    QString rms = QStringLiteral("-"), why;
    if (!pair.side[0].view) why = tr("left: %1").arg(QString::fromStdString(pair.side[0].why));
    else if (!pair.side[1].view) why = tr("right: %1").arg(QString::fromStdString(pair.side[1].why));
    else if (!pair.included) why = tr("left out by you");
    for (std::size_t k = 0; outcome && k < outcome->pair.size(); ++k) {
      if (outcome->pair[k] != static_cast<std::size_t>(row)) continue;
      const auto& report = outcome->result.pairs[k];
      if (report.rms_px >= 0) rms = QString::number(report.rms_px, 'f', 3);
      why = QString::fromStdString(report.why);
    }
    setCell(m_pairs, row, 2, rms);
    setCell(m_pairs, row, 3, why);
  }
  m_filling = false;
}

vision::Overlay CalibrateStereoPanel::overlayOf(const session::BoardPicture& picture) const {
  vision::Overlay overlay;
  if (picture.view) addBoard(&overlay, OverlayRole::kSketch, *picture.view);
  return overlay;
}

void CalibrateStereoPanel::showSide(std::size_t side, const session::BoardPicture* picture, const vision::Overlay& overlay) {
  m_canvas[side]->setCamera({});
  if (picture == nullptr || picture->image.empty()) {
    m_canvas[side]->clearPicture(m_live->isChecked() ? tr("Waiting for a picture of %1.").arg(m_camera[side]->currentText()) : tr("No pairs yet.\n\nAdd pictures, or look live."));
    m_caption[side]->setText({});
    return;
  }
  m_canvas[side]->setPicture(picture->image);
  m_canvas[side]->setOverlay(overlay);
  const QString found = picture->view ? tr("%1 corners").arg(picture->view->corners.size()) : QString::fromStdString(picture->why);
  m_caption[side]->setText(QFileInfo(QString::fromStdString(picture->name)).fileName() + QStringLiteral(": ") + found);
}

void CalibrateStereoPanel::refreshPictures() {
  const auto& pairs = model().pairs();
  const int chosen = selectedPair();
  const session::PicturePair* pair = nullptr;
  if (chosen >= 0 && chosen < static_cast<int>(pairs.size())) pair = &pairs[static_cast<std::size_t>(chosen)];
  else if (m_live->isChecked()) pair = model().live() ? &*model().live() : nullptr;
  else if (!pairs.empty()) pair = &pairs.front();
  for (const std::size_t side : {0U, 1U}) showSide(side, pair != nullptr ? &pair->side[side] : nullptr, pair != nullptr ? overlayOf(pair->side[side]) : vision::Overlay());
  setWhyNot(m_capture, m_live->isChecked() ? model().whyNotCapture() : tr("look through the cameras live first."), tr("Keep the live pair whether or not it would be kept by itself"));
  m_words->setText(m_live->isChecked() ? (model().liveWords().isEmpty() ? tr("Waiting for pictures of both cameras.") : model().liveWords())
                                       : tr("Open pairs: left01 right01 left02 ..., or all left and then all right."));
}

void CalibrateStereoPanel::refreshAnswer() {
  QString text = model().resultText();
  if (text.isEmpty()) text = model().searching() ? tr("Searching the pictures ...") : model().solving() ? tr("Calculating ...") : model().why();
  m_result->setText(text);
  setWhyNot(m_save, model().whyNotSave(), tr("Write two camera files: the right one with its pose in the left one"));
  QString why = model().whyNotApply();
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  QString tip = tr("Keep it in the library and use it from now on: the right camera's mount follows from the left one's");
  QString worse;
  for (const auto& change : why.isEmpty() ? model().changes() : std::vector<session::CameraChange>()) worse += m_bench.calibration().whyWorse(change);
  m_apply->setText(worse.isEmpty() ? tr("Hold to use") : tr("Hold to use, though worse"));
  setWhyNot(m_apply, why, worse.isEmpty() ? tip : tip + QLatin1Char('\n') + worse);
}

void CalibrateStereoPanel::save() {
  askWhereToSave(this, tr("Save the left camera; the right one stands beside it"), QStringLiteral("left.yaml"), {tr("ROS camera file (*.yaml)")}, [this](const QString& left) {
    const QFileInfo info(left);
    QString right = info.completeBaseName();
    right.contains(QStringLiteral("left")) ? right.replace(QStringLiteral("left"), QStringLiteral("right")) : right.append(QStringLiteral("_right"));
    model().save(left, info.path() + QLatin1Char('/') + right + QLatin1Char('.') + info.suffix());
  });
}

void CalibrateStereoPanel::apply() {
  if (!m_apply->isEnabled()) return;
  // Taken before the first is used: then the pose is solved anew.
  const auto changes = model().changes();
  for (const auto& change : changes) {
    const Status applied = m_bench.calibration().apply(change);
    if (!applied) return m_bench.say(QString::fromStdString(applied.error().message));
  }
}

}  // namespace longarm::ui
