#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <fmt/format.h>

namespace scanloom::session {

/// What an entry of a log that cannot be read, though its checksum is right, says of the log.
[[nodiscard]] inline Error damaged_entry(Revision revision, const Error& why) {
    return {Errc::kDataLoss, fmt::format("log entry {}: {}", revision, why.message)};
}

} // namespace scanloom::session
