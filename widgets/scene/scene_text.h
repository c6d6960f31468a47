#pragma once

/// @file
/// Text that faces the viewer.  Internal to the scene.

#include <string>

#include <Eigen/Core>
#include <vtkSmartPointer.h>  // vtkCommonCore

class vtkBillboardTextActor3D;

namespace longarm::scene::internal {

/// Beside a place of the world, of constant size on screen, with a shadow.  @param color RGB 0 ... 1.
vtkSmartPointer<vtkBillboardTextActor3D> makeText(const std::string& text, const Eigen::Vector3d& at, const Eigen::Vector3d& color);

}  // namespace longarm::scene::internal
