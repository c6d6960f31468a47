#include "core/result.h"

namespace longarm {

const char* toString(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput: return "invalid_input";
    case ErrorCode::kNotFound: return "not_found";
    case ErrorCode::kDegenerate: return "degenerate";
    case ErrorCode::kOutOfLimits: return "out_of_limits";
    case ErrorCode::kNoSolution: return "no_solution";
    case ErrorCode::kCollision: return "collision";
    case ErrorCode::kTimeout: return "timeout";
    case ErrorCode::kCancelled: return "cancelled";
    case ErrorCode::kStale: return "stale";
    case ErrorCode::kRefused: return "refused";
    case ErrorCode::kDisconnected: return "disconnected";
    case ErrorCode::kInternal: return "internal";
  }
  return "internal";
}

}  // namespace longarm
