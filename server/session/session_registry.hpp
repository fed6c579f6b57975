#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/session/session.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::session {

/// All sessions by name.
/// Thread  any. create(), remove(), recover() and drain() wait for the disk: not on I/O threads.
class SessionRegistry {
public:
    /// `now` gives seconds since the epoch, for SessionInfo::created.
    SessionRegistry(store::ScanLog& log, boost::asio::any_io_executor compute, std::function<double()> now);

    /// Weaves every stored session again: newest checkpoint, then the rest of its log.
    /// Errors  the first session that cannot be recovered, with its name.
    [[nodiscard]] Result<> recover();

    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name) const;

    /// By rising name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> list() const;

    /// Errors  kInvalidField (name or an option), kAlreadyExists, kStoreFailed, kShuttingDown.
    [[nodiscard]] Result<std::shared_ptr<Session>> create(std::string_view name, const SessionOptions& options);

    /// Deletes the session, its log and its maps. Errors: kNotFound, kStoreFailed.
    [[nodiscard]] Result<> remove(std::string_view name);

    /// Refuses new sessions, closes all, returns when everything submitted is durable.
    void drain();

    [[nodiscard]] bool is_draining() const noexcept { return draining_; }

private:
    std::atomic<bool> draining_ = false;
};

} // namespace scanloom::session
