#include "ui/calibrate_intrinsics_panel.h"

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/calibrate_fields.h"
#include "ui/calibrate_parts.h"

namespace longarm::ui {

using session::AutoCapture;
using vision::OverlayRole;

namespace {

constexpr double kArrow = 40;              // Residuals are drawn so many times their size.
constexpr double kEnoughTilt_deg = 60, kEnoughPicture = 0.8, kEnoughSize = 1.6;
constexpr int kColumnWidth = 372;
constexpr double kDepth_m = 1;             // Of the millimetres that are told.

QString px(double value, int decimals = 3) { return QString::number(value, 'f', decimals); }
QString zoomText(const std::optional<double>& zoom) { return zoom ? QString::number(*zoom, 'f', 3) : CalibrateIntrinsicsPanel::tr("not known"); }

// "cy -0.84"
QString strongestCorrelation(const calibration::IntrinsicsResult& result, int of) {
  QString text;
  double strongest = 0;
  for (const int i : result.estimated.indices()) {
    const double scale = std::sqrt(result.covariance(of, of) * result.covariance(i, i));
    if (i == of || scale <= 0 || std::abs(result.covariance(of, i)) <= strongest * scale) continue;
    strongest = std::abs(result.covariance(of, i)) / scale;
    text = QStringLiteral("%1 %2").arg(QString::fromLatin1(calibration::lensParameterName(i)), QString::number(result.covariance(of, i) / scale, 'f', 2));
  }
  return text;
}

}  // namespace

CalibrateIntrinsicsPanel::CalibrateIntrinsicsPanel(Workbench& bench, Appearance& appearance, QWidget* parent) : QWidget(parent), m_bench(bench) {
  auto* row = pageRow(this);
  row->addWidget(buildPicture(appearance), 1);
  const auto [side, column] = framedColumn(this, kColumnWidth);
  m_steps = new QTabWidget(side);
  m_steps->addTab(buildBoardStep(), tr("1 Board"));
  m_steps->addTab(buildViewsStep(), tr("2 Pictures"));
  m_steps->addTab(buildResultStep(appearance), tr("3 Result"));
  column->addWidget(m_steps, 1);
  column->addWidget(buildBars());
  row->addWidget(side);
  bind();
  refresh();
}

QWidget* CalibrateIntrinsicsPanel::buildPicture(Appearance& appearance) {
  const auto [frame, column, row, canvas] = pictureFrame(appearance, this);
  m_canvas = canvas;
  m_show = new QComboBox(frame);
  m_show->addItems({tr("Picture and misses"), tr("Coverage of the picture"), tr("Uncertainty of pixels")});
  m_show->setToolTip(tr("What is drawn: the picture with 40-fold misses, where corners were seen, or how sure each pixel's ray is"));
  row->addWidget(m_show);
  m_info = new QLabel(frame);
  m_info->setObjectName(QStringLiteral("muted"));
  m_info->setTextFormat(Qt::PlainText);
  row->addWidget(m_info, 1);
  return frame;
}

QWidget* CalibrateIntrinsicsPanel::buildBoardStep() {
  auto* page = new QWidget(this);
  auto* column = new QVBoxLayout(page);
  m_board = new BoardForm(page);
  m_source = new QComboBox(page);
  m_board->form()->addRow(tr("Pictures from"), m_source);
  column->addWidget(m_board);
  m_source->setToolTip(tr("Files, or a camera that is looked through live"));
  m_auto = new QCheckBox(tr("Keep by itself when still and sharp"), page);
  m_auto->setChecked(true);
  m_capture = new QPushButton(tr("Keep this picture"), page);
  m_live_text = wordLabel(page);
  m_add = new QPushButton(tr("Add pictures..."), page);
  m_clear = new QPushButton(tr("Start anew"), page);
  column->addWidget(m_auto);
  column->addWidget(m_capture);
  column->addWidget(m_live_text);
  column->addStretch(1);
  auto* row = new QHBoxLayout;
  row->addWidget(m_add);
  row->addWidget(m_clear);
  column->addLayout(row);
  return page;
}

QWidget* CalibrateIntrinsicsPanel::buildViewsStep() {
  auto* page = new QWidget(this);
  auto* column = new QVBoxLayout(page);
  m_views = plainTable({tr("Use"), tr("Picture"), tr("rms px"), tr("Why")}, page);
  column->addWidget(m_views, 1);
  m_remove = new QPushButton(tr("Remove picture"), page);
  column->addWidget(m_remove, 0, Qt::AlignLeft);
  return page;
}

QWidget* CalibrateIntrinsicsPanel::buildResultStep(Appearance& appearance) {
  auto* page = new QWidget(this);
  auto* column = new QVBoxLayout(page);
  auto* row = new QHBoxLayout;
  m_distortion = new QComboBox(page);
  for (const auto& [text, value] : {std::pair{tr("as far as it shows"), -1}, {tr("none"), 0}, {QStringLiteral("k1 k2"), 2},
                                    {QStringLiteral("k1 k2 p1 p2"), 4}, {QStringLiteral("k1 k2 p1 p2 k3"), 5}}) {
    m_distortion->addItem(text, value);
  }
  m_skew = new QComboBox(page);
  m_skew->addItems({tr("skew if it shows"), tr("skew"), tr("no skew")});
  row->addWidget(new QLabel(tr("Distortion"), page));
  row->addWidget(m_distortion, 1);
  row->addWidget(m_skew);
  column->addLayout(row);
  m_parameters = plainTable({tr("Parameter"), tr("Value"), tr("\u00b1 1 sigma"), tr("Goes with")}, page);
  m_parameters->horizontalHeaderItem(3)->setToolTip(tr("The parameter that it is most strongly correlated with: near \u00b11 the pictures do not tell the two apart"));
  column->addWidget(m_parameters, 1);
  m_summary = wordLabel(page);
  column->addWidget(m_summary);
  m_save = new QPushButton(tr("Save..."), page);
  m_target = new QComboBox(page);
  m_target->setToolTip(tr("The camera that took the pictures"));
  m_apply = holdButton(tr("Hold to use"), appearance, page);
  auto* buttons = new QHBoxLayout;
  buttons->addWidget(m_save);
  buttons->addWidget(m_target, 1);
  buttons->addWidget(m_apply);
  column->addLayout(buttons);
  return page;
}

QWidget* CalibrateIntrinsicsPanel::buildBars() {
  auto* box = new QWidget(this);
  auto* form = new QFormLayout(box);
  form->setContentsMargins(0, 0, 0, 0);
  form->setVerticalSpacing(3);
  m_coverage = fillBar(box);
  m_tilt_x = fillBar(box);
  m_tilt_y = fillBar(box);
  m_size = fillBar(box);
  form->addRow(tr("Picture covered"), m_coverage);
  form->addRow(tr("Tilt up and down"), m_tilt_x);
  form->addRow(tr("Tilt left and right"), m_tilt_y);
  form->addRow(tr("Near and far"), m_size);
  m_advice = wordLabel(box);
  m_advice->setMinimumHeight(50);
  form->addRow(m_advice);
  return box;
}

void CalibrateIntrinsicsPanel::bind() {
  connect(m_board, &BoardForm::boardChanged, this, [this] { model().setBoard(m_board->board()); });
  connect(m_board, &BoardForm::refused, &m_bench, &Workbench::said);
  connect(m_source, qOverload<int>(&QComboBox::currentIndexChanged), this, &CalibrateIntrinsicsPanel::chooseSource);
  connect(m_target, qOverload<int>(&QComboBox::currentIndexChanged), this, &CalibrateIntrinsicsPanel::refreshTarget);
  connect(m_show, qOverload<int>(&QComboBox::currentIndexChanged), this, &CalibrateIntrinsicsPanel::refreshPicture);
  for (auto* box : {m_distortion, m_skew}) connect(box, qOverload<int>(&QComboBox::currentIndexChanged), this, &CalibrateIntrinsicsPanel::takeLens);
  connect(m_auto, &QCheckBox::toggled, this, [this](bool on) { model().setAutoCapture(on); });
  connect(m_capture, &QPushButton::clicked, this, [this] { model().capture(); });
  connect(m_clear, &QPushButton::clicked, this, [this] { model().clear(); });
  connect(m_add, &QPushButton::clicked, this, [this] {
    askForFiles(this, tr("Pictures of the board"), {tr("Pictures (*.png *.jpg *.jpeg *.bmp *.tif *.tiff *.pgm *.ppm)"), tr("All files (*)")}, true,
                [this](const QStringList& files) { model().addFiles(files); });
  });
  connect(m_remove, &QPushButton::clicked, this, [this] {
    if (selectedPicture() >= 0) model().remove(static_cast<std::size_t>(selectedPicture()));
  });
  connect(m_views, &QTableWidget::itemSelectionChanged, this, &CalibrateIntrinsicsPanel::refreshPicture);
  connect(m_views, &QTableWidget::itemChanged, this, [this](QTableWidgetItem* item) {
    if (!m_filling && item->column() == 0) model().setIncluded(static_cast<std::size_t>(item->row()), item->checkState() == Qt::Checked);
  });
  connect(m_save, &QPushButton::clicked, this, [this] {
    const QString camera = m_target->currentData().toString();
    askWhereToSave(this, tr("Save the camera"), (camera.isEmpty() ? QStringLiteral("camera") : camera) + QStringLiteral(".yaml"),
                   {tr("ROS camera file (*.yaml)"), tr("OpenCV YAML (*.yml)"), tr("OpenCV XML (*.xml)")},
                   [this, camera](const QString& file) { model().save(camera, file); });
  });
  connect(m_apply, &widgets::HoldButton::held, this, &CalibrateIntrinsicsPanel::apply);
  connect(&model(), &session::IntrinsicsController::changed, this, &CalibrateIntrinsicsPanel::refresh);
  connect(&model(), &session::IntrinsicsController::liveChanged, this, &CalibrateIntrinsicsPanel::refreshLive);
  connect(&model(), &session::IntrinsicsController::saved, this, [this](const QString& file) { m_bench.say(tr("Camera saved to %1").arg(file)); });
  connect(&m_bench.live(), &LivePictures::pictureArrived, this, &CalibrateIntrinsicsPanel::offerLive);
  connect(&m_bench.robot(), &RobotSession::stopChanged, this, &CalibrateIntrinsicsPanel::refreshTarget);
  connect(&m_bench.robot(), &RobotSession::linkChanged, this, [this] {
    if (isVisible()) refreshTarget();
  });
  connect(&m_bench.calibration(), &session::CalibrationController::applied, this, &CalibrateIntrinsicsPanel::refreshTarget);
}

QString CalibrateIntrinsicsPanel::advice() const { return m_advice->text(); }

void CalibrateIntrinsicsPanel::setBoard(const calibration::BoardSpec& board) { m_board->setBoard(board); }

void CalibrateIntrinsicsPanel::takeLens() {
  calibration::LensChoice lens;
  if (const int count = m_distortion->currentData().toInt(); count >= 0) lens.distortion = count;
  if (m_skew->currentIndex() > 0) lens.skew = m_skew->currentIndex() == 1;
  model().setLens(lens);
}

void CalibrateIntrinsicsPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  const auto& workcell = m_bench.document().workcell();
  fillCameras(m_source, workcell.get(), tr("files"));
  fillCameras(m_target, workcell.get());
  chooseSource();
}

