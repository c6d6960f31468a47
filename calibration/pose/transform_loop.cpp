#include "calibration/pose/transform_loop.h"

namespace longarm::calibration {

const char* toString(LoopUnknown unknown) {
  switch (unknown) {
    case LoopUnknown::kExt: return "T_ext";
    case LoopUnknown::kDev: return "T_dev";
    case LoopUnknown::kObj: return "T_obj";
    case LoopUnknown::kIntrinsics: return "C_int";
  }
  return "";
}

Result<LoopUnknown> loopUnknownFromText(const std::string& text) {
  for (const LoopUnknown unknown : {LoopUnknown::kExt, LoopUnknown::kDev, LoopUnknown::kObj, LoopUnknown::kIntrinsics}) {
    if (text == toString(unknown)) return unknown;
  }
  return Error{ErrorCode::kInvalidInput, "\"" + text.substr(0, 40) + "\" is no unknown of the loop; expected T_ext, T_dev, T_obj or C_int"};
}

}  // namespace longarm::calibration
