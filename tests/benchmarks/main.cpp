// longarm_benchmarks [NAME...] [--json] [--gate]: our kernels beside their peers.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/benchmarks/gate.h"

namespace longarm::benchmarks {
namespace {

struct Options {
  std::vector<std::string> names;      // empty: all
  bool json = false, gate = false, wrong = false;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--json") options.json = true;
    else if (word == "--gate") options.gate = true;
    else if (word.rfind("--", 0) == 0) options.wrong = true;
    else options.names.push_back(word);
  }
  return options;
}

template <typename T>
void keepNamed(const std::vector<std::string>& names, std::vector<T>* all, std::vector<std::string>* known) {
  for (const auto& one : *all) known->push_back(one.name);
  if (names.empty()) return;
  all->erase(std::remove_if(all->begin(), all->end(),
                            [&](const T& one) { return std::find(names.begin(), names.end(), one.name) == names.end(); }),
             all->end());
}

void initialise(const char* program) {
  std::vector<std::string> words = {program, "--benchmark_enable_random_interleaving=true"};
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  std::map<std::string, std::string> skipped;
  std::vector<Contest> contests = stereoContests();
#ifdef LONGARM_WITH_KDL
  for (auto& contest : robotContests()) contests.push_back(std::move(contest));
#else
  for (const char* name : {"fk_jacobian", "ik", "ik_seven_joints", "cartesian_100", "reach_question"}) skipped[name] = "needs orocos-kdl, which was not found";
#endif
  for (auto& contest : motionContests()) contests.push_back(std::move(contest));
  for (auto* more : {&calibrationContests, &poseContests, &paneContests}) {
    for (auto& contest : (*more)(&skipped)) contests.push_back(std::move(contest));
  }
  std::vector<Budget> budgets = stereoBudgets();
  for (auto& budget : reachBudgets()) budgets.push_back(std::move(budget));
  for (auto& budget : cancelBudgets()) budgets.push_back(std::move(budget));
  for (auto& budget : paneBudgets(&skipped)) budgets.push_back(std::move(budget));
  for (auto& budget : sceneBudgets(&skipped)) budgets.push_back(std::move(budget));
  std::vector<std::string> known;
  keepNamed(options.names, &contests, &known);
  keepNamed(options.names, &budgets, &known);
  for (const auto& [name, why] : skipped) {
    known.push_back(name);
    if (options.names.empty() || std::count(options.names.begin(), options.names.end(), name) != 0) {
      std::fprintf(stderr, "%s: skipped: %s\n", name.c_str(), why.c_str());
    }
  }
  for (const auto& name : options.names) {
    if (std::count(known.begin(), known.end(), name) != 0 && !options.wrong) continue;
    std::string names;
    for (const auto& one : known) names += " " + one;
    std::fprintf(stderr, "no benchmark is called \"%s\"; there are:%s\n", name.c_str(), names.c_str());
    return 2;
  }
  if (options.wrong) {
    std::fprintf(stderr, "usage: longarm_benchmarks [NAME...] [--json] [--gate]\n");
    return 2;
  }
  initialise(argv[0]);
  std::vector<Outcome> outcomes = runContests(contests, 7);
  for (const auto& budget : budgets) outcomes.push_back(runBudget(budget));
  if (options.json) {
    std::cout << toJson(outcomes) << "\n";
  } else {
    printTable(outcomes, std::cout);
  }
  const bool all = std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.passed; });
  return options.gate && !all ? 1 : 0;
}

}  // namespace
}  // namespace longarm::benchmarks

int main(int argc, char** argv) { return longarm::benchmarks::run(argc, argv); }
