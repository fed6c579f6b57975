#pragma once

#include "common/error/error.hpp"
#include "server/sessions/session.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace scanloom::session {

/// Creates the sessions of a server from what they share.
struct SessionFactory {
    store::ScanLog& log;
    boost::asio::any_io_executor compute;  ///< sessions apply entries on it
    boost::asio::any_io_executor may_wait; ///< sessions write checkpoints on it, which blocks
    SessionLimits limits{};
    std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>();

    /// Creates a session from a projection of its whole log.
    /// @param checkpointed  revision of the stored checkpoint, as Recovered::checkpointed
    [[nodiscard]] std::shared_ptr<Session> make(SessionInfo info, mapping::Projection projection,
                                                std::optional<Revision> checkpointed) const;

    /// Loads a session from the store: the newest checkpoint, then the rest of the log.
    ///
    /// If `stop` becomes true before the end of the log, stores a checkpoint of the entries applied so far, unless
    /// `hurried` is true.
    /// @return the session; null if it was stopped
    /// Errors: those of recover().
    /// Threads: any thread that may wait for the disk.
    [[nodiscard]] Result<std::shared_ptr<Session>> read(const SessionInfo& info, const std::atomic<bool>& stop,
                                                        const std::atomic<bool>& hurried) const;
};

} // namespace scanloom::session
