#include "ui/picture_files_dialog.h"

#include <QDialogButtonBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

namespace longarm::ui {

namespace {

const char* const kNames[] = {QT_TR_NOOP("Left picture"), QT_TR_NOOP("Left camera file"), QT_TR_NOOP("Right picture"),
                              QT_TR_NOOP("Right camera file")};

}  // namespace

PictureFilesDialog::PictureFilesDialog(QWidget* parent) : QDialog(parent) {
  setWindowTitle(tr("Open pictures"));
  setModal(false);
  auto* column = new QVBoxLayout(this);
  auto* what = new QLabel(tr("Two pictures of the same thing, each with the file of the camera that took it. The camera files must hold the "
                             "cameras' poses in one frame; ROS camera_info YAML and OpenCV YAML or XML are understood."), this);
  what->setWordWrap(true);
  column->addWidget(what);
  auto* grid = new QGridLayout;
  column->addLayout(grid);
  for (int field = 0; field < kFields; ++field) {
    auto* edit = m_edits[static_cast<std::size_t>(field)] = new QLineEdit(this);
    edit->setMinimumWidth(420);
    auto* button = new QPushButton(tr("Browse..."), this);
    button->setAutoDefault(false);
    auto* label = new QLabel(tr(kNames[field]), this);
    label->setBuddy(edit);
    grid->addWidget(label, field, 0);
    grid->addWidget(edit, field, 1);
    grid->addWidget(button, field, 2);
    connect(button, &QPushButton::clicked, this, [this, field] { browse(field); });
    connect(edit, &QLineEdit::textChanged, this, &PictureFilesDialog::refresh);
  }
  m_problem = new QLabel(this);
  m_problem->setTextFormat(Qt::PlainText);
  m_problem->setWordWrap(true);
  column->addWidget(m_problem);
  m_buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel, this);
  column->addWidget(m_buttons);
  connect(m_buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  connect(m_buttons, &QDialogButtonBox::accepted, this, [this] {
    Q_EMIT chosen(files(kLeftImage, kLeftCamera), files(kRightImage, kRightCamera));
    close();
  });
  refresh();
}

void PictureFilesDialog::setFiles(const session::PictureFiles& left, const session::PictureFiles& right) {
  const std::string* texts[] = {&left.image, &left.camera, &right.image, &right.camera};
  for (std::size_t i = 0; i < m_edits.size(); ++i) m_edits[i]->setText(QString::fromStdString(*texts[i]));
}

session::PictureFiles PictureFilesDialog::files(Field image, Field camera) const {
  session::PictureFiles result;
  result.image = m_edits[image]->text().trimmed().toStdString();
  result.camera = m_edits[camera]->text().trimmed().toStdString();
  return result;
}

void PictureFilesDialog::browse(int field) {
  const bool image = field == kLeftImage || field == kRightImage;
  auto* dialog = new QFileDialog(this, tr(kNames[field]));
  dialog->setOption(QFileDialog::DontUseNativeDialog);
  dialog->setFileMode(QFileDialog::ExistingFile);
  dialog->setNameFilters(image ? QStringList{tr("Pictures (*.png *.jpg *.jpeg *.bmp *.tif *.tiff *.pgm *.ppm)"), tr("All files (*)")}
                               : QStringList{tr("Camera files (*.yaml *.yml *.xml)"), tr("All files (*)")});
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setModal(false);
  auto* edit = m_edits[static_cast<std::size_t>(field)];
  if (!edit->text().isEmpty()) dialog->setDirectory(QFileInfo(edit->text()).path());
  connect(dialog, &QFileDialog::fileSelected, edit, &QLineEdit::setText);
  dialog->show();
}

void PictureFilesDialog::refresh() {
  QString problem;
  for (std::size_t i = 0; i < m_edits.size(); ++i) {
    const QString path = m_edits[i]->text().trimmed();
    if (path.isEmpty()) problem = tr("%1: choose a file.").arg(tr(kNames[i]));
    else if (!QFileInfo(path).isFile()) problem = tr("%1: there is no file %2.").arg(tr(kNames[i]), path);
    if (!problem.isEmpty()) break;
  }
  m_problem->setText(problem);
  auto* open = m_buttons->button(QDialogButtonBox::Open);
  open->setEnabled(problem.isEmpty());
  open->setToolTip(problem);
}

}  // namespace longarm::ui
