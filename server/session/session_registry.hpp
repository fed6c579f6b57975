#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/session/maker.hpp"
#include "server/session/recovery.hpp"
#include "server/session/session.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::session {

/// What whoever names a session that does not exist is told. `name` may be anything.
[[nodiscard]] Error no_such_session(std::string_view name);

/// All sessions by name.
/// Thread  any. create(), remove(), recover() and drain() wait for the disk: not on I/O threads.
class SessionRegistry {
public:
    /// `now` gives seconds since the epoch, for SessionInfo::created.
    /// Sessions weave on `compute` and write checkpoints on `may_wait`, by default the same.
    SessionRegistry(store::ScanLog& log, boost::asio::any_io_executor compute, std::function<double()> now,
                    std::optional<boost::asio::any_io_executor> may_wait = std::nullopt);

    /// Weaves every stored session again: newest checkpoint, then the rest of its log. A session whose
    /// log is damaged is left out and listed by damaged(); the others are not held up by it. drain() stops it
    /// early and keeps what has been woven.
    /// Errors  kStoreFailed: the sessions cannot be listed.
    /// Pre     called once, before anything else, not from a thread of the compute executor.
    [[nodiscard]] Result<> recover();

    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name) const;

    /// By rising name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> list() const;

    /// What could not be recovered: name and reason.
    [[nodiscard]] std::map<std::string, Error> damaged() const;

    /// Errors  kInvalidField (name or an option), kAlreadyExists, kStoreFailed, kShuttingDown; kFull: the maker has
    ///         made as many as it may.
    [[nodiscard]] Result<std::shared_ptr<Session>> create(std::string_view name, const SessionOptions& options,
                                                          const Maker& maker = {});

    /// The same, beginning with a map that was made elsewhere: its patches are the log's first entries. Where a crash
    /// comes between, the next start removes what there is of it.
    /// Errors  also kInvalidField, kFull: the map at these cells.
    [[nodiscard]] Result<std::shared_ptr<Session>> import_map(std::string_view name, const SessionOptions& options,
                                                              const std::vector<MapPatch>& patches,
                                                              const Maker& maker = {});

    /// Deletes the session, its log and its maps, also a damaged one. Errors: kNotFound, kStoreFailed.
    /// Pre  never called from a thread of the compute executor.
    [[nodiscard]] Result<> remove(std::string_view name);

    /// Refuses new sessions, lets recover() give up, closes all, returns when everything submitted is durable.
    /// Pre  as for remove().
    void drain();

    /// Lets drain() end soon, as Session::hurry() says.
    void hurry();

    [[nodiscard]] const SessionCounters& counters() const noexcept { return *counters_; }

    [[nodiscard]] bool is_draining() const noexcept { return draining_; }

private:
    struct Damaged {
        store::SessionId id = 0;
        Error error;
    };

    [[nodiscard]] Result<> check_new(std::string_view name, const Maker& maker) const;
    [[nodiscard]] std::shared_ptr<Session> add(SessionInfo info, mapping::Projection projection,
                                               const SessionLimits& limits);
    [[nodiscard]] std::shared_ptr<Session> forget(std::string_view name);
    void give_back_memory();
    void recover_one(const store::StoredSession& stored);
    void keep_recovered(std::shared_ptr<Session> session);
    [[nodiscard]] Result<std::shared_ptr<Session>> weave(const store::StoredSession& stored, std::string& name);
    void keep_progress(store::SessionId id, const std::string& name, Recovered& recovered);

    store::ScanLog& log_;
    boost::asio::any_io_executor compute_;
    boost::asio::any_io_executor may_wait_;
    std::function<double()> now_;
    const std::shared_ptr<SessionCounters> counters_ = std::make_shared<SessionCounters>();
    std::atomic<bool> draining_ = false;
    std::atomic<bool> hurried_ = false;

    std::mutex changing_;             // held over recover(), create() and remove(), which write to the store first
    std::size_t freed_chunks_ = 0;    // by remove(), since memory was given back
    mutable std::shared_mutex mutex_; // guards the maps below
    std::map<std::string, std::shared_ptr<Session>, std::less<>> sessions_;
    std::map<std::string, Damaged, std::less<>> damaged_;
};

} // namespace scanloom::session
