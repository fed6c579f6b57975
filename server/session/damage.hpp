#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <fmt/format.h>

namespace scanloom::session {

/// Returns the error (kDataLoss) for a log entry that has a correct checksum but cannot be decoded.
[[nodiscard]] inline Error damaged_entry(Revision revision, const Error& why) {
    return {Errc::kDataLoss, fmt::format("log entry {}: {}", revision, why.message)};
}

} // namespace scanloom::session
