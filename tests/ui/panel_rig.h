#pragma once

/// @file
/// A bench without a robot, its actions, and features of the synthetic scene on it.

#include <QTemporaryDir>

#include "session/commands/sketch_commands.h"
#include "tests/session/synthetic_views.h"
#include "ui/actions.h"
#include "ui/workbench.h"

namespace longarm::tests {

struct PanelRig {
  QTemporaryDir folder;
  ui::Appearance appearance{QStringLiteral("dark")};
  ui::Workbench bench{folder.filePath(QStringLiteral("autosave"))};
  ui::Actions actions{appearance};

  /// A measured line of the synthetic scene.
  FeatureId addLine(const char* name) {
    if (bench.document().snapshots().empty()) {
      bench.history().push(session::addSnapshots(bench.document(), {snapshotOf(1, scene.left), snapshotOf(2, scene.right)}));
    }
    session::SketchItem item;
    item.id = bench.document().nextFeatureId();
    item.kind = vision::FeatureKind::kLine;
    item.name = name;
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      const auto id = bench.document().paneSnapshotId(side);
      item.setPick(id, 0, {scene.pixel(side, scene.a), session::PickState::kFree});
      item.setPick(id, 1, {scene.pixel(side, scene.b), session::PickState::kFree});
    }
    bench.history().push(session::addItem(item));
    return item.id;
  }
  StereoScene scene;
};

}  // namespace longarm::tests