void CalibrateIntrinsicsPanel::hideEvent(QHideEvent* event) {
  m_bench.live().setWatched({});
  QWidget::hideEvent(event);
}

void CalibrateIntrinsicsPanel::chooseSource() {
  const QString camera = m_source->currentData().toString();
  m_live = !camera.isEmpty();
  m_bench.live().setWatched(m_live ? QStringList{camera} : QStringList());
  if (m_live) m_target->setCurrentIndex(std::max(0, m_target->findData(camera)));
  model().leaveLive();
  refresh();
}

void CalibrateIntrinsicsPanel::offerLive(const QString& camera) {
  if (!m_live || !isVisible() || camera != m_source->currentData().toString()) return;
  const double stamp_s = m_bench.live().stamp_s(camera);
  model().offerLive(m_bench.live().picture(camera), stamp_s, m_bench.zoomDrive().zoomAt(camera, stamp_s));
}

void CalibrateIntrinsicsPanel::refresh() {
  setWhyNot(m_auto, m_live ? QString() : tr("choose a live camera above."), tr("Every new place of the board is kept once it rests there and is sharp"));
  setWhyNot(m_clear, model().boards().pictures().empty() ? tr("there is nothing.") : QString(), tr("Forget all pictures"));
  refreshBars();
  refreshViews();
  refreshResult();
  refreshLive();
}

