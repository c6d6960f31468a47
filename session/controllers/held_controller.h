#pragma once

/// @file
/// HeldController: what the gripper holds, from the moment it says so until it opens.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <QObject>
#include <QString>

#include "planning/world/workcell.h"
#include "session/controllers/world_controller.h"

namespace longarm::session {

/// A body that moves with the tool.
struct HeldBody {
  planning::WorldObject body;              ///< `attached_link` is the arm's tip, X_WO its pose there.
  WorldItemId item;                        ///< The body of the sketched world that it is; invalid: none.
  FeatureId feature;                       ///< The sketched feature that it was measured as; invalid: none.

  /// The body where it is now, in the root frame.  @param q  Full configuration.
  planning::WorldObject at(const planning::Workcell& workcell, const Eigen::VectorXd& q) const;
};

/// When the gripper begins to hold something, this finds out what: the object of the plan whose end the arm stands at, else
/// a known body between the fingers.  While it is held, motions are planned with it; a body of the sketched world is put
/// down where the gripper opens, as one undo step.  GUI thread only.
class HeldController final : public QObject {
  Q_OBJECT

 public:
  /// Borrowed; both outlive this.
  HeldController(Document& document, WorldController& world, QObject* parent = nullptr);

  /// Call with every poll of a robot whose link is up.  @param holding  What the gripper says.  @param q  Full configuration.
  void refresh(bool holding, const Eigen::VectorXd& q);
  /// Nothing is known any more, e.g. because the robot was started anew.
  void forget();

  const std::optional<HeldBody>& held() const { return m_held; }
  /// Bodies that a motion must heed: obstacles and zones of the sketched world, without the one that is held.
  std::vector<planning::WorldObject> obstacles(FeatureId skip) const;

 Q_SIGNALS:
  void changed();
  void said(const QString& sentence);

 private:
  std::optional<HeldBody> find(const Eigen::VectorXd& q) const;
  std::optional<HeldBody> fromPlan(const Eigen::VectorXd& q) const;
  std::optional<HeldBody> fromFingers(const Eigen::VectorXd& q) const;
  void take(const Eigen::VectorXd& q);
  void putDown(const Eigen::VectorXd& q);

  Document& m_document;
  WorldController& m_world;
  std::optional<HeldBody> m_held;
  bool m_holding = false;
  int m_different = 0;                     // Polls in a row that said otherwise.
};

}  // namespace longarm::session
