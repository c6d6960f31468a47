#include "session/document/feature_rows.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/text.h"

namespace longarm::session {

double plusMinus95(double sigma) { return 1.959963984540054 * sigma; }

std::string millimetreText(double metres, int decimals) { return formatFixed(metres * 1000, decimals) + " mm"; }

std::string millimetreText(double metres, double plus_minus_metres) {
  return formatFixed(metres * 1000, 1) + " \u00b1 " + formatFixed(plus_minus_metres * 1000, 1) + " mm";
}

namespace {

void fillTexts(FeatureRow& row) {
  row.xyz_text = formatFixed(row.xyz.x() * 1000, 1) + ", " + formatFixed(row.xyz.y() * 1000, 1) + ", " +
                 formatFixed(row.xyz.z() * 1000, 1);
  row.plus_minus_text = formatFixed(row.plus_minus * 1000, 1);
  row.miss_text = formatFixed(row.miss * 1000, 1);
  if (row.length) row.length_text = millimetreText(*row.length, *row.length_plus_minus);
  if (row.radius) row.length_text += ", r " + millimetreText(*row.radius, *row.radius_plus_minus);
  if (row.size) {
    const auto mm = [&](int axis) { return formatFixed((*row.size)[axis] * 1000, 0); };
    row.length_text = mm(0) + " \u00d7 " + mm(1) + " \u00d7 " + millimetreText((*row.size)[2], 0);
    const auto edge = [&](int axis) { return millimetreText((*row.size)[axis], (*row.size_plus_minus)[axis]); };
    row.size_text = edge(0) + " \u00d7 " + edge(1) + " \u00d7 " + edge(2);
  }
}

/// Covariance of the feature's middle: of its only vertex, or of the mean of the ends with what they share.
Eigen::Matrix3d middleCovariance(const vision::Feature& feature) {
  if (feature.vertices.size() == 1) return feature.vertices[0].covariance;
  if (feature.kind == vision::FeatureKind::kLine && feature.vertices.size() == 2) {
    return 0.25 * (feature.vertices[0].covariance + feature.vertices[1].covariance + feature.cross_covariance +
                   feature.cross_covariance.transpose());
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& vertex : feature.vertices) sum += vertex.covariance;
  const double n = static_cast<double>(feature.vertices.size());
  return sum / (n * n);
}

void fillNumbers(FeatureRow& row, const vision::Feature& feature) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& vertex : feature.vertices) {
    sum += vertex.xyz;
    row.miss = std::max(row.miss, vertex.miss_m);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(vertex.covariance, Eigen::EigenvaluesOnly);
    row.plus_minus = std::max(row.plus_minus, plusMinus95(std::sqrt(std::max(0.0, axes.eigenvalues()(2)))));
  }
  row.xyz = sum / static_cast<double>(feature.vertices.size());
  row.sigma = middleCovariance(feature).diagonal().cwiseMax(0).cwiseSqrt();
  row.warnings = feature.warnings;
  if (feature.kind == vision::FeatureKind::kLine) {
    row.length = feature.length();
    row.length_plus_minus = plusMinus95(feature.lengthSigma());
  }
  if (feature.pipe) {
    row.radius = feature.pipe->radius;
    row.radius_plus_minus = plusMinus95(feature.pipe->radius_sigma);
  }
  if (feature.box) {
    row.size = feature.box->size;
    row.size_plus_minus = plusMinus95(1) * feature.box->sizeSigma();
    row.xyz = feature.box->X_WB.translation();
    row.sigma = feature.box->covariance.diagonal().head<3>().cwiseMax(0).cwiseSqrt();
  }
  if (feature.plane) row.xyz = feature.plane->center;
}

}  // namespace

FeatureRow featureRow(const SketchItem& item, const Measurement& measurement) {
  FeatureRow row;
  row.id = item.id;
  row.name = item.name;
  row.kind = item.kind;
  row.hidden = item.hidden;
  row.locked = item.locked;
  row.colour = item.colour;
  row.pipe = item.pipe;
  row.group = item.group;
  row.note = item.note;
  row.reason = measurement.reason;
  if (!measurement.feature || measurement.feature->vertices.empty()) return row;
  row.measured = true;
  row.stale = measurement.stale;
  fillNumbers(row, *measurement.feature);
  fillTexts(row);
  return row;
}

std::vector<FeatureRow> featureRows(const Document& document) {
  std::vector<FeatureRow> rows;
  rows.reserve(document.items().size());
  for (const auto& item : document.items()) {
    rows.push_back(featureRow(item, document.measurement(item.id)));
    rows.back().selected = document.selection().contains(item.id);
    rows.back().primary = document.selection().primary == item.id;
  }
  return rows;
}

}  // namespace longarm::session
