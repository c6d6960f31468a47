#include "session/tools/match_help.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/require.h"
#include "core/text.h"

namespace longarm::session {

using vision::OverlayRole;
using vision::OverlayShape;

namespace {

std::string percent(double share) { return formatFixed(100 * share, 0) + " %"; }

void addGhost(OverlayRole role, const vision::Match& match, std::string text, vision::Overlay* overlay) {
  overlay->shapes.push_back({OverlayShape::Kind::kMarker, role, {match.pixel}, {}});
  overlay->shapes.push_back({OverlayShape::Kind::kText, role, {match.pixel}, std::move(text)});
}

}  // namespace

void addMatchHelp(const std::vector<MatchHelp>& help, SnapshotId shown, vision::Overlay* overlay) {
  for (const auto& each : help) {
    if (each.wish.to != shown) continue;
    if (each.offered()) {
      addGhost(OverlayRole::kMatch, each.matches.front(), "match " + percent(each.matches.front().score), overlay);
      continue;
    }
    for (const auto& rival : each.matches) addGhost(OverlayRole::kRival, rival, percent(rival.score) + "?", overlay);
  }
}

std::string matchHint(const std::vector<MatchHelp>& help) {
  for (const auto& each : help) {
    if (each.offered()) return "Tab takes the match (" + percent(each.matches.front().score) + " sure); or slide the handle yourself.";
  }
  for (const auto& each : help) {
    const auto alike = static_cast<long>(each.matches.size());
    if (alike > 1) return std::to_string(alike) + " places look alike, none is offered: slide the handle to the right one.";
    if (alike == 1) return "One place looks like it, but not surely: slide the handle there if it is right.";
  }
  return help.empty() ? std::string() : "It is not found again in the other picture: slide the handle along the curve yourself.";
}

SketchItem withMatch(const SketchItem& item, const MatchHelp& help) {
  LONGARM_REQUIRE(!help.matches.empty(), "no match to take");
  const vision::Match& match = help.matches.front();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(match.covariance, Eigen::EigenvaluesOnly);
  constexpr double kLeast_px = 0.05, kMost_px = 2;
  const double sigma = std::clamp(std::sqrt(std::max(0.0, axes.eigenvalues()(1))), kLeast_px, kMost_px);
  SketchItem after = item;
  after.setPick(help.wish.to, help.wish.vertex, {match.pixel, PickState::kMatched, sigma});
  return after;
}

}  // namespace longarm::session
