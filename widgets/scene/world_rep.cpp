#include "widgets/scene/world_rep.h"

#include <algorithm>
#include <variant>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkFloatArray.h>
#include <vtkMapper.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>

#include "widgets/scene/procedural_surface.h"
#include "widgets/scene/shape_geometry.h"
#include "widgets/scene/vtk_convert.h"

namespace longarm::scene {
namespace {

bool sameShape(const planning::Shape& a, const planning::Shape& b) {
  if (a.index() != b.index()) return false;
  if (const auto* box = std::get_if<planning::Box>(&a)) return box->size == std::get<planning::Box>(b).size;
  if (const auto* c = std::get_if<planning::Cylinder>(&a)) {
    const auto& other = std::get<planning::Cylinder>(b);
    return c->radius == other.radius && c->length == other.length;
  }
  if (const auto* s = std::get_if<planning::Sphere>(&a)) return s->radius == std::get<planning::Sphere>(b).radius;
  return std::get<3>(a) == std::get<3>(b);
}

struct Body {
  planning::WorldObject object;
  std::string surface;
  vtkSmartPointer<vtkActor> actor;

  bool looksLike(const planning::WorldObject& other, const std::string& other_surface) const {
    return object.name == other.name && surface == other_surface && object.rgba == other.rgba &&
           sameShape(object.shape, other.shape);
  }
};

struct SurfaceTexture {
  vtkSmartPointer<vtkTexture> texture;
  double tile_m = 1;
};

/// Metres on the surface become turns of the tile.
void scaleTextureCoordinates(vtkActor* actor, double tile_m) {
  auto* mapper = vtkPolyDataMapper::SafeDownCast(actor->GetMapper());
  vtkDataArray* coordinates = mapper->GetInput()->GetPointData()->GetTCoords();
  for (vtkIdType i = 0; coordinates != nullptr && i < coordinates->GetNumberOfTuples(); ++i) {
    const double* uv = coordinates->GetTuple2(i);
    coordinates->SetTuple2(i, uv[0] / tile_m, uv[1] / tile_m);
  }
}

}  // namespace

struct WorldRep::Impl {
  std::vector<Body> bodies;
  std::map<std::string, SurfaceTexture> textures;
  double opacity = 1;

  SurfaceTexture texture(const std::string& name) {
    auto found = textures.find(name);
    if (found != textures.end()) return found->second;
    const internal::Surface surface = internal::makeSurface(name);
    SurfaceTexture made;
    if (!surface.picture.empty()) made = {internal::makeTexture(surface.picture, true), surface.tile_m};
    return textures[name] = made;
  }

  Body make(const planning::WorldObject& object, const std::string& surface) {
    Body body{object, surface, internal::makeShapeActor(object.shape, object.rgba)};
    const SurfaceTexture painted = surface.empty() ? SurfaceTexture{} : texture(surface);
    if (painted.texture != nullptr) {
      scaleTextureCoordinates(body.actor, painted.tile_m);
      body.actor->SetTexture(painted.texture);
    }
    paint(body);
    return body;
  }

  void paint(const Body& body) const { body.actor->GetProperty()->SetOpacity(body.object.rgba[3] * opacity); }
};

WorldRep::WorldRep() : m_impl(std::make_unique<Impl>()) {}

WorldRep::~WorldRep() = default;

void WorldRep::update(const std::vector<planning::WorldObject>& objects, const std::map<std::string, Pose>& X_WL,
                      const SurfaceNames& surfaces) {
  auto& bodies = m_impl->bodies;
  while (bodies.size() > objects.size()) {
    removeProp(bodies.back().actor);
    bodies.pop_back();
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto found = surfaces.find(objects[i].name);
    const std::string surface = found == surfaces.end() ? std::string() : found->second;
    if (i == bodies.size() || !bodies[i].looksLike(objects[i], surface)) {
      Body body = m_impl->make(objects[i], surface);
      if (i < bodies.size()) removeProp(bodies[i].actor);
      addProp(body.actor);
      if (i == bodies.size()) bodies.emplace_back();
      bodies[i] = std::move(body);
    }
    const std::string& link = objects[i].attached_link;
    const auto carrier = X_WL.find(link);
    const bool placed = link.empty() || carrier != X_WL.end();
    showProp(bodies[i].actor, placed);
    if (placed) internal::setActorPose(bodies[i].actor, link.empty() ? objects[i].X_WO : carrier->second * objects[i].X_WO);
  }
}

void WorldRep::setOpacity(double opacity) {
  m_impl->opacity = std::clamp(opacity, 0.0, 1.0);
  for (const Body& body : m_impl->bodies) m_impl->paint(body);
}

}  // namespace longarm::scene
