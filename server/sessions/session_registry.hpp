#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/sessions/session_cache.hpp"
#include "server/sessions/session_factory.hpp"
#include "server/sessions/session_info.hpp"
#include "server/store/scan_log.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace scanloom::session {

/// Returns the error (kNotFound) for a session that does not exist.
/// @param name  any string, also an invalid session name
[[nodiscard]] Error no_such_session(std::string_view name);

/// Executors, clocks and memory limits of a registry.
struct RegistryConfig {
    boost::asio::any_io_executor compute;                   ///< sessions apply entries on it
    std::function<double()> now;                            ///< seconds since the epoch, for SessionInfo::created
    std::optional<boost::asio::any_io_executor> may_wait{}; ///< sessions write checkpoints on it; default: `compute`
    std::optional<boost::asio::any_io_executor> reading{};  ///< sessions are loaded on it; default: `compute`

    std::function<SessionCache::Clock::time_point()> clock = [] { return SessionCache::Clock::now(); };

    /// Pages of the maps of all sessions in memory. When they are used up, unused sessions are evicted. If that is not
    /// enough, new scans and requests for sessions that are not in memory are refused.
    std::size_t pages_max = std::numeric_limits<std::int64_t>::max();
    SessionCache::Clock::duration idle_after =
        std::chrono::minutes(10); ///< tidy() evicts sessions that are unused as long
};

/// All sessions by name.
///
/// A session without users is evicted from memory, with a checkpoint at the end of its log, and is loaded again on the
/// next request. Robots and requests hold the session that they use; viewers do not, and reconnect. The facts that a
/// list of sessions shows stay in memory.
/// Threads: any thread. All functions that store, remove or wait block on the disk: create(), import_map(), exclude(),
/// lift_exclusion(), remove(), recover(), drain() and the load() that returns a session. Do not call these on I/O
/// threads or on threads of the config's executors.
class SessionRegistry {
public:
    SessionRegistry(store::ScanLog& log, RegistryConfig config);

    /// Finds the stored sessions. Call once, before any other function.
    ///
    /// A session with a checkpoint at the end of its log stays out of memory. For the others, the newest checkpoint is
    /// loaded and the rest of the log is replayed. A damaged session is left out and listed by damaged(); it does not
    /// prevent the recovery of the others. drain() stops the recovery early; the entries applied so far are kept in
    /// checkpoints.
    /// Errors: kStoreFailed if the sessions cannot be listed.
    [[nodiscard]] Result<> recover();

