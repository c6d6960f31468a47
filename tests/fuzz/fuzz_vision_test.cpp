// Damaged cameras, pictures, views, picks and features.
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/text.h"
#include "tests/fuzz/damaged_copies.h"
#include "vision/camera/camera_file.h"
#include "vision/sketch/feature.h"
#include "vision/snapshot/image_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::tests {
namespace {

vision::CameraFile goodCamera() {
  vision::CameraFile file;
  vision::CameraModel& camera = file.camera;
  camera.name = "left";
  camera.width = 640;
  camera.height = 480;
  camera.fx = 741.5;
  camera.fy = 738.25;
  camera.cx = 322.5;
  camera.cy = 237.25;
  camera.distortion = {-0.25, 0.08, 0.0007, -0.0004, -0.01};
  file.pose = PoseInParent{"mast", poseFrom({0, 0.125, 1}, {-0.5, 0.5, -0.5, 0.5})};
  file.covariance = Eigen::MatrixXd(Eigen::MatrixXd::Identity(16, 16) * 1e-6);
  return file;
}

// A camera that was taken must be usable everywhere without harm.
Status useCamera(const vision::CameraModel& camera) {
  if (auto status = validate(camera); !status) return status;
  for (const double u : {-1e6, 0.0, 320.0, 639.0, 1e6}) {
    const auto ray = camera.rayOfPixel({u, 240});
    if (!ray) continue;
    EXPECT_TRUE(ray->allFinite());
    const auto back = camera.project(*ray);
    if (back) {
      EXPECT_TRUE(back->allFinite());
    }
  }
  return {};
}

Status readCamera(const std::string& path) {
  const auto file = vision::readCameraFile(path);
  return file ? useCamera(file->camera) : Status(file.error());
}

void damageCameras(vision::CameraFileFormat format, const std::string& name) {
  const ScratchFolder folder;
  ASSERT_TRUE(writeCameraFile(folder.file(name), goodCamera(), format).ok());
  const auto figures = readDamagedCopies(folder, name, contentOf(folder.file(name)), readCamera);
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, CameraRosYaml) { damageCameras(vision::CameraFileFormat::kRosYaml, "camera.yaml"); }
TEST(DamagedFiles, CameraOpenCvYaml) { damageCameras(vision::CameraFileFormat::kOpenCvYaml, "camera.yml"); }
TEST(DamagedFiles, CameraOpenCvXml) { damageCameras(vision::CameraFileFormat::kOpenCvXml, "camera.xml"); }

TEST(DamagedFiles, CameraZoomXml) {
  const ScratchFolder folder;
  const std::string good =
      "<?xml version=\"1.0\"?><SR_world><SR_filename> a.xml </SR_filename><SR_comment>c</SR_comment>\n<SR_cam> zcam\n"
      "<SR_zoom> 0.0 <SR_cam_int>{740.09 741.60 -4.58 344.25 212.84 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> {-0.004 "
      "0.041 0.006 0.009 -0.004 0.034 } </SR_cam_ext> </SR_zoom>\n"
      "<SR_zoom> 0.1 <SR_cam_int> {1004.12 1005.49 -5.17 329.62 227.659 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> "
      "{-0.002 0.041 0.008 0.034 0.004 0.033 } </SR_cam_ext> </SR_zoom>\n"
      "<SR_zoom> 0.3 <SR_cam_int> {2314.0 2319.32 -15.74 321.77 139.95 0. 0. 0. 0.} </SR_cam_int> <SR_cam_ext> "
      "{-0.002 0.042 0.019 0.001 0.003 0.034 } </SR_cam_ext> </SR_zoom></SR_cam></SR_world>\n";
  const auto figures = readDamagedCopies(folder, "zoom.xml", good, [](const std::string& path) -> Status {
    const auto file = vision::readCameraFile(path, 0.05);
    return file ? useCamera(file->camera) : Status(file.error());
  });
  EXPECT_GT(figures.refused, kCopies / 5);
}

std::string picture(const std::string& ending, int type = CV_8UC3) {
  cv::Mat image(24, 32, type);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) image.ptr(v)[u * image.channels()] = static_cast<unsigned char>(u * v);
  }
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes);
  return {bytes.begin(), bytes.end()};
}

void damagePictures(const std::string& name) {
  const ScratchFolder folder;
  readDamagedCopies(folder, name, picture(name.substr(name.find('.'))), [](const std::string& path) -> Status {
    const auto image = vision::loadImage(path);
    if (!image) return image.error();
    EXPECT_FALSE(image->empty());
    return {};
  });
}

