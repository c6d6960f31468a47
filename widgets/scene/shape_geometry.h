#pragma once

/// @file
/// Triangles of shapes.  Internal to the scene.

#include <vtkSmartPointer.h>  // vtkCommonCore

#include "planning/world/shape.h"

class vtkActor;
class vtkPolyData;

namespace longarm::scene::internal {

/// Few triangles with normals; texture coordinates in metres along the surface (boxes, cylinders; spheres and meshes
/// have those of their x and y).  Counter-clockwise from outside.
vtkSmartPointer<vtkPolyData> geometryOf(const planning::Shape& shape);
/// An actor of it: static mapper, back faces culled (not for meshes, whose winding may be wrong).
vtkSmartPointer<vtkActor> makeShapeActor(const planning::Shape& shape, const Eigen::Vector4d& rgba);
/// Matt, evenly lit surfaces.
void setSurfaceColor(vtkActor* actor, const Eigen::Vector4d& rgba);

}  // namespace longarm::scene::internal
