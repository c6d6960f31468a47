#pragma once

/// @file
/// Poses, colours and pictures as VTK wants them.  Internal to the scene.

#include <opencv2/core/mat.hpp>
#include <vtkSmartPointer.h>  // vtkCommonCore

#include "core/pose.h"

class vtkActor;
class vtkImageData;
class vtkMatrix4x4;
class vtkTexture;

namespace longarm::scene::internal {

vtkSmartPointer<vtkMatrix4x4> toVtk(const Pose& X);
/// Writes the pose into the actor's user matrix, which is made on first use.
void setActorPose(vtkActor* actor, const Pose& X);
/// Copies an 8-bit BGR or grey picture (top row first) into `image` as RGB, bottom row first; reuses its memory.
void copyPicture(const cv::Mat& picture, vtkImageData* image);
/// A texture of a picture; `repeat`: tiles outside 0 ... 1 and uses mipmaps.
vtkSmartPointer<vtkTexture> makeTexture(const cv::Mat& picture, bool repeat);

}  // namespace longarm::scene::internal
