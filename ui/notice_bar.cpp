#include "ui/notice_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

namespace longarm::ui {

NoticeBar::NoticeBar(QWidget* parent) : QFrame(parent) {
  setObjectName(QStringLiteral("strip"));
  m_layout = new QVBoxLayout(this);
  m_layout->setContentsMargins(8, 3, 8, 3);
  m_layout->setSpacing(3);
  hide();
}

void NoticeBar::post(const QString& key, const QString& text, const std::vector<NoticeAnswer>& answers) {
  clear(key);
  auto* row = new QWidget(this);
  auto* layout = new QHBoxLayout(row);
  layout->setContentsMargins(0, 0, 0, 0);
  auto* mark = new QLabel(tr("Notice"), row);
  mark->setObjectName(QStringLiteral("badge"));
  mark->setProperty("level", QStringLiteral("amber"));
  layout->addWidget(mark);
  auto* label = new QLabel(text, row);
  label->setTextFormat(Qt::PlainText);
  label->setWordWrap(true);
  layout->addWidget(label, 1);
  for (const auto& answer : answers) {
    auto* button = new QPushButton(answer.text, row);
    button->setFocusPolicy(Qt::TabFocus);
    connect(button, &QPushButton::clicked, this, [this, key, act = answer.act] {
      clear(key);
      if (act) act();
    });
    layout->addWidget(button);
  }
  m_layout->addWidget(row);
  m_rows[key] = row;
  show();
}

void NoticeBar::clear(const QString& key) {
  const auto found = m_rows.find(key);
  if (found == m_rows.end()) return;
  found->second->hide();
  found->second->deleteLater();
  m_rows.erase(found);
  setVisible(!m_rows.empty());
}

}  // namespace longarm::ui
