#include "widgets/scene/plan_rep.h"

#include <algorithm>
#include <functional>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWeakPointer.h>

#include "core/require.h"
#include "widgets/scene/clearance_look.h"
#include "widgets/scene/ground_grid_rep.h"
#include "widgets/scene/robot_rep.h"

namespace longarm::scene {
namespace {

constexpr double kFailureRadius = 0.05;    // [m]

/// Full configuration of the plan at time t.
Eigen::VectorXd configurationAt(const planning::RobotModel& model, const planning::Plan& plan, double t) {
  Eigen::VectorXd q = plan.start_configuration.size() == model.dof() ? plan.start_configuration : model.neutral();
  if (plan.trajectory.empty()) return q;
  JointState state;
  state.names = plan.trajectory.joint_names;
  state.positions = plan.trajectory.sample(t).positions;
  model.assign(state, q);
  return q;
}

}  // namespace

std::vector<Pose> toolTrail(const planning::RobotModel& model, const std::string& tip_link,
                            const planning::Plan& plan, int samples) {
  std::vector<Pose> trail;
  const Result<int> tip = model.linkIndex(tip_link);
  if (!tip || plan.trajectory.empty()) return trail;
  for (int i = 0; i < std::max(2, samples); ++i) {
    const double t = plan.trajectory.duration() * i / (std::max(2, samples) - 1);
    trail.push_back(model.forward(configurationAt(model, plan, t), *tip));
  }
  return trail;
}

struct PlanRep::Impl {
  std::shared_ptr<const planning::RobotModel> model;
  std::string tip_link;
  PlanLook look;
  planning::Plan plan;
  double cursor = 0;
  bool ghost_visible = true;
  vtkWeakPointer<vtkRenderer> renderer;
  vtkNew<vtkPolyData> trail;
  vtkNew<vtkActor> trail_actor;
  vtkNew<vtkPolyData> failure;               // empty while there is none
  vtkNew<vtkActor> failure_actor;
  std::unique_ptr<RobotRep> ghost;
  std::vector<std::unique_ptr<RobotRep>> swept;
  std::vector<std::unique_ptr<AxesRep>> axes;

  void forEachChild(const std::function<void(Representation&)>& action) const {
    if (ghost) action(*ghost);
    for (const auto& rep : swept) action(*rep);
    for (const auto& rep : axes) action(*rep);
  }
  RobotLook ghostLook(double factor) const { return {look.ghost_opacity * factor, look.ghost_tint, false}; }

  void buildTrail() {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetNumberOfComponents(3);
    const std::vector<Pose> poses = toolTrail(*model, tip_link, plan, look.trail_samples);
    for (const Pose& X : poses) points->InsertNextPoint(X.translation().data());
    // A line for each step, in one colour: blended ones would say what was never measured.
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const vtkIdType ends[2] = {static_cast<vtkIdType>(i) - 1, static_cast<vtkIdType>(i)};
      lines->InsertNextCell(2, ends);
      const Eigen::Vector3d color = 255 * colorOfStep(i, poses.size() - 1);
      colors->InsertNextTuple3(color[0], color[1], color[2]);
    }
    trail->SetPoints(points);
    trail->SetLines(lines);
    trail->GetCellData()->SetScalars(colors);
  }

  Eigen::Vector3d colorOfStep(std::size_t step, std::size_t steps) const {
    if (plan.clearance.empty()) return look.trail_color;
    const double whole = plan.trajectory.duration(), before = whole * static_cast<double>(step - 1) / static_cast<double>(steps),
                 after = whole * static_cast<double>(step) / static_cast<double>(steps);
    return clearanceColor(planning::bandOf(std::min(planning::clearanceAt(plan.clearance, before), planning::clearanceAt(plan.clearance, after))));
  }

  void addAxes(const Pose& X, double length) {
    axes.push_back(std::make_unique<AxesRep>());
    axes.back()->update(X, length, 3);
  }

  void buildAxes() {
    axes.clear();
    if (!plan.ok() && plan.failed_pose) addAxes(*plan.failed_pose, 0.12);
    const Result<int> tip = model->linkIndex(tip_link);
    if (!plan.ok() || !look.axes_at_stages || !tip) return;
    for (const planning::PlanStage& stage : plan.stages) {
      addAxes(model->forward(configurationAt(*model, plan, stage.end_s), *tip), 0.06);
    }
  }

