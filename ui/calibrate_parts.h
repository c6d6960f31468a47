#pragma once

/// @file
/// Small parts that the calibration panels share.

#include <functional>

#include <QString>
#include <QStringList>
#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "calibration/intrinsics/board_view.h"
#include "calibration/intrinsics/lens_uncertainty.h"
#include "planning/world/workcell.h"
#include "ui/appearance.h"
#include "vision/sketch/pointer_event.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QComboBox;
class QFrame;
class QHBoxLayout;
class QLabel;
class QProgressBar;
class QTableWidget;
class QVBoxLayout;
class QWidget;

namespace longarm::ui {

/// What a page is made of: the parts stand side by side to its very edge.  Owned by the page.
QHBoxLayout* pageRow(QWidget* page);
/// A framed column; a width > 0 is fixed.
struct FramedColumn {
  QFrame* frame = nullptr;
  QVBoxLayout* column = nullptr;
};
FramedColumn framedColumn(QWidget* page, int width = 0);
/// A picture in the colours in force, with a row for what chooses it above; more may follow in the column.
struct PictureFrame {
  QFrame* frame = nullptr;
  QVBoxLayout* column = nullptr;
  QHBoxLayout* controls = nullptr;
  widgets::ImageCanvas* canvas = nullptr;
};
PictureFrame pictureFrame(Appearance& appearance, QWidget* page);

/// A plain-text label over as many lines as it needs.
QLabel* wordLabel(QWidget* parent, bool muted = false);
/// A bar with its text on it, 0 ... 100.
QProgressBar* fillBar(QWidget* parent);
/// A table of rows without row numbers; the last column takes the room.
QTableWidget* plainTable(const QStringList& columns, QWidget* parent);
/// A tick whether a row counts; without one where it cannot.
void setTick(QTableWidget* table, int row, int column, bool possible, bool ticked);
void setCell(QTableWidget* table, int row, int column, const QString& text);
/// A button that is held for 0.8 s, in the colours in force.
widgets::HoldButton* holdButton(const QString& text, Appearance& appearance, QWidget* parent);
/// Enabled unless there is a reason, which becomes the tooltip.
void setWhyNot(QWidget* widget, const QString& why, const QString& tip);
/// The cameras of a workcell (may be null), the chosen one kept; `first` with empty data stands before them.
void fillCameras(QComboBox* box, const planning::Workcell* workcell, const QString& first = {});
/// Asks for files without stopping anything; `chosen` is called with the answer.
void askForFiles(QWidget* parent, const QString& title, const QStringList& filters, bool many, const std::function<void(const QStringList&)>& chosen);
void askWhereToSave(QWidget* parent, const QString& title, const QString& name, const QStringList& filters, const std::function<void(const QString&)>& chosen);

/// @name Overlays
/// @{
void addMarker(vision::Overlay* overlay, vision::OverlayRole role, const Eigen::Vector2d& at);
void addLine(vision::Overlay* overlay, vision::OverlayRole role, std::vector<Eigen::Vector2d> points);
void addText(vision::Overlay* overlay, vision::OverlayRole role, const Eigen::Vector2d& at, const std::string& text);
/// The corners of a board, in order of finding.
void addBoard(vision::Overlay* overlay, vision::OverlayRole role, const calibration::BoardView& board);
/// @}

/// The picture (or grey where there is none) under the map of uncertainty: dark is certain, yellow the most uncertain.
cv::Mat uncertaintyPicture(const cv::Mat& picture, const calibration::LensUncertainty& map, int width, int height);

}  // namespace longarm::ui
