#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include "scanloom/v1/session.pb.h"

/// Converts the settings of sessions between protobuf messages and plain values.
namespace scanloom::wire {

/// Does not check the ranges of the settings; the session does.
/// Errors: kInvalidField if an enumeration has a value that this program does not know.
[[nodiscard]] Result<SessionOptions> from_proto(const v1::SessionConfig& config);

void to_proto(const SessionOptions& options, v1::SessionConfig& out);

} // namespace scanloom::wire
