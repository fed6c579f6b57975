#pragma once

#include "common/error/error.hpp"
#include "server/session/session.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace scanloom::session {

/// What all sessions of a server are made with.
struct SessionFactory {
    store::ScanLog& log;
    boost::asio::any_io_executor compute;  ///< where sessions weave
    boost::asio::any_io_executor may_wait; ///< where they write checkpoints
    SessionLimits limits{};
    std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>();

    [[nodiscard]] std::shared_ptr<Session> make(SessionInfo info, mapping::Projection projection,
                                                std::optional<Revision> checkpointed) const;

    /// Reads a session from the store and weaves the rest of its log. When `stop` becomes true before its end, what was
    /// woven is kept as a checkpoint, unless `hurried`, and there is no session.
    /// Errors  those of recover().
    [[nodiscard]] Result<std::shared_ptr<Session>> read(const SessionInfo& info, const std::atomic<bool>& stop,
                                                        const std::atomic<bool>& hurried) const;
};

} // namespace scanloom::session