TEST(DamagedFiles, PicturePng) { damagePictures("picture.png"); }
TEST(DamagedFiles, PictureJpeg) { damagePictures("picture.jpg"); }
TEST(DamagedFiles, PictureBmp) { damagePictures("picture.bmp"); }
TEST(DamagedFiles, PicturePpm) { damagePictures("picture.ppm"); }
TEST(DamagedFiles, PictureTiff) { damagePictures("picture.tiff"); }

constexpr const char* kViews = R"(views:
  - name: left
    image: left.png
    camera: camera.yaml
    pose: {parent: mast, xyz: [0, 0.125, 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}
    sigma_px: 0.3
  - name: right
    camera: camera.yaml
    pose: {parent: mast, xyz: [0, -0.125, 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}
    pose_covariance: [1e-6,0,0,0,0,0, 0,1e-6,0,0,0,0, 0,0,1e-6,0,0,0, 0,0,0,1e-6,0,0, 0,0,0,0,1e-6,0, 0,0,0,0,0,1e-6]
)";

constexpr const char* kPicks =
    "feature,kind,vertex,view,u,v\n"
    "pipe,line,0,left,300.5,200.25\npipe,line,0,right,220.5,201.25\n"
    "pipe,line,1,left,420.5,210.25\npipe,line,1,right,330.5,211.25\n"
    "dot,point,0,left,100,100\ndot,point,0,right,50,101\n";

// Whatever was read is measured: refused or finite.
Status measure(const vision::ViewSet& views, const std::vector<vision::Pick>& picks, const std::string& path) {
  const auto features = measureAll(views, picks);
  if (!features) return {features.error().code, path + ": " + features.error().message};
  for (const auto& feature : *features) {
    if (!feature.outcome) continue;
    for (const auto& vertex : feature.outcome->vertices) {
      EXPECT_TRUE(vertex.xyz.allFinite() && vertex.covariance.allFinite());
    }
  }
  vision::targetJson(*features).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return {};
}

TEST(DamagedFiles, Views) {
  const ScratchFolder folder;
  ASSERT_TRUE(writeCameraFile(folder.file("camera.yaml"), goodCamera()).ok());
  const auto picks = vision::parsePicks(kPicks, "picks.csv");
  ASSERT_TRUE(picks.ok());
  const auto figures = readDamagedCopies(folder, "views.yaml", kViews, [&](const std::string& path) -> Status {
    const auto views = vision::readViewsFile(path);
    return views ? measure(*views, *picks, path) : Status(views.error());
  });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, Picks) {
  const ScratchFolder folder;
  ASSERT_TRUE(writeCameraFile(folder.file("camera.yaml"), goodCamera()).ok());
  const auto views = vision::readViewsFile(folder.write("views.yaml", kViews));
  ASSERT_TRUE(views.ok());
  const auto figures = readDamagedCopies(folder, "picks.csv", kPicks, [&](const std::string& path) -> Status {
    const auto picks = vision::readPicksFile(path);
    return picks ? measure(*views, *picks, path) : Status(picks.error());
  });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, FeatureJson) {
  const ScratchFolder folder;
  const std::string good = R"({"features": [{"name": "pipe", "kind": "line", "parent": "base_link",
    "vertices": [{"xyz": [0.75, 0.15, 0.45], "covariance": [1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6], "views": ["left", "right"]},
                 {"xyz": [0.75, -0.15, 0.45], "covariance": [1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6], "miss_m": 0.001}],
    "direction": [0, -1, 0], "length": 0.3, "length_sigma": 0.002}]})";
  const auto figures = readDamagedCopies(folder, "feature.json", good, [](const std::string& path) -> Status {
    const auto json = nlohmann::json::parse(contentOf(path), nullptr, false);
    if (json.is_discarded()) return {ErrorCode::kInvalidInput, path + ": is not JSON, as the readers say"};
    const auto feature = vision::featureFromJson(json);
    if (!feature) return {feature.error().code, path + ": " + feature.error().message};
    for (const auto& vertex : feature->vertices) EXPECT_TRUE(vertex.xyz.allFinite() && vertex.covariance.allFinite());
    toJson(*feature).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return {};
  });
  EXPECT_GT(figures.refused, kCopies / 5);
}

}  // namespace
}  // namespace longarm::tests
