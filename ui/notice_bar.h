#pragma once

/// @file
/// NoticeBar: what waits for the operator's answer, without a dialog.

#include <functional>
#include <map>
#include <vector>

#include <QFrame>
#include <QString>

class QVBoxLayout;

namespace longarm::ui {

/// One answer the operator may give.
struct NoticeAnswer {
  QString text;
  std::function<void()> act;
};

/// A row per notice with its buttons; hidden when there is none.  It never takes the focus.  GUI thread only.
class NoticeBar final : public QFrame {
  Q_OBJECT

 public:
  explicit NoticeBar(QWidget* parent = nullptr);
  /// Shows or replaces the notice of this key.  An answer also takes the notice away.
  void post(const QString& key, const QString& text, const std::vector<NoticeAnswer>& answers);
  void clear(const QString& key);
  bool has(const QString& key) const { return m_rows.count(key) != 0; }

 private:
  QVBoxLayout* m_layout;
  std::map<QString, QWidget*> m_rows;
};

}  // namespace longarm::ui
