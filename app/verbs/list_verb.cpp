// list, completion
#include "app/verbs/cli.h"
#include "core/text.h"
#include "planning/macros/macro.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"

namespace longarm::app {
namespace {

struct ListOptions {
  std::string what, workcell;
};

Result<std::vector<std::vector<std::string>>> rowsOf(const ListOptions& options) {
  using Rows = std::vector<std::vector<std::string>>;
  if (options.what == "scenarios") {
    Rows rows = {{"name", "description"}};
    for (const auto& scenario : planning::listScenarios()) rows.push_back({scenario.name, scenario.description});
    return rows;
  }
  if (options.what == "robots") {
    return Rows{{"name", "description"},
                {"longarm_one", "Built-in tracked mobile manipulator: 6-joint arm, gripper, stereo head on a pan-tilt mast"},
                {"longarm_one:ptz", "The same with two independent pan-tilt zoom cameras instead of the stereo head"}};
  }
  return Rows{{"name", "description"},
              {"virtual", "The built-in virtual robot, started as a child process and spoken to by rosbridge"},
              {"rosbridge", "Any ROS 1 or ROS 2 robot that runs rosbridge: arm, gripper, pan-tilts, cameras"}};
}

// Macros have more to tell than a row of a table: their parameters.
Result<Answer> runListMacros(const ListOptions& options) {
  const auto workcell = options.workcell.empty() ? planning::loadBuiltInWorkcell() : planning::loadWorkcell(options.workcell);
  if (!workcell) return workcell.error();
  Answer answer;
  std::vector<std::vector<std::string>> rows = {{"name", "takes", "description"}};
  auto& list = answer.json["macros"] = nlohmann::json::array();
  for (const auto& macro : planning::makeMacros(*workcell)) {
    const auto info = macro->info();
    const std::string takes = info.takes ? vision::toString(*info.takes) : "nothing";
    nlohmann::json parameters = nlohmann::json::array();
    rows.push_back({info.name, takes, info.description});
    for (const auto& p : info.parameters) {
      parameters.push_back({{"name", p.name}, {"unit", p.unit}, {"default", p.value}, {"min", p.lower}, {"max", p.upper}, {"description", p.description}});
      if (!p.choices.empty()) parameters.back()["choices"] = p.choices;
      rows.push_back({"", "  " + p.name + " = " + formatNumber(p.value) + (p.unit == "1" || p.unit == "choice" ? "" : " " + p.unit), p.description});
    }
    nlohmann::json entry{{"name", info.name}, {"title", info.title}, {"takes", takes}, {"description", info.description}, {"parameters", parameters}};
    if (info.accuracy_need > 0) entry["accuracy_need"] = info.accuracy_need;
    list.push_back(std::move(entry));
  }
  answer.table = tableText(rows);
  return answer;
}

Result<Answer> runList(const ListOptions& options) {
  if (options.what == "macros") return runListMacros(options);
  const auto rows = rowsOf(options);
  if (!rows) return rows.error();
  Answer answer;
  auto& list = answer.json[options.what] = nlohmann::json::array();
  for (std::size_t i = 1; i < rows->size(); ++i) {
    nlohmann::json entry;
    for (std::size_t column = 0; column < (*rows)[0].size(); ++column) entry[(*rows)[0][column]] = (*rows)[i][column];
    list.push_back(entry);
  }
  answer.table = tableText(*rows);
  return answer;
}

// All words that may follow a (sub)command: its verbs and its long options.
std::string wordsOf(const CLI::App& app) {
  std::string words;
  for (const auto* verb : app.get_subcommands([](const CLI::App*) { return true; })) words += verb->get_name() + " ";
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) words += "--" + name + " ";
  }
  return words;
}

void addCases(const CLI::App& app, const std::string& path, std::string& cases) {
  cases += "    \"" + path + "\") words=\"" + wordsOf(app) + "\" ;;\n";
  for (const auto* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    addCases(*verb, path.empty() ? verb->get_name() : path + " " + verb->get_name(), cases);
  }
}

Answer completionScript(const CLI::App& app) {
  std::string cases;
  addCases(app, "", cases);
  const std::string script =
      "# bash completion of longarm\n"
      "_longarm() {\n"
      "  local current=\"${COMP_WORDS[COMP_CWORD]}\" path=\"\" words=\"\" i\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    [[ ${COMP_WORDS[i]} == -* ]] && break\n"
      "    path=\"${path:+$path }${COMP_WORDS[i]}\"\n"
      "  done\n"
      "  case \"$path\" in\n" + cases +
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "  [[ -z ${COMPREPLY[*]} ]] && COMPREPLY=($(compgen -f -- \"$current\"))\n"
      "}\n"
      "complete -o filenames -F _longarm longarm\n";
  Answer answer;
  answer.json = {{"shell", "bash"}, {"script", script}};
  answer.table = script;
  return answer;
}

}  // namespace

void addListVerb(Cli& cli) {
  cli.addVerb<ListOptions>(
      cli.app(), "list", "Names of macros, scenarios, robots or devices", "longarm list macros --json",
      [](CLI::App& verb, ListOptions& options) {
        verb.add_option("what", options.what, "macros, scenarios, robots or devices")
            ->required()
            ->check(CLI::IsMember({"macros", "scenarios", "robots", "devices"}));
        verb.add_option("--workcell", options.workcell, "Workcell whose macros are meant (default: the built-in robot)");
      },
      runList);
  struct None {};
  const CLI::App* root = &cli.app();
  cli.addVerb<None>(
      cli.app(), "completion", "Print a bash completion script", "longarm completion > /etc/bash_completion.d/longarm",
      [](CLI::App&, None&) {}, [root](const None&) -> Result<Answer> { return completionScript(*root); });
}

}  // namespace longarm::app