void CalibrateIntrinsicsPanel::refreshBars() {
  const auto& outcome = model().outcome();
  const calibration::Coverage coverage = outcome ? outcome->coverage : calibration::Coverage{};
  setBar(m_coverage, coverage.picture / kEnoughPicture, tr("%1 %").arg(100 * coverage.picture, 0, 'f', 0));
  setBar(m_tilt_x, coverage.tilt_x_deg / kEnoughTilt_deg, tr("%1\u00b0").arg(coverage.tilt_x_deg, 0, 'f', 0));
  setBar(m_tilt_y, coverage.tilt_y_deg / kEnoughTilt_deg, tr("%1\u00b0").arg(coverage.tilt_y_deg, 0, 'f', 0));
  setBar(m_size, (coverage.size_ratio - 1) / (kEnoughSize - 1), tr("1 : %1").arg(coverage.size_ratio, 0, 'f', 1));
  if (model().searching()) m_advice->setText(tr("Searching the pictures ..."));
  else if (model().solving()) m_advice->setText(tr("Calculating ..."));
  else if (!outcome) m_advice->setText(model().why());
  else if (outcome->next) m_advice->setText(tr("Next: %1.").arg(QString::fromStdString(outcome->next->words)));
  else m_advice->setText({});
}

void CalibrateIntrinsicsPanel::refreshViews() {
  m_filling = true;
  const auto& pictures = model().boards().pictures();
  const auto& outcome = model().outcome();
  m_views->setRowCount(static_cast<int>(pictures.size()));
  for (int row = 0; row < m_views->rowCount(); ++row) {
    const auto& picture = pictures[static_cast<std::size_t>(row)];
    setTick(m_views, row, 0, picture.view.has_value(), picture.included);
    setCell(m_views, row, 1, QFileInfo(QString::fromStdString(picture.name)).fileName());
    QString rms = QStringLiteral("-"), why = QString::fromStdString(picture.why);
    const auto newest = model().boards().zoom();
    if (picture.view && !picture.included) why = tr("left out by you");
    else if (picture.view && !session::BoardCollection::sameZoom(picture.zoom, newest)) why = tr("another zoom: %1").arg(zoomText(picture.zoom));
    if (const auto view = outcome ? outcome->viewOf(static_cast<std::size_t>(row)) : std::nullopt) {
      const auto& report = outcome->result.views[*view];
      if (report.rms_px >= 0) rms = px(report.rms_px);
      why = QString::fromStdString(report.why);
      if (!report.used) why = tr("not used: %1").arg(why);
      else if (report.outliers > 0) why += tr("%1 corners left out").arg(report.outliers);
    }
    setCell(m_views, row, 2, rms);
    setCell(m_views, row, 3, why);
  }
  m_filling = false;
  m_steps->setTabText(1, pictures.empty() ? tr("2 Pictures") : tr("2 Pictures (%1)").arg(pictures.size()));
}

