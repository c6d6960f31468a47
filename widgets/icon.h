#pragma once

/// @file
/// Icons by action name, in the colours of the theme.

#include <QIcon>
#include <QString>

#include "widgets/theme.h"

namespace longarm::widgets {

/// The icon `resources/icons/<action>.svg`; an empty icon when there is none.
QIcon icon(const QString& action, const Theme& theme);

}  // namespace longarm::widgets
