#include "ui/calibrate_parts.h"

#include <algorithm>

#include <QComboBox>
#include <QFileDialog>
#include <QFrame>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QTableWidget>
#include <QVBoxLayout>
#include <opencv2/imgproc.hpp>

namespace longarm::ui {

namespace {

constexpr int kHold_ms = 800;

QFileDialog* fileDialog(QWidget* parent, const QString& title, const QStringList& filters) {
  auto* dialog = new QFileDialog(parent, title);
  dialog->setOption(QFileDialog::DontUseNativeDialog);
  dialog->setNameFilters(filters);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  return dialog;
}

}  // namespace

QHBoxLayout* pageRow(QWidget* page) {
  auto* row = new QHBoxLayout(page);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(4);
  return row;
}

FramedColumn framedColumn(QWidget* page, int width) {
  auto* frame = new QFrame(page);
  frame->setObjectName(QStringLiteral("panel"));
  if (width > 0) frame->setFixedWidth(width);
  auto* column = new QVBoxLayout(frame);
  column->setContentsMargins(6, 6, 6, 6);
  return {frame, column};
}

PictureFrame pictureFrame(Appearance& appearance, QWidget* page) {
  const auto [frame, column] = framedColumn(page);
  column->setContentsMargins(4, 4, 4, 4);
  column->setSpacing(3);
  auto* controls = new QHBoxLayout;
  column->addLayout(controls);
  auto* canvas = new widgets::ImageCanvas(vision::PaneSide::kLeft, frame);
  const auto style = [canvas, &appearance] { canvas->setTheme(appearance.theme()); };
  style();
  QObject::connect(&appearance, &Appearance::changed, canvas, style);
  column->addWidget(canvas, 1);
  return {frame, column, controls, canvas};
}

QLabel* wordLabel(QWidget* parent, bool muted) {
  auto* label = new QLabel(parent);
  label->setTextFormat(Qt::PlainText);
  label->setWordWrap(true);
  label->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  if (muted) label->setObjectName(QStringLiteral("muted"));
  return label;
}

QProgressBar* fillBar(QWidget* parent) {
  auto* bar = new QProgressBar(parent);
  bar->setRange(0, 100);
  bar->setFixedHeight(18);
  return bar;
}

QTableWidget* plainTable(const QStringList& columns, QWidget* parent) {
  auto* table = new QTableWidget(0, columns.size(), parent);
  table->setHorizontalHeaderLabels(columns);
  table->verticalHeader()->hide();
  table->verticalHeader()->setDefaultSectionSize(24);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setSelectionMode(QAbstractItemView::SingleSelection);
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setAlternatingRowColors(true);
  table->setShowGrid(false);
  table->setWordWrap(false);
  table->horizontalHeader()->setHighlightSections(false);
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table->horizontalHeader()->setStretchLastSection(true);
  return table;
}

void setCell(QTableWidget* table, int row, int column, const QString& text) {
  QTableWidgetItem* item = table->item(row, column);
  if (item == nullptr) {
    item = new QTableWidgetItem;
    table->setItem(row, column, item);
  }
  item->setText(text);
  item->setToolTip(text.toHtmlEscaped());
}

void setTick(QTableWidget* table, int row, int column, bool possible, bool ticked) {
  setCell(table, row, column, {});
  auto* item = table->item(row, column);
  item->setFlags(possible ? Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable : Qt::ItemIsEnabled | Qt::ItemIsSelectable);
  item->setCheckState(possible && ticked ? Qt::Checked : Qt::Unchecked);
}

widgets::HoldButton* holdButton(const QString& text, Appearance& appearance, QWidget* parent) {
  auto* button = new widgets::HoldButton(text, kHold_ms, parent);
  const auto style = [button, &appearance] { button->setTheme(appearance.theme()); };
  style();
  QObject::connect(&appearance, &Appearance::changed, button, style);
  button->setMinimumHeight(30);
  return button;
}

void setWhyNot(QWidget* widget, const QString& why, const QString& tip) {
  widget->setEnabled(why.isEmpty());
  const QString text = why.isEmpty() ? tip : tip + QLatin1Char('\n') + QObject::tr("Not now: %1").arg(why);
  widget->setToolTip(text.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
}

void fillCameras(QComboBox* box, const planning::Workcell* workcell, const QString& first) {
  const QSignalBlocker quiet(box);
  const QString chosen = box->currentData().toString();
  box->clear();
  if (!first.isEmpty()) box->addItem(first, QString());
  if (workcell != nullptr) {
    for (const auto& camera : workcell->cameras) {
      const QString name = QString::fromStdString(camera.name);
      box->addItem(name, name);
    }
  }
  box->setCurrentIndex(std::max(0, box->findData(chosen)));
  box->setEnabled(box->count() > 0);
}

void askForFiles(QWidget* parent, const QString& title, const QStringList& filters, bool many, const std::function<void(const QStringList&)>& chosen) {
  auto* dialog = fileDialog(parent, title, filters);
  dialog->setFileMode(many ? QFileDialog::ExistingFiles : QFileDialog::ExistingFile);
  QObject::connect(dialog, &QFileDialog::filesSelected, parent, [chosen](const QStringList& files) { chosen(files); });
  dialog->show();
}

void askWhereToSave(QWidget* parent, const QString& title, const QString& name, const QStringList& filters, const std::function<void(const QString&)>& chosen) {
  auto* dialog = fileDialog(parent, title, filters);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setFileMode(QFileDialog::AnyFile);
  dialog->selectFile(name);
  QObject::connect(dialog, &QFileDialog::fileSelected, parent, [chosen](const QString& file) { chosen(file); });
  dialog->show();
}

void addMarker(vision::Overlay* overlay, vision::OverlayRole role, const Eigen::Vector2d& at) {
  overlay->shapes.push_back({vision::OverlayShape::Kind::kMarker, role, {at}, {}});
}

void addLine(vision::Overlay* overlay, vision::OverlayRole role, std::vector<Eigen::Vector2d> points) {
  overlay->shapes.push_back({vision::OverlayShape::Kind::kPolyline, role, std::move(points), {}});
}

void addText(vision::Overlay* overlay, vision::OverlayRole role, const Eigen::Vector2d& at, const std::string& text) {
  overlay->shapes.push_back({vision::OverlayShape::Kind::kText, role, {at}, text});
}

void addBoard(vision::Overlay* overlay, vision::OverlayRole role, const calibration::BoardView& board) {
  std::vector<Eigen::Vector2d> path;
  for (const auto& corner : board.corners) path.push_back(corner.pixel);
  addLine(overlay, role, path);
  for (const auto& pixel : path) addMarker(overlay, vision::OverlayRole::kDepthTick, pixel);
}

cv::Mat uncertaintyPicture(const cv::Mat& picture, const calibration::LensUncertainty& map, int width, int height) {
  cv::Mat values(map.rows, map.columns, CV_8U);
  for (int i = 0; i < map.rows * map.columns; ++i) {
    const double sigma = map.sigma_px[static_cast<std::size_t>(i)];
    values.at<uchar>(i / map.columns, i % map.columns) = cv::saturate_cast<uchar>(sigma < 0 || map.max_px <= 0 ? 255 : 255 * sigma / map.max_px);
  }
  cv::Mat large, colours, under;
  cv::resize(values, large, {width, height}, 0, 0, cv::INTER_LINEAR);
  cv::applyColorMap(large, colours, cv::COLORMAP_VIRIDIS);
  if (picture.cols != width || picture.rows != height) return colours;
  if (picture.channels() == 1) cv::cvtColor(picture, under, cv::COLOR_GRAY2BGR);
  else under = picture;
  cv::addWeighted(under, 0.45, colours, 0.55, 0, colours);
  return colours;
}

}  // namespace longarm::ui
