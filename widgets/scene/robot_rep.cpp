#include "widgets/scene/robot_rep.h"

#include <algorithm>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkProperty.h>
#include <vtkSmartPointer.h>

#include "core/require.h"
#include "widgets/scene/shape_geometry.h"
#include "widgets/scene/vtk_convert.h"

namespace longarm::scene {
namespace {

struct Part {
  std::size_t link = 0;
  Pose X_LS = Pose::Identity();
  Eigen::Vector4d rgba;
  vtkSmartPointer<vtkActor> actor;
};

void paint(const Part& part, const RobotLook& look) {
  Eigen::Vector4d rgba = part.rgba;
  if (look.tint) rgba.head<3>() = 0.75 * *look.tint + 0.25 * rgba.head<3>();  // parts stay told apart
  rgba[3] *= std::clamp(look.opacity, 0.0, 1.0);
  internal::setSurfaceColor(part.actor, rgba);
  if (rgba[3] < 1) part.actor->GetProperty()->BackfaceCullingOn();  // a ghost shows its outside only
}

}  // namespace

struct RobotRep::Impl {
  std::shared_ptr<const planning::RobotModel> model;
  std::vector<Part> parts;
  std::vector<Pose> X_WL;
};

RobotRep::RobotRep(std::shared_ptr<const planning::RobotModel> model, const RobotLook& look)
    : m_impl(std::make_unique<Impl>()) {
  LONGARM_REQUIRE(model != nullptr, "RobotRep needs a robot model");
  m_impl->model = std::move(model);
  const auto& links = m_impl->model->links();
  for (std::size_t link = 0; link < links.size(); ++link) {
    const auto& shapes = look.show_collision_shapes ? links[link].collisions : links[link].visuals;
    for (const planning::LinkShape& shape : shapes) {
      Part part{link, shape.X_LS, shape.rgba, internal::makeShapeActor(shape.shape, shape.rgba)};
      paint(part, look);
      addProp(part.actor);
      m_impl->parts.push_back(std::move(part));
    }
  }
  update(m_impl->model->neutral());
}

RobotRep::~RobotRep() = default;

void RobotRep::update(const Eigen::VectorXd& q) {
  LONGARM_REQUIRE(q.size() == m_impl->model->dof(), "RobotRep: configuration has " + std::to_string(q.size()) +
                                                        " values, the robot " +
                                                        std::to_string(m_impl->model->dof()) + " joints");
  std::vector<Pose> X_WL;
  m_impl->model->forward(q, X_WL);
  update(X_WL);
}

void RobotRep::update(const std::vector<Pose>& X_WL) {
  LONGARM_REQUIRE(X_WL.size() == m_impl->model->links().size(), "RobotRep: one pose per link is needed");
  m_impl->X_WL = X_WL;
  for (const Part& part : m_impl->parts) internal::setActorPose(part.actor, X_WL[part.link] * part.X_LS);
}

void RobotRep::setLook(const RobotLook& look) {
  for (const Part& part : m_impl->parts) paint(part, look);
}

const std::shared_ptr<const planning::RobotModel>& RobotRep::model() const { return m_impl->model; }

const std::vector<Pose>& RobotRep::linkPoses() const { return m_impl->X_WL; }

}  // namespace longarm::scene