    /// Returns the session if it is in memory; otherwise, or if it does not exist, null.
    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name) const;

    /// Returns whether the session exists and load() would have to load it first.
    [[nodiscard]] bool needs_loading(std::string_view name) const { return cache_.needs_loading(name); }

    /// Passes the session to `on_loaded`, after loading it from the store if necessary.
    ///
    /// @param on_loaded  called once, possibly before this function returns, with the session or one of
    ///               kNotFound, kOverloaded (no memory for it now), kStoreFailed, kShuttingDown, or the error in
    ///               damaged() if the session is damaged
    void load(std::string_view name, SessionCache::Loaded on_loaded);

    /// Returns the session, after loading it from the store if necessary. Blocks until then.
    /// Errors: those that load() with a callback passes on.
    [[nodiscard]] Result<std::shared_ptr<Session>> load(std::string_view name);

    /// Returns the sessions in memory, sorted by name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> list() const { return cache_.loaded(); }

    /// Returns all sessions except the damaged ones, sorted by name.
    [[nodiscard]] std::vector<ListedSession> all() const { return cache_.all(); }

    /// Returns the entry of the session in all(); nullopt if it does not exist or is damaged.
    [[nodiscard]] std::optional<ListedSession> listed(std::string_view name) const { return cache_.listed(name); }

    /// Returns the session's properties; nullopt if it does not exist or is damaged.
    [[nodiscard]] std::optional<SessionInfo> info(std::string_view name) const { return cache_.info(name); }

    /// Returns the sessions that could not be recovered, with the reason for each, by name.
    [[nodiscard]] std::map<std::string, Error> damaged() const;

    /// Creates an empty session.
    ///
    /// @param creator  the creator and its limits
    /// Errors: kInvalidField if the name or an option is invalid; kAlreadyExists; kFull if the creator has reached its
    /// limit of sessions; kStoreFailed; kShuttingDown.
    [[nodiscard]] Result<std::shared_ptr<Session>> create(std::string_view name, const SessionOptions& options,
                                                          const Creator& creator = {});

    /// Creates a session that starts with an imported map, whose patches become the first entries of the log.
    ///
    /// After a crash during the import, the next start removes the incomplete session.
    /// @param patches  parts of the map, with cells of the size in `options`
    /// Errors: those of create(); kInvalidField or kFull also if the map is invalid or too large with this cell size;
    /// kOverloaded if there is no memory for it now.
    [[nodiscard]] Result<std::shared_ptr<Session>> import_map(std::string_view name, const SessionOptions& options,
                                                              const std::vector<MapPatch>& patches,
                                                              const Creator& creator = {});

    /// Excludes scans of a robot from the session's maps by appending an entry to its log.
    ///
    /// Evicts the session: robots and viewers are asked to connect again, and the maps are computed again from the log
    /// when the session is next loaded.
    /// @param robot  a robot that has joined the session
    /// Errors: kNotFound if there is no such session, or the error in damaged() if it is damaged; kFull if
    /// Exclusions::kMost are in effect; kOverloaded or kStoreFailed if the entry was not stored; kShuttingDown.
    [[nodiscard]] Result<Exclusion> exclude(std::string_view name, RobotIndex robot,
                                            const std::variant<StampRange, SeqRange>& scans);

    /// Lifts an exclusion by appending an entry to the log. Evicts the session as exclude() does.
    /// Errors: those of exclude(); kNotFound also if no exclusion with that id is in effect.
    [[nodiscard]] Result<> lift_exclusion(std::string_view name, std::uint64_t id);

    /// Deletes a session, damaged or not, with its log and its maps.
    /// Errors: kNotFound, kStoreFailed.
    [[nodiscard]] Result<> remove(std::string_view name);

    /// Evicts unused sessions and retries work that was postponed. Call periodically; does not block.
    ///
    /// Retries the loading of sessions for which there was no memory. If the store accepts writes, reloads the sessions
    /// that have failed, as a restart would; their robots and viewers are asked to connect again.
    void tidy();

    /// Shuts down: refuses new sessions, stops recover() and closes all sessions. Returns when everything that was
    /// submitted is durable.
    void drain();

    /// Makes drain() end soon. See Session::hurry().
    void hurry();

    [[nodiscard]] const SessionCounters& counters() const noexcept { return *factory_.counters; }

    [[nodiscard]] bool is_draining() const noexcept { return draining_; }

    /// Returns the budget of the maps in memory.
    [[nodiscard]] const limits::MemoryBudget& pages() const noexcept { return *pages_; }

private:
    struct Damaged {
        store::SessionId id = 0;
        Error error;
    };

    [[nodiscard]] Result<> check_new(std::string_view name, const Creator& creator) const;
    [[nodiscard]] std::shared_ptr<Session> add(SessionInfo info, mapping::Projection projection);
    void trim_heap(std::size_t pages);

    void recover_one(const SessionInfo& info, std::uint32_t map_patches, std::function<void()> done);
    [[nodiscard]] bool try_add_evicted(const SessionInfo& info, std::uint32_t map_patches);
    void add_recovered(std::shared_ptr<Session> session, std::function<void()> done);
    void keep_damaged(std::string name, store::SessionId id, Error why);
    [[nodiscard]] std::optional<Error> damage_of(std::string_view name) const;

    /// A session that was requested and must be loaded.
    struct Wanted {
        EvictedSession evicted;
        SessionCache::Clock::time_point until; // refused after this time if there is still no memory
    };

    void start_load(const EvictedSession& evicted);
    void retry_loads();
    void read(const Wanted& wanted);
    [[nodiscard]] bool reserve_pages(const Wanted& wanted);
    [[nodiscard]] std::size_t spare_pages() const noexcept;
    void free_pages(std::size_t pages);
    void reload_failed();
    void close_for_eviction(std::vector<std::shared_ptr<Session>> sessions, const Error& why);
    void on_evicted(const Session& session);

    using MakeEntry = std::function<Result<LogEntry>(const SessionInfo&)>;
    [[nodiscard]] Result<Revision> change_exclusions(std::string_view name, const MakeEntry& make);

    store::ScanLog& log_;
    const RegistryConfig config_;
    const boost::asio::any_io_executor may_wait_;
    const boost::asio::any_io_executor reading_;
    const std::shared_ptr<limits::MemoryBudget> pages_;
    SessionFactory factory_;
    std::atomic<bool> draining_ = false;
    std::atomic<bool> hurried_ = false;

    std::mutex changing_; // held during recover(), create() and remove(), which write to the store first
    SessionCache cache_;

    mutable std::shared_mutex damaged_mutex_;
    std::map<std::string, Damaged, std::less<>> damaged_;

    std::mutex room_mutex_;                // guards the members below
    std::vector<Wanted> waiting_for_room_; // to be retried
    std::size_t freed_pages_ = 0;          // since memory was last returned to the system
};

} // namespace scanloom::session
