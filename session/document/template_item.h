#pragma once

/// @file
/// Templates dropped onto the sketched world.

#include <map>
#include <string>
#include <vector>

#include "planning/templates/object_template.h"
#include "session/document/world_item.h"

namespace longarm::session {

/// The template standing where the feature was marked, its sizes taken from it where the template says so.  The margin is that
/// of the feature.
/// @returns kInvalidInput: a feature that the template does not take, or as faceFrameOf and ObjectTemplate::instance.
Result<WorldItem> templateItemFrom(const planning::ObjectTemplate& what, const vision::Feature& feature);

/// The item with these parameters (those that are not named keep their values), its bodies made anew.
/// @returns as ObjectTemplate::instance.
Result<WorldItem> withParameters(const planning::ObjectTemplate& what, const WorldItem& item,
                                 const std::map<std::string, double>& parameters);

/// A feature of the template as it stands in the world: what its macros take.  Its covariance is that of the item's margin.
/// @returns kNotFound; as ObjectTemplate::instance.
Result<vision::Feature> featureOf(const planning::ObjectTemplate& what, const WorldItem& item, const std::string& name);

}  // namespace longarm::session
