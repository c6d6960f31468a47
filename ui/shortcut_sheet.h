#pragma once

/// @file
/// ShortcutSheet: every key and mouse gesture on one page.

#include <QDialog>

#include "ui/actions.h"

namespace longarm::ui {

/// Never modal.  The keys are read off the actions, so that the sheet cannot be wrong.  GUI thread only.
class ShortcutSheet final : public QDialog {
  Q_OBJECT

 public:
  explicit ShortcutSheet(const Actions& actions, QWidget* parent = nullptr);
};

/// The page as HTML, for the sheet and for tests.
QString shortcutPage(const Actions& actions);

}  // namespace longarm::ui
