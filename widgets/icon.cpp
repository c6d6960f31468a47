#include "widgets/icon.h"

#include <QFile>
#include <QPainter>
#include <QPixmap>
#include <QSvgRenderer>

namespace longarm::widgets {

namespace {

QPixmap drawn(QByteArray svg, const QColor& color, int size) {
  svg.replace("#000000", color.name().toLatin1());
  QSvgRenderer renderer(svg);
  QPixmap pixmap(size, size);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  renderer.render(&painter);
  return pixmap;
}

}  // namespace

QIcon icon(const QString& action, const Theme& theme) {
  QFile file(QStringLiteral(":/icons/%1.svg").arg(action));
  if (!file.open(QIODevice::ReadOnly)) return {};
  const QByteArray svg = file.readAll();
  QColor faint = theme.text;
  faint.setAlphaF(1);
  faint = QColor::fromRgbF((theme.text.redF() + theme.panel.redF()) / 2, (theme.text.greenF() + theme.panel.greenF()) / 2,
                           (theme.text.blueF() + theme.panel.blueF()) / 2);
  QIcon result;
  for (const int size : {16, 24, 32, 48, 64}) {
    result.addPixmap(drawn(svg, theme.text, size), QIcon::Normal, QIcon::Off);
    result.addPixmap(drawn(svg, theme.on_selection, size), QIcon::Normal, QIcon::On);
    result.addPixmap(drawn(svg, theme.on_selection, size), QIcon::Selected, QIcon::Off);
    result.addPixmap(drawn(svg, faint, size), QIcon::Disabled, QIcon::Off);
    result.addPixmap(drawn(svg, faint, size), QIcon::Disabled, QIcon::On);
  }
  return result;
}

}  // namespace longarm::widgets
