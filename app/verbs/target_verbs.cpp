// target, epipolar, undistort
#include "app/verbs/cli.h"
#include "core/text.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/undistort.h"
#include "vision/match/suggest.h"
#include "vision/snapshot/image_file.h"
#include "vision/snapshot/views_file.h"
#include "vision/stereo/epipolar.h"

namespace longarm::app {
namespace {

struct TargetOptions {
  std::string views, picks;
};

struct EpipolarVerbOptions {
  std::string views, from, to, pixel, depth;
  bool suggest = false;
};

struct UndistortOptions {
  std::string camera, in, out, camera_out;
};

std::string millimetres(double metres) { return formatFixed(metres * 1e3, 2); }

constexpr double kDegree = 0.017453292519943295;

// What the kind measures beyond its vertices, as a line of text.
std::string shapeNote(const std::string& name, const vision::Feature& feature) {
  std::string note;
  if (feature.kind == vision::FeatureKind::kLine) {
    note += name + ": length " + millimetres(feature.length()) + " mm +- " + millimetres(2 * feature.lengthSigma()) + " mm\n";
  }
  if (feature.pipe) {
    note += name + ": radius " + millimetres(feature.pipe->radius) + " mm +- " + millimetres(2 * feature.pipe->radius_sigma) + " mm\n";
  }
  if (feature.plane) {
    const auto& n = feature.plane->normal;
    note += name + ": normal " + formatFixed(n.x(), 4) + " " + formatFixed(n.y(), 4) + " " + formatFixed(n.z(), 4) + " +- " +
            formatFixed(2 * feature.plane->angleError() / kDegree, 2) + " degrees\n";
  }
  if (feature.box) {
    const auto sigma = feature.box->sizeSigma();
    note += name + ": box";
    for (int i = 0; i < 3; ++i) {
      note += (i == 0 ? " " : " x ") + millimetres(feature.box->size[i]) + " mm (+- " + millimetres(2 * sigma[i]) + ")";
    }
    note += ", edges off 90 degrees by " + formatFixed(feature.box->orthogonality_error / kDegree, 2) + "\n";
  }
  return note;
}

std::string targetTable(const std::vector<vision::MeasuredFeature>& features) {
  std::vector<std::vector<std::string>> rows = {{"feature", "kind", "vertex", "x m", "y m", "z m", "+-mm (2 sigma)", "miss mm", "rms px"}};
  std::string notes;
  for (const auto& f : features) {
    if (!f.outcome) {
      notes += f.name + ": " + f.outcome.error().message + "\n";
      continue;
    }
    int index = 0;
    for (const auto& v : f.outcome->vertices) {
      rows.push_back({f.name, vision::toString(f.kind), std::to_string(index++), formatFixed(v.xyz.x(), 4), formatFixed(v.xyz.y(), 4),
                      formatFixed(v.xyz.z(), 4), millimetres(2 * std::sqrt(v.covariance.trace())), millimetres(v.miss_m),
                      formatFixed(v.reprojection_rms_px, 2)});
    }
    notes += shapeNote(f.name, *f.outcome);
    for (const auto& warning : f.outcome->warnings) notes += f.name + ": warning: " + warning + "\n";
  }
  return tableText(rows) + notes;
}

Result<Answer> runTarget(const TargetOptions& options) {
  const auto views = vision::readViewsFile(options.views);
  if (!views) return views.error();
  const auto picks = vision::readPicksFile(options.picks);
  if (!picks) return picks.error();
  const auto features = vision::measureAll(*views, *picks);
  if (!features) return Error{features.error().code, options.picks + ": " + features.error().message};
  bool any = false;
  for (const auto& f : *features) any = any || f.outcome.ok();
  return Answer{vision::targetJson(*features), targetTable(*features), any ? kExitDone : kExitNoSolution};
}

Result<const vision::View*> viewOption(const vision::ViewSet& views, const std::string& option, const std::string& name) {
  const vision::View* view = views.find(name);
  if (view != nullptr) return view;
  std::string names;
  for (const auto& entry : views.entries) names += (names.empty() ? "" : ", ") + entry.view.name;
  return Error{ErrorCode::kInvalidInput, option + ": there is no view \"" + name + "\"; the file has " + names};
}

Result<vision::MatchPicture> pictureOf(const vision::ViewSet& views, const vision::View& view) {
  for (const auto& entry : views.entries) {
    if (&entry.view != &view) continue;
    if (entry.image.empty()) {
      return Error{ErrorCode::kInvalidInput, "--suggest: view \"" + view.name + "\" has no picture; add `image:` to the views file"};
    }
    const auto image = vision::loadImage(entry.image);
    if (!image) return image.error();
    auto picture = vision::MatchPicture::from(*image);
    if (!picture) return Error{picture.error().code, entry.image + ": " + picture.error().message};
    return picture;
  }
  return Error{ErrorCode::kInternal, "view \"" + view.name + "\" is not of this file"};
}

// Adds `matches` to the answer: where the pick's neighbourhood is seen again.
Result<Answer> addMatches(const vision::ViewSet& views, const vision::View& from, const Eigen::Vector2d& pixel, const vision::View& to,
                          const vision::EpipolarOptions& epipolar, Answer answer) {
  const auto from_picture = pictureOf(views, from);
  if (!from_picture) return from_picture.error();
  const auto to_picture = pictureOf(views, to);
  if (!to_picture) return to_picture.error();
  vision::MatchOptions options;
  options.min_depth = epipolar.min_depth;
  options.max_depth = epipolar.max_depth;
  const auto matches = vision::suggestMatches(from, *from_picture, pixel, to, *to_picture, options);
  if (!matches) return matches.error();
  answer.json["matches"] = nlohmann::json::array();
  std::vector<std::vector<std::string>> rows = {{"match u px", "v px", "depth m", "score", "ambiguity"}};
  for (const auto& m : *matches) {
    const auto& c = m.covariance;
    answer.json["matches"].push_back({{"u", m.pixel.x()}, {"v", m.pixel.y()}, {"depth", m.depth}, {"score", m.score},
                                      {"ambiguity", m.ambiguity}, {"covariance_px", {c(0, 0), c(0, 1), c(1, 0), c(1, 1)}}});
    rows.push_back({formatFixed(m.pixel.x(), 2), formatFixed(m.pixel.y(), 2), formatFixed(m.depth, 3), formatFixed(m.score, 2),
                    formatFixed(m.ambiguity, 2)});
  }
  if (matches->empty()) {
    return noSolution(answer.json, "no_match", "nothing along the curve in " + to.name +
                                                   " looks like the pick: it has no texture, or is hidden there; pick by hand");
  }
  answer.table += tableText(rows);
  return answer;
}

Result<Answer> runEpipolar(const EpipolarVerbOptions& options) {
  const auto views = vision::readViewsFile(options.views);
  if (!views) return views.error();
  const auto from = viewOption(*views, "--from", options.from);
  if (!from) return from.error();
  const auto to = viewOption(*views, "--to", options.to);
  if (!to) return to.error();
  const auto pixel = numbersOption("--pixel", options.pixel);
  if (!pixel) return pixel.error();
  if (pixel->size() != 2) return Error{ErrorCode::kInvalidInput, "--pixel: write u,v"};
  vision::EpipolarOptions epipolar;
  if (!options.depth.empty()) {
    const auto depth = numbersOption("--depth", options.depth);
    if (!depth) return depth.error();
    if (depth->size() != 2) return Error{ErrorCode::kInvalidInput, "--depth: write min,max in metres"};
    epipolar.min_depth = (*depth)[0];
    epipolar.max_depth = (*depth)[1];
  }
  const auto curve = vision::epipolarCurve(**from, pixel->head<2>(), **to, epipolar);
  if (!curve) return curve.error();
  nlohmann::json json = {{"from", options.from}, {"to", options.to}, {"curve_px", nlohmann::json::array()},
                         {"depths", nlohmann::json::array()}};
  std::vector<std::vector<std::string>> rows = {{"u px", "v px", "depth m"}};
  for (const auto& p : curve->points) {
    json["curve_px"].push_back({p.pixel.x(), p.pixel.y()});
    json["depths"].push_back(p.depth);
    if (p.begins_piece) json["breaks"].push_back(rows.size() - 1);
    rows.push_back({formatFixed(p.pixel.x(), 2), formatFixed(p.pixel.y(), 2), formatFixed(p.depth, 3)});
  }
  if (curve->points.empty()) {
    if (options.suggest) json["matches"] = nlohmann::json::array();
    return noSolution(json, "not_visible", "no point of this pixel's ray between " + formatNumber(epipolar.min_depth) + " m and " +
                                               formatNumber(epipolar.max_depth) + " m is seen by " + options.to);
  }
  Answer answer{json, tableText(rows), kExitDone};
  if (!options.suggest) return answer;
  return addMatches(*views, **from, pixel->head<2>(), **to, epipolar, std::move(answer));
}

Result<Answer> runUndistort(const UndistortOptions& options) {
  const auto camera = vision::readCameraFile(options.camera);
  if (!camera) return camera.error();
  const auto image = vision::loadImage(options.in);
  if (!image) return image.error();
  auto undistorted = vision::undistortImage(*image, camera->camera);
  if (!undistorted) return Error{undistorted.error().code, options.in + ": " + undistorted.error().message};
  if (const auto saved = vision::saveImage(options.out, undistorted->image); !saved) return saved.error();
  vision::CameraFile file{undistorted->camera, camera->pose, {}};
  if (!options.camera_out.empty()) {
    if (const auto saved = vision::writeCameraFile(options.camera_out, file); !saved) return saved.error();
  }
  return Answer{{{"camera", vision::toJson(file)}, {"out", options.out}}, "wrote " + options.out + "\n", kExitDone};
}

}  // namespace

void addTargetVerbs(Cli& cli) {
  cli.addVerb<TargetOptions>(
      cli.app(), "target", "Measure points, lines, planes, boxes and pipes from picks in two or more views",
      "longarm target --views views.yaml --picks picks.csv --json",
      [](CLI::App& verb, TargetOptions& options) {
        verb.add_option("--views", options.views, "Cameras of the measurement (views.yaml)")->required();
        verb.add_option("--picks", options.picks, "Picks: feature,kind,vertex,view,u,v (picks.csv)")->required();
      },
      runTarget);
  cli.addVerb<EpipolarVerbOptions>(
      cli.app(), "epipolar", "Where a pixel of one view may lie in another",
      "longarm epipolar --views views.yaml --from left --pixel 320,240 --to right --depth 0.5,3 --json",
      [](CLI::App& verb, EpipolarVerbOptions& options) {
        verb.add_option("--views", options.views, "Cameras (views.yaml)")->required();
        verb.add_option("--from", options.from, "View of the pick")->required();
        verb.add_option("--pixel", options.pixel, "The pick, u,v in raw pixels")->required();
        verb.add_option("--to", options.to, "View that the curve is wanted in")->required();
        verb.add_option("--depth", options.depth, "Nearest and farthest depth in the first camera, min,max in metres (default 0.15,20)");
        verb.add_flag("--suggest", options.suggest, "Look for the pick's neighbourhood along the curve (the views need pictures)");
      },
      runEpipolar);
  cli.addVerb<UndistortOptions>(
      cli.app(), "undistort", "Take the lens distortion out of a picture",
      "longarm undistort --camera left.yaml --in left.png --out left_straight.png --json",
      [](CLI::App& verb, UndistortOptions& options) {
        verb.add_option("--camera", options.camera, "Camera file")->required();
        verb.add_option("--in", options.in, "Picture of that camera")->required();
        verb.add_option("--out", options.out, "Where to write (.png or .jpg)")->required();
        verb.add_option("--camera-out", options.camera_out, "Where to write the camera file of the new picture");
      },
      runUndistort);
}

}  // namespace longarm::app
