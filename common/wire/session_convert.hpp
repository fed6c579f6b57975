#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include "scanloom/v1/session.pb.h"

/// How sessions are configured, between protobuf and values.
namespace scanloom::wire {

/// Ranges are for the session to check.
/// Errors  kInvalidField: a choice that this program does not know.
[[nodiscard]] Result<SessionOptions> from_proto(const v1::SessionConfig& config);

void to_proto(const SessionOptions& options, v1::SessionConfig& out);

} // namespace scanloom::wire
