#include "widgets/scene/vtk_convert.h"

#include <opencv2/imgproc.hpp>
#include <vtkActor.h>      // vtkRenderingCore
#include <vtkImageData.h>  // vtkCommonDataModel
#include <vtkMatrix4x4.h>  // vtkCommonMath
#include <vtkNew.h>
#include <vtkTexture.h>

namespace longarm::scene::internal {
namespace {

void fill(vtkMatrix4x4* matrix, const Pose& X) {
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix->SetElement(row, column, X.matrix()(row, column));
  }
}

}  // namespace

vtkSmartPointer<vtkMatrix4x4> toVtk(const Pose& X) {
  auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  fill(matrix, X);
  return matrix;
}

void setActorPose(vtkActor* actor, const Pose& X) {
  if (actor->GetUserMatrix() == nullptr) actor->SetUserMatrix(toVtk(X));
  fill(actor->GetUserMatrix(), X);  // SetElement marks it modified only where a number changed
}

void copyPicture(const cv::Mat& picture, vtkImageData* image) {
  const int* size = image->GetDimensions();
  if (size[0] != picture.cols || size[1] != picture.rows || image->GetNumberOfScalarComponents() != 3) {
    image->SetDimensions(picture.cols, picture.rows, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  }
  cv::Mat target(picture.rows, picture.cols, CV_8UC3, image->GetScalarPointer());
  cv::Mat rgb;
  cv::cvtColor(picture, rgb, picture.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
  cv::flip(rgb, target, 0);
  image->Modified();
}

vtkSmartPointer<vtkTexture> makeTexture(const cv::Mat& picture, bool repeat) {
  vtkNew<vtkImageData> image;
  copyPicture(picture, image);
  auto texture = vtkSmartPointer<vtkTexture>::New();
  texture->SetInputData(image);
  texture->SetInterpolate(true);
  texture->SetMipmap(repeat);
  texture->SetRepeat(repeat);
  texture->SetEdgeClamp(!repeat);
  return texture;
}

}  // namespace longarm::scene::internal