void CalibrateIntrinsicsPanel::refreshResult() {
  const auto& outcome = model().outcome();
  m_parameters->setRowCount(0);
  if (!outcome) {
    m_summary->setText(model().why());
  } else {
    const auto& result = outcome->result;
    const auto values = calibration::lensVector(result.camera);
    for (const int i : result.estimated.indices()) {
      const int row = m_parameters->rowCount(), decimals = i < calibration::kK1 ? 3 : 5;
      m_parameters->insertRow(row);
      setCell(m_parameters, row, 0, QString::fromLatin1(calibration::lensParameterName(i)));
      setCell(m_parameters, row, 1, px(values[i], decimals));
      setCell(m_parameters, row, 2, px(std::sqrt(std::max(0.0, result.covariance(i, i))), decimals));
      setCell(m_parameters, row, 3, strongestCorrelation(result, i));
    }
    QStringList lines;
    if (outcome->zoom) lines << tr("At zoom %1: add it to the camera's table on the page Zoom.").arg(zoomText(outcome->zoom));
    lines << tr("rms %1 px per component over %2 pictures; rays are uncertain by %3 px on average, %4 px at most (%5 mm at 1 m).")
                          .arg(px(result.rms_px), QString::number(outcome->coverage.views), px(outcome->uncertainty.mean_px), px(outcome->uncertainty.max_px),
                               px(calibration::LensUncertainty::millimetres(outcome->uncertainty.max_px, kDepth_m, result.camera.fx), 2));
    for (const auto& warning : result.warnings) lines << QString::fromStdString(warning);
    m_summary->setText(lines.join(QLatin1Char('\n')));
  }
  refreshTarget();
}

