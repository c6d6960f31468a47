#pragma once

/// @file
/// PictureFilesDialog: which two pictures and camera files to open.

#include <array>

#include <QDialog>

#include "session/controllers/snapshot_maker.h"

class QDialogButtonBox;
class QLabel;
class QLineEdit;

namespace longarm::ui {

/// Never modal.  GUI thread only.
class PictureFilesDialog final : public QDialog {
  Q_OBJECT

 public:
  explicit PictureFilesDialog(QWidget* parent = nullptr);
  void setFiles(const session::PictureFiles& left, const session::PictureFiles& right);

 Q_SIGNALS:
  void chosen(const longarm::session::PictureFiles& left, const longarm::session::PictureFiles& right);

 private:
  enum Field { kLeftImage, kLeftCamera, kRightImage, kRightCamera, kFields };
  void browse(int field);
  void refresh();
  session::PictureFiles files(Field image, Field camera) const;

  std::array<QLineEdit*, kFields> m_edits;
  QLabel* m_problem;
  QDialogButtonBox* m_buttons;
};

}  // namespace longarm::ui
