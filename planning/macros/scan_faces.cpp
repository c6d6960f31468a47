// scan_faces: every visible face of a box, one after the other.
#include <algorithm>

#include "core/text.h"
#include "planning/macros/feature_macro.h"
#include "planning/macros/feature_macros.h"
#include "planning/macros/scan_parameters.h"

namespace longarm::planning {
namespace {

constexpr double kSeen = 0.15;           // cosine between a face's normal and the way to the eye

struct Face {
  std::string name;
  PlanePatch patch;
};

std::vector<Face> visibleFaces(const BoxPatch& box, const Eigen::Vector3d& eye) {
  std::vector<Face> faces;
  for (int face = 0; face < 6; ++face) {
    const Eigen::Vector3d to_eye = (eye - box.faceCenter(face)).normalized();
    if (box.normal(face).dot(to_eye) > kSeen) faces.push_back({"face " + std::to_string(face + 1), box.face(face)});
  }
  return faces;
}

class ScanFaces final : public FeatureMacro {
 public:
  MacroInfo info() const override {
    return {"scan_faces", "Scan Faces", "Goes over every face of the marked box that the cameras see, one after the other.",
            vision::FeatureKind::kTriad, scanParameters(), 0.015};
  }

 protected:
  Status describe(MacroSetup& setup) const override {
    const auto box = boxPatchFrom(setup.feature);
    if (!box) return box.error();
    const RasterSpec spec = scanSpec(setup.arguments);
    const std::vector<Face> faces = visibleFaces(*box, setup.eye);
    if (faces.empty()) return {ErrorCode::kDegenerate, "no face of the box looks at the cameras"};
    for (const Face& face : faces) {
      auto tasks = scanTasks(face.patch, spec, setup.arguments.is("roll_free"), true);
      if (!tasks) return tasks.error();
      setup.job.parts.push_back({face.name, false, true, *std::move(tasks)});
    }
    setup.job.obstacles.push_back(box->object(setup.feature.name));
    setup.job.place = box->X_RO.translation();
    setup.measure = [faces, spec](const ArmSpace& space, Plan& plan) { measure(space, faces, spec, plan); };
    return {};
  }

 private:
  // Coverage of all visible faces by area: a face that was left out counts as not covered.
  static void measure(const ArmSpace& space, const std::vector<Face>& faces, const RasterSpec& spec, Plan& plan) {
    double area = 0, covered = 0;
    int scanned = 0;
    for (const Face& face : faces) {
      const double mine = face.patch.width * face.patch.height;
      area += mine;
      for (const PlanStage& stage : plan.stages) {
        if (stage.name != (faces.size() > 1 ? face.name + ": scan" : "scan")) continue;
        const ScanFigures figures = scanFigures(space, plan, stage.start_s, stage.end_s, face.patch, spec);
        plan.figures["coverage_" + std::string(1, face.name.back())] = figures.coverage;
        covered += mine * figures.coverage;
        ++scanned;
      }
    }
    plan.figures["coverage"] = covered / area;
    plan.figures["faces"] = scanned;
    plan.figures["faces_visible"] = static_cast<double>(faces.size());
  }
};

}  // namespace

std::unique_ptr<Macro> makeScanFaces() { return std::make_unique<ScanFaces>(); }

}  // namespace longarm::planning
