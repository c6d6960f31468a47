// The guide's section "Your own pictures" followed to the letter: a box is measured in two photographs whose truth is known.
#include <fstream>

#include <QFileDialog>
#include <QLineEdit>
#include <QTableView>
#include <QTest>

#include "tests/support/test_data.h"
#include "tests/ui/window_fixture.h"
#include "tests/vision/middlebury_data.h"

namespace longarm {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ui::ActionId;
using ui::SimulatedHand;
using vision::PaneSide;

class Newcomer : public tests::WindowFixture {
 protected:
  /// The files that the guide asks for.
  QString writeViews(const tests::MiddleburyData& scene, const std::string& pictures) {
    const std::string to = folder.path().toStdString();
    std::ofstream views(to + "/views.yaml");
    views << "views:\n";
    for (const bool right : {false, true}) {
      const auto camera = scene.view(right).camera;
      const std::string name = right ? "right" : "left";
      std::ofstream(to + "/" + name + ".yaml")
          << "image_width: " << camera.width << "\nimage_height: " << camera.height << "\ncamera_name: " << name
          << "\ncamera_matrix: {rows: 3, cols: 3, data: [" << camera.fx << ", 0, " << camera.cx << ", 0, " << camera.fy << ", " << camera.cy
          << ", 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";
      views << "  - name: " << name << "\n    image: " << pictures << (right ? "/im1.png" : "/im0.png") << "\n    camera: " << name
            << ".yaml\n    pose: {parent: left_camera, xyz: [" << (right ? scene.baseline : 0) << ", 0, 0], quaternion_xyzw: [0, 0, 0, 1]}\n";
    }
    return folder.filePath(QStringLiteral("views.yaml"));
  }
  /// File > Open views file, the path typed into its dialog.
  void openViews(const QString& path) {
    window->actions().at(ActionId::kOpenViews)->trigger();
    auto* dialog = window->findChild<QFileDialog*>();
    ASSERT_NE(dialog, nullptr);
    auto* edit = dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"));
    ASSERT_NE(edit, nullptr);
    edit->setText(path);
    QTest::keyClick(edit, Qt::Key_Return);
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->document().snapshots().size() == 2; }, 30));
    SimulatedHand::pump(100);
  }
  void click(PaneSide side, const Vector2d& pixel) {
    auto* canvas = window->pictures()->pane(side)->canvas();
    hand.click(canvas, canvas->widgetOfPixel(pixel)->toPoint());     // whole pixels of the screen, as a real mouse
  }
};

TEST_F(Newcomer, MeasuresTheRimOfABinInTwoPhotographs) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string pictures = tests::dataFolder() + "/middlebury2014_quarter/Recycle";
  const tests::MiddleburyData scene = tests::loadMiddlebury(pictures);
  ASSERT_FALSE(scene.disparity.empty());
  openWindow(QStringLiteral("dark"), {1600, 950});
  openViews(writeViews(scene, pictures));
  EXPECT_FALSE(window->pictures()->pane(PaneSide::kLeft)->live()) << "what was opened is what is seen";
  // The corner of the rim next to the cameras, and the ends of its three edges; beside each, a spot of the same face whose
  // disparity the data knows.
  const Vector2d corners[] = {{400.5, 128.8}, {138.3, 116.2}, {448.5, 99.6}, {399.6, 155.2}};
  const Vector2d inside[] = {{396, 133}, {144, 122}, {444, 107}, {395, 150}};
  std::vector<Vector2d> right;
  std::vector<Vector3d> truth;
  for (int i = 0; i < 4; ++i) {
    const double disparity = scene.at(static_cast<int>(inside[i].x()), static_cast<int>(inside[i].y()));
    ASSERT_TRUE(std::isfinite(disparity)) << "corner " << i;
    right.push_back(corners[i] - Vector2d(disparity, 0));
    const double z = scene.baseline * scene.f / (disparity + scene.doffs);
    truth.push_back({(corners[i].x() - scene.cx0) * z / scene.f, (corners[i].y() - scene.cy) * z / scene.f, z});
  }
  window->actions().at(ActionId::kToolTriad)->trigger();
  ASSERT_EQ(bench->targeting().tool(), session::ToolKind::kTriad);
  for (const auto& corner : corners) click(PaneSide::kLeft, corner);
  look(QStringLiteral("newcomer-left"));
  for (const auto& corner : right) click(PaneSide::kRight, corner);
  ASSERT_EQ(bench->document().items().size(), 1U);
  const auto& measured = bench->document().measurement(bench->document().items()[0].id);
  ASSERT_TRUE(measured.feature) << measured.reason;
  ASSERT_TRUE(measured.feature->box);
  look(QStringLiteral("newcomer-measured"));
  for (int edge = 0; edge < 3; ++edge) {
    const double true_length = (truth[static_cast<std::size_t>(edge) + 1] - truth[0]).norm();
    const double sigma = measured.feature->box->sizeSigma()[edge];
    EXPECT_NEAR(measured.feature->box->size[edge], true_length, 3 * sigma + 0.01) << "edge " << edge + 1;
    EXPECT_LT(sigma, 0.08) << "edge " << edge + 1;
  }
  const auto rows = bench->targeting().rows();
  ASSERT_EQ(rows.size(), 1U);
  bool listed = false;
  for (auto* table : window->findChildren<QTableView*>()) {
    for (int column = 0; table->model() != nullptr && column < table->model()->columnCount(); ++column) {
      listed = listed || table->model()->index(0, column).data().toString() == QString::fromStdString(rows[0].length_text);
    }
  }
  EXPECT_TRUE(listed) << "the size stands in the list: " << rows[0].length_text;
}

}  // namespace
}  // namespace longarm
