#pragma once

/// @file
/// Draws a snapshot where it was taken: its picture on the image plane, and the pyramid to its corners.

#include <memory>

#include <opencv2/core/mat.hpp>

#include "vision/snapshot/view.h"
#include "widgets/scene/representation.h"

namespace longarm::scene {

struct FrustumLook {
  double depth = 0.4;                    ///< z of the image plane in the camera frame [m].
  double opacity = 0.8;                  ///< Of the picture, 0 ... 1; 0 leaves only the lines.
  bool lines = true;
  Eigen::Vector3d color{0.95, 0.75, 0.2};///< RGB of the lines, 0 ... 1.
};

/// A view's picture is bent over a mesh so that every pixel lies on its own viewing ray, lens included.
class FrustumRep final : public Representation {
 public:
  FrustumRep();
  ~FrustumRep() override;

  /// @param image 8-bit BGR or grey, of the view's size (or any size of that aspect); empty: lines only.
  /// A view without width and height draws nothing.
  void update(const vision::View& view, const cv::Mat& image);
  /// Only the camera's place: keeps picture and mesh.
  void setPose(const Pose& X_WC);
  void setLook(const FrustumLook& look);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::scene
