#pragma once

/// @file
/// WorldController: the sketched world, as its list and the menus see it.

#include <vector>

#include <QObject>
#include <QString>

#include "session/commands/edit_history.h"
#include "session/document/document.h"

namespace longarm::session {

/// GUI thread only.  Every edit is one undo step.
class WorldController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.
  WorldController(Document& document, EditHistory& history, QObject* parent = nullptr);
  ~WorldController() override;

  const std::vector<WorldItem>& items() const { return m_document.world(); }
  /// Why what is selected cannot be added; empty: it can.
  QString whyNotAdd() const;
  /// Adds what is selected: points as one cloud, everything else as a body of its own.  @returns why not.
  Status addSelected(WorldRole role = WorldRole::kObstacle);
  /// Adds a box as far as the arm reaches, which it is then not to leave.  @returns why not: no robot, or there is one.
  Status addWorkspace();
  void remove(const std::vector<WorldItemId>& ids);
  /// @returns kInvalidInput naming value and limits; nothing is changed then.
  Status edit(const WorldItem& after);

 Q_SIGNALS:
  void changed();

 private:
  std::vector<WorldItem> fromSelection(Status* why) const;

  Document& m_document;
  EditHistory& m_history;
  int m_observer = 0;
};

}  // namespace longarm::session
