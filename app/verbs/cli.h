#pragma once

/// @file
/// The frame every verb hangs in: options, the one JSON object, exit status.  docs/cli.md is the contract.

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <nlohmann/json.hpp>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::app {

enum ExitStatus { kExitDone = 0, kExitUsage = 2, kExitBadInput = 3, kExitNoSolution = 4 };

/// What a verb found: printed as `json` with --json, else as `table` for people.
struct Answer {
  nlohmann::json json = nlohmann::json::object();
  std::string table;
  int exit = kExitDone;
};

/// An answer with exit status 4: `status` a stable code, `reason` a sentence.
Answer noSolution(nlohmann::json json, const std::string& status, const std::string& reason);

/// Holds the parser and the verb that was chosen.
class Cli {
 public:
  Cli();
  CLI::App& app() { return m_app; }

  /// Adds a verb; `declare` adds its options to the subcommand and keeps them in Options; `body` runs it.  An Error
  /// from `body` becomes exit status 3 (4 for kNoSolution and kDegenerate).
  template <typename Options>
  CLI::App* addVerb(CLI::App& parent, const std::string& name, const std::string& description,
                    const std::string& example, std::function<void(CLI::App&, Options&)> declare,
                    std::function<Result<Answer>(const Options&)> body) {
    auto options = std::make_shared<Options>();
    CLI::App* verb = parent.add_subcommand(name, description);
    verb->footer("Example:\n  " + example);
    verb->add_flag("--json", m_json, "Print exactly one JSON object to standard output");
    declare(*verb, *options);
    verb->callback([this, options, body] { m_chosen = [options, body] { return body(*options); }; });
    return verb;
  }

  /// Parses and runs.  `opened` says whether no verb was given, so that the console should open instead.
  int run(int argc, char** argv, bool& opened);

 private:
  int print(const Result<Answer>& answer) const;
  CLI::App m_app;
  std::function<Result<Answer>()> m_chosen;
  bool m_json = false;
};

/// {"parent", "xyz", "quaternion_xyzw"}
nlohmann::json poseJson(const PoseInParent& pose);
nlohmann::json vectorJson(const Eigen::VectorXd& values);
/// Reads a JSON file; kInvalidInput with the position of the fault.  Nesting deeper than 64 is refused.
Result<nlohmann::json> readJsonFile(const std::string& path);
/// "a,b,c" as numbers; kInvalidInput naming `option`.
Result<Eigen::VectorXd> numbersOption(const std::string& option, const std::string& text);

/// A pose written as seven numbers or as JSON; kInvalidInput naming `option`.
Result<Pose> poseOption(const std::string& option, const std::string& text);

/// A table for people: columns padded, first row the heading.
std::string tableText(const std::vector<std::vector<std::string>>& rows);

// One per file of this folder.
void addTargetVerbs(Cli& cli);       ///< target, epipolar, undistort
void addRobotVerbs(Cli& cli);        ///< robot info | fk | ik
void addPlanVerbs(Cli& cli);         ///< plan, check
void addCalibrateVerbs(Cli& cli);    ///< calibrate intrinsics | fixture | stereo | pose | zoom | compare
void addListVerb(Cli& cli);          ///< list, completion
void addRunVerb(Cli& cli);           ///< run

}  // namespace longarm::app