void CalibrateIntrinsicsPanel::refreshTarget() {
  setWhyNot(m_save, model().whyNotSave(), tr("Write a camera file: ROS YAML, or OpenCV's YAML or XML"));
  QString why = model().whyNotSave();
  if (why.isEmpty()) why = m_bench.whyNotCalibrate();
  QString tip = tr("Keep it in the library and use it for this camera from now on");
  if (why.isEmpty()) {
    const auto file = m_bench.calibration().changed(change());
    if (!file) why = QString::fromStdString(file.error().message);
    else if (const QString worse = m_bench.calibration().whyWorse(change()); !worse.isEmpty()) tip += QLatin1Char('\n') + worse;
    m_apply->setText(tip.contains(QLatin1Char('\n')) ? tr("Hold to use, though worse") : tr("Hold to use"));
  }
  setWhyNot(m_apply, why, tip);
}

void CalibrateIntrinsicsPanel::refreshLive() {
  setWhyNot(m_capture, m_live ? model().whyNotCapture() : tr("choose a live camera above."), tr("Keep the live picture whether or not it would be kept by itself"));
  if (!m_live) {
    m_live_text->setText(tr("Open pictures of the board from files, or choose a live camera."));
  } else {
    const auto& live = model().live();
    m_live_text->setText(live ? QString::fromStdString(session::toString(live->verdict)) : tr("Waiting for a picture of %1.").arg(m_source->currentText()));
  }
  refreshPicture();
}

int CalibrateIntrinsicsPanel::selectedPicture() const { return m_views->selectionModel()->hasSelection() ? m_views->currentRow() : -1; }

vision::Overlay CalibrateIntrinsicsPanel::pictureOverlay(std::size_t picture) const {
  vision::Overlay overlay;
  const auto& shown = model().boards().pictures()[picture];
  if (!shown.view) return overlay;
  addBoard(&overlay, OverlayRole::kSketch, *shown.view);
  const auto& outcome = model().outcome();
  const auto view = outcome ? outcome->viewOf(picture) : std::nullopt;
  if (!view || outcome->result.views[*view].rms_px < 0) return overlay;
  const auto residuals = outcome->residuals(*view);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const Eigen::Vector2d at = shown.view->corners[i].pixel;
    addLine(&overlay, OverlayRole::kMiss, {at, at + kArrow * residuals[i]});
  }
  return overlay;
}

vision::Overlay CalibrateIntrinsicsPanel::coverageOverlay() const {
  vision::Overlay overlay;
  const auto& boards = model().boards();
  for (int i = 1; i < 4; ++i) {
    addLine(&overlay, OverlayRole::kSketch, {{boards.width() * i / 4.0, 0}, {boards.width() * i / 4.0, boards.height() - 1.0}});
    addLine(&overlay, OverlayRole::kSketch, {{0, boards.height() * i / 4.0}, {boards.width() - 1.0, boards.height() * i / 4.0}});
  }
  for (const std::size_t i : boards.usable()) {
    for (const auto& corner : boards.pictures()[i].view->corners) addMarker(&overlay, OverlayRole::kDepthTick, corner.pixel);
  }
  return overlay;
}

