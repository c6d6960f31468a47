#pragma once

/// @file
/// Representation: one kind of document value drawn in a VTK renderer.

#include <memory>

#include <Eigen/Geometry>

class vtkProp;
class vtkRenderer;

namespace longarm::scene {

/// Owns the props that draw one value.  Derived classes have an `update(value)` that changes them; nothing
/// renders by itself: whoever owns the window renders once after the updates.
///
/// Coordinates are those of the world frame (the robot's root link), metres.  Thread-compatible: use it on
/// the thread that renders.
class Representation {
 public:
  virtual ~Representation();
  Representation(const Representation&) = delete;
  Representation& operator=(const Representation&) = delete;

  /// Shows the props in `renderer` until removeFrom() or destruction; props made later follow.  May be called
  /// for one renderer at a time; a second call moves them.  The renderer may die first.
  virtual void addTo(vtkRenderer* renderer);
  virtual void removeFrom(vtkRenderer* renderer);
  virtual void setVisible(bool visible);
  bool visible() const;
  /// Box around everything visible [m]; empty if there is nothing.
  virtual Eigen::AlignedBox3d bounds() const;

 protected:
  Representation();
  void addProp(vtkProp* prop);
  /// Hides one prop of a representation that is visible as a whole.
  void showProp(vtkProp* prop, bool shown);
  void removeProp(vtkProp* prop);
  void clearProps();

 private:
  struct Props;
  std::unique_ptr<Props> m_props;
};

}  // namespace longarm::scene
