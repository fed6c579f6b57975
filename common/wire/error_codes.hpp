#pragma once

#include "common/error/error.hpp"

#include "scanloom/v1/frame.pb.h"

/// Converts between Errc and the error codes of the wire.
namespace scanloom::wire {

[[nodiscard]] v1::ErrorCode to_code(Errc errc) noexcept;

/// Returns kInternal for the code of a newer version; the message that comes with it explains the failure.
[[nodiscard]] Errc to_errc(v1::ErrorCode code) noexcept;

} // namespace scanloom::wire
