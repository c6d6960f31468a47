#include "widgets/resources.h"

#include <QDir>

// The macro must stand outside any namespace.
static void registerResources() {
  Q_INIT_RESOURCE(icons);
  Q_INIT_RESOURCE(styles);
}

namespace longarm::widgets {

void initResources() { registerResources(); }

}  // namespace longarm::widgets
