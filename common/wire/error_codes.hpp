#pragma once

#include "common/error/error.hpp"

#include "scanloom/v1/frame.pb.h"

/// What went wrong, as the wire numbers it.
namespace scanloom::wire {

[[nodiscard]] v1::ErrorCode to_code(Errc errc) noexcept;

/// A code of a newer version is kInternal: the sentence beside it tells.
[[nodiscard]] Errc to_errc(v1::ErrorCode code) noexcept;

} // namespace scanloom::wire
