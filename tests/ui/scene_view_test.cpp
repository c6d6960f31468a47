// The 3-D scene in a window: something is really drawn.
#include <QScreen>
#include <QSet>
#include <QTest>

#include "ui/simulated_hand.h"
#include "widgets/scene/ground_grid_rep.h"
#include "widgets/scene_view.h"

namespace longarm {
namespace {

int colours(const QImage& image) {
  QSet<QRgb> seen;
  for (int y = 0; y < image.height(); y += 3) {
    for (int x = 0; x < image.width(); x += 3) seen.insert(image.pixel(x, y));
  }
  return seen.size();
}

TEST(SceneView, DrawsItsGradientAndAGridOnTheScreen) {
  widgets::SceneView view;
  scene::GroundGridRep grid;
  grid.update(3, 0.25);
  grid.addTo(view.renderer());
  view.resize(500, 400);
  view.show();
  view.showPreset(scene::CameraPreset::kIso);
  ASSERT_TRUE(ui::SimulatedHand::waitFor([&] { return view.renderCount() > 0; }, 10));
  ui::SimulatedHand::pump(300);
  ASSERT_TRUE(view.usable());
  const QImage screen = view.screen()->grabWindow(view.winId()).toImage();
  EXPECT_GT(colours(screen), 20) << "renders " << view.renderCount();
  EXPECT_GT(colours(view.grab().toImage()), 20);
}

}  // namespace
}  // namespace longarm