  void buildFailure() {
    failure->Initialize();
    if (plan.ok() || !plan.failed_pose) return;
    vtkNew<vtkSphereSource> cage;
    cage->SetRadius(kFailureRadius);
    cage->SetThetaResolution(12);
    cage->SetPhiResolution(8);
    cage->SetCenter(plan.failed_pose->translation().x(), plan.failed_pose->translation().y(), plan.failed_pose->translation().z());
    cage->Update();
    failure->ShallowCopy(cage->GetOutput());
  }

  void buildSwept() {
    swept.clear();
    for (int i = 1; i <= look.swept_ghosts && !plan.trajectory.empty(); ++i) {
      const double t = plan.trajectory.duration() * i / (look.swept_ghosts + 1);
      swept.push_back(std::make_unique<RobotRep>(model, ghostLook(0.4)));
      swept.back()->update(configurationAt(*model, plan, t));
    }
  }
};

PlanRep::PlanRep(std::shared_ptr<const planning::RobotModel> model, const std::string& tip_link)
    : m_impl(std::make_unique<Impl>()) {
  LONGARM_REQUIRE(model != nullptr, "PlanRep needs a robot model");
  m_impl->model = std::move(model);
  m_impl->tip_link = tip_link;
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(m_impl->trail);
  m_impl->trail_actor->SetMapper(mapper);
  m_impl->trail_actor->GetProperty()->LightingOff();
  m_impl->trail_actor->GetProperty()->SetLineWidth(3);
  addProp(m_impl->trail_actor);
  vtkNew<vtkPolyDataMapper> failure_mapper;
  failure_mapper->SetInputData(m_impl->failure);
  m_impl->failure_actor->SetMapper(failure_mapper);
  m_impl->failure_actor->GetProperty()->SetRepresentationToWireframe();
  m_impl->failure_actor->GetProperty()->SetColor(1.0, 0.69, 0.0);
  m_impl->failure_actor->GetProperty()->LightingOff();
  m_impl->failure_actor->GetProperty()->SetLineWidth(2);
  addProp(m_impl->failure_actor);
  m_impl->ghost = std::make_unique<RobotRep>(m_impl->model, m_impl->ghostLook(1));
  clear();
}

PlanRep::~PlanRep() = default;

void PlanRep::addTo(vtkRenderer* renderer) {
  Representation::addTo(renderer);
  m_impl->renderer = renderer;
  m_impl->forEachChild([&](Representation& rep) { rep.addTo(renderer); });
}

void PlanRep::removeFrom(vtkRenderer* renderer) {
  Representation::removeFrom(renderer);
  if (m_impl->renderer != renderer) return;
  m_impl->renderer = nullptr;
  m_impl->forEachChild([&](Representation& rep) { rep.removeFrom(renderer); });
}

void PlanRep::setVisible(bool visible) {
  Representation::setVisible(visible);
  m_impl->forEachChild([&](Representation& rep) { rep.setVisible(visible); });
  setGhostVisible(m_impl->ghost_visible);
}

void PlanRep::update(const planning::Plan& plan) {
  m_impl->plan = plan;
  m_impl->buildTrail();
  m_impl->buildSwept();
  m_impl->buildAxes();
  m_impl->buildFailure();
  addTo(m_impl->renderer);  // new children join
  setVisible(visible());
  scrub(0);
}

void PlanRep::clear() { update(planning::Plan()); }

void PlanRep::scrub(double t) {
  m_impl->cursor = t;
  if (!m_impl->plan.trajectory.empty()) m_impl->ghost->update(configurationAt(*m_impl->model, m_impl->plan, t));
}

void PlanRep::setGhostVisible(bool visible) {
  m_impl->ghost_visible = visible;
  m_impl->ghost->setVisible(visible && this->visible() && !m_impl->plan.trajectory.empty());
}

void PlanRep::setLook(const PlanLook& look) {
  m_impl->look = look;
  m_impl->ghost->setLook(m_impl->ghostLook(1));
  const double cursor = m_impl->cursor;
  update(planning::Plan(m_impl->plan));
  scrub(cursor);
}

}  // namespace longarm::scene
