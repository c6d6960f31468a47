#include "ui/picture_text.h"

#include <QDateTime>

namespace longarm::ui {

QString pictureTime(double wall_s) {
  if (wall_s <= 0) return {};
  return QDateTime::fromMSecsSinceEpoch(static_cast<qint64>(wall_s * 1000)).toString(QStringLiteral("HH:mm:ss"));
}

}  // namespace longarm::ui