void CalibrateIntrinsicsPanel::showUncertainty() {
  const auto& outcome = model().outcome();
  if (!outcome) return m_canvas->clearPicture(tr("There is no result yet.\n\n%1").arg(model().why()));
  const auto& pictures = model().boards().pictures();
  const int chosen = selectedPicture();
  const cv::Mat under = chosen >= 0 ? pictures[static_cast<std::size_t>(chosen)].image : pictures[outcome->picture.front()].image;
  const auto& camera = outcome->result.camera;
  m_canvas->setPicture(uncertaintyPicture(under, outcome->uncertainty, camera.width, camera.height));
  vision::Overlay overlay;
  const auto& map = outcome->uncertainty;
  for (int r = 2; r < map.rows; r += 5) {
    for (int c = 2; c < map.columns; c += 7) {
      const auto i = static_cast<std::size_t>(r * map.columns + c);
      if (map.sigma_px[i] >= 0) addText(&overlay, OverlayRole::kLabel, map.pixels[i], px(map.sigma_px[i], 2).toStdString());
    }
  }
  m_canvas->setOverlay(overlay);
  m_info->setText(tr("1 sigma of a pixel's ray [px]: dark %1, yellow %2").arg(px(0, 2), px(map.max_px, 2)));
}

void CalibrateIntrinsicsPanel::refreshPicture() {
  const auto& pictures = model().boards().pictures();
  const auto what = static_cast<Show>(m_show->currentIndex());
  m_canvas->setCamera({});
  if (what == Show::kUncertainty) return showUncertainty();
  const int chosen = selectedPicture();
  vision::Overlay overlay;
  if (m_live && model().live() && (m_steps->currentIndex() != 1 || chosen < 0)) {
    m_canvas->setPicture(model().live()->image);
    if (what == Show::kCoverage) overlay = coverageOverlay();
    if (model().live()->board) addBoard(&overlay, OverlayRole::kSelected, *model().live()->board);
    const auto& outcome = model().outcome();
    if (outcome && outcome->next && outcome->next->outline_px.size() == 4) {
      auto outline = outcome->next->outline_px;
      outline.push_back(outline.front());
      addLine(&overlay, OverlayRole::kUnplaced, outline);
      addText(&overlay, OverlayRole::kUnplaced, outline.front(), tr("hold the board here").toStdString());
    }
    m_info->setText(tr("live: %1").arg(m_live_text->text()));
  } else if (!pictures.empty()) {
    const auto index = static_cast<std::size_t>(chosen >= 0 ? chosen : 0);
    m_canvas->setPicture(pictures[index].image);
    overlay = what == Show::kCoverage ? coverageOverlay() : pictureOverlay(index);
    m_info->setText(what == Show::kCoverage ? tr("every corner of the pictures in use")
                                            : tr("%1: misses drawn %2-fold").arg(QFileInfo(QString::fromStdString(pictures[index].name)).fileName()).arg(kArrow));
  } else {
    m_canvas->clearPicture(m_live ? tr("Waiting for a picture of %1.").arg(m_source->currentText()) : tr("No pictures yet.\n\nAdd pictures of a board, or choose a live camera."));
    m_info->setText({});
  }
  m_canvas->setOverlay(overlay);
}

void CalibrateIntrinsicsPanel::show(Show what) { m_show->setCurrentIndex(static_cast<int>(what)); }

session::CameraChange CalibrateIntrinsicsPanel::change() const {
  session::CameraChange change;
  change.camera = m_target->currentData().toString().toStdString();
  change.kind = "intrinsics";
  const auto& outcome = model().outcome();
  if (!outcome) return change;
  change.lens = outcome->result.camera;
  change.lens_covariance = outcome->result.covariance;
  change.rms_px = outcome->result.rms_px;
  for (const auto& view : outcome->result.views) change.observations += view.used ? view.corners - view.outliers : 0;
  change.raw = session::cornersText(outcome->views);
  change.raw_ending = "csv";
  return change;
}

void CalibrateIntrinsicsPanel::apply() {
  if (!m_apply->isEnabled()) return;
  const Status applied = m_bench.calibration().apply(change());
  if (!applied) m_bench.say(QString::fromStdString(applied.error().message));
}

}  // namespace longarm::ui
