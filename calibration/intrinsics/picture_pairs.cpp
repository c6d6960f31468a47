#include "calibration/intrinsics/picture_pairs.h"

namespace longarm::calibration {
namespace {

std::string digitsOf(const std::string& path) {
  const auto slash = path.find_last_of('/');
  std::string out;
  for (const char c : path.substr(slash == std::string::npos ? 0 : slash + 1)) {
    if (c >= '0' && c <= '9') out += c;
  }
  return out;
}

}  // namespace

Result<std::vector<std::pair<std::size_t, std::size_t>>> pairPictures(const std::vector<std::string>& names) {
  if (names.empty() || names.size() % 2 != 0) {
    return Error{ErrorCode::kInvalidInput, std::to_string(names.size()) + " pictures were given; expected pairs: left01 right01 left02 right02 ..., or all left and then all right ones"};
  }
  const std::size_t n = names.size() / 2;
  const bool alternate = n == 1 || digitsOf(names[0]) == digitsOf(names[1]) || digitsOf(names[0]) != digitsOf(names[n]);
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t k = 0; k < n; ++k) out.emplace_back(alternate ? 2 * k : k, alternate ? 2 * k + 1 : k + n);
  return out;
}

}  // namespace longarm::calibration
