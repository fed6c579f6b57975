#pragma once

#include "common/error/error.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <functional>

namespace scanloom::store {

/// What was copied of a session.
struct CopiedSession {
    SessionId from = 0;
    SessionId to = 0;
    std::uint64_t entries = 0;
    std::uint64_t parts = 0; ///< of the checkpoint
};

/// Copies all sessions with their entries and checkpoints, in the order of their ids. Ids may become smaller, because
/// removed sessions leave no gaps.
/// @param to          must be empty
/// @param on_session  called after each session
/// Errors: kConflict: `to` is not empty; kDataLoss: something of `from` is damaged; those of reading `from` and writing
///         `to`. What was copied until then stays in `to`.
[[nodiscard]] Result<> copy_log(ScanLog& from, ScanLog& to,
                                const std::function<void(const CopiedSession&)>& on_session);

} // namespace scanloom::store
