#pragma once

/// @file
/// Object templates: a door, a valve, a drawer: bodies of adjustable size, how they move, where they are taken hold of,
/// and the macros that work them.  One YAML each; docs/templates.md describes the format.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "planning/world/shape.h"
#include "vision/sketch/feature.h"

namespace longarm::planning {

/// A size or setting of a template.
struct TemplateParameter {
  std::string name, unit, description;             ///< unit: "m", "rad", "1"
  double value = 0, lower = 0, upper = 0;
  char from = 0;                                   ///< 'u', 'v', 'w': taken from the sketch's extent where it has one.
};

/// A body of an instance, in the frame of the template.
struct TemplatePart {
  std::string name;
  Shape shape;
  Pose X_TP = Pose::Identity();
  bool moves = false;                              ///< With the hinge or slide.
};

/// One step of an action.
struct TemplateStep {
  enum class Kind { kMacro, kOpenGripper, kCloseGripper } kind = Kind::kMacro;
  std::string macro, feature;                      ///< kMacro
  std::map<std::string, double> arguments;         ///< kMacro, by MacroParameter::name
  std::map<std::string, double> adds;              ///< To parameters of the template when it is done.
  bool through = false;                            ///< kMacro: the moving parts go with the tool and are no obstacle.
};

struct TemplateAction {
  std::string name, title, description;
  std::vector<TemplateStep> steps;
};

/// A template at certain sizes.  In the frame of the template: origin in the middle of the face, x to its right, y up, z out
/// of it towards who looks at it.
struct TemplateInstance {
  std::vector<TemplatePart> parts;
  std::map<std::string, vision::Feature> features; ///< By name; without covariance.
  std::vector<TemplateAction> actions;
};

/// Immutable; thread-safe.
class ObjectTemplate {
 public:
  /// @returns kNotFound, or kInvalidInput naming file, key, value and what was expected.  What can be wrong with a
  ///   template at its default sizes is found here.
  static Result<ObjectTemplate> load(const std::string& path);

  const std::string& path() const;
  const std::string& name() const;
  const std::string& title() const;
  const std::string& description() const;
  const std::vector<TemplateParameter>& parameters() const;
  /// Its kinds of sketch, as the file names them; empty: any.
  bool takes(vision::FeatureKind kind) const;

  /// Parameters that are not given have their default.
  /// @returns kOutOfLimits (name, value, limits), kNotFound for a parameter it has not, kInvalidInput for a size that is not
  ///   positive.
  Result<TemplateInstance> instance(const std::map<std::string, double>& parameters) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> m_impl;
};

/// The built-in templates (resources/templates) and those of the files and folders given, by name; of two of one name the
/// later.  What cannot be read is told in `warnings`, when given.
std::vector<ObjectTemplate> loadTemplates(const std::vector<std::string>& more, std::vector<std::string>* warnings = nullptr);

}  // namespace longarm::planning
