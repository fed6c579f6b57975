#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"
#include "server/sessions/registry_state.hpp"
#include "server/sessions/session_cache.hpp"
#include "server/sessions/session_info.hpp"
#include "server/sessions/session_loader.hpp"
#include "server/sessions/successors.hpp"
#include "server/store/scan_log.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::sessions {

/// All sessions by name.
///
/// A session without users is evicted from memory, with a checkpoint at the end of its log, and is loaded again on the
/// next request. Robots and requests hold the session that they use; viewers do not, and reconnect. The facts that a
/// list of sessions shows stay in memory.
/// Threads: any thread. All functions that store, remove or wait block on the disk: create(), import_map(), exclude(),
/// lift_exclusion(), estimate(), remove(), recover(), drain() and the load() that returns a session. Do not call these
/// on I/O threads or on threads of the config's executors.
class SessionRegistry {
public:
    /// @param log  must outlive this object
    SessionRegistry(store::ScanLog& log, RegistryConfig config) : state_(log, std::move(config)), loader_(state_) {}

    /// Finds the stored sessions; see recover_sessions(). Call once, before any other function.
    ///
    /// A damaged session is left out and listed by damaged(); it does not prevent the recovery of the others.
    /// Errors: kStoreFailed if the sessions cannot be listed.
    [[nodiscard]] Result<> recover();

    /// Returns the session if it is in memory; otherwise, or if it does not exist, null.
    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name) const;

    /// Passes the session to `on_loaded`, after loading it from the store if necessary.
    ///
    /// @param on_loaded  called once, possibly before this function returns, with the session or one of
    ///               kNotFound, kNotOwner (another server that shares the log has it), kOverloaded (no memory for it
    ///               now), kStoreFailed, kShuttingDown, or the error in damaged() if the session is damaged
    void load(std::string_view name, SessionCache::Loaded on_loaded) { loader_.load(name, std::move(on_loaded)); }

    /// Returns the session, after loading it from the store if necessary. Blocks until then.
    /// Errors: those that load() with a callback passes on.
    [[nodiscard]] Result<std::shared_ptr<Session>> load(std::string_view name);

    /// Returns the sessions in memory, sorted by name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> list() const { return state_.cache.loaded(); }

    /// Returns all sessions except the damaged ones, sorted by name.
    [[nodiscard]] std::vector<ListedSession> all() const { return state_.cache.all(); }

    /// Returns the entry of the session in all(); nullopt if it does not exist or is damaged.
    [[nodiscard]] std::optional<ListedSession> listed(std::string_view name) const { return state_.cache.listed(name); }

    /// Returns the session's properties; nullopt if it does not exist or is damaged.
    [[nodiscard]] std::optional<SessionInfo> info(std::string_view name) const { return state_.cache.info(name); }

    /// Returns the sessions that could not be recovered, with the reason for each, by name.
    [[nodiscard]] std::map<std::string, Error> damaged() const { return state_.damaged.all(); }

    /// Returns the server that has the session, as it was known a second ago; null: this one, or none.
    [[nodiscard]] std::shared_ptr<const store::NodeInfo> owner(std::string_view name) const {
        return state_.cache.owner(name);
    }

    /// Returns the server that goes on with the session when this one shuts down; null: not known, or none.
    [[nodiscard]] std::shared_ptr<const store::NodeInfo> successor(std::string_view name) const {
        return successors_.of(name);
    }

    /// Checks that no other server has taken a session in memory, while this one was paused. Blocks.
    /// Errors: kNotOwner, kNotFound, kStoreFailed.
    [[nodiscard]] Result<> confirm(const Session& session) {
        auto* const shared = state_.log.shared();
        return shared == nullptr ? Result<>() : shared->confirm(session.info().id);
    }

    /// Returns whether several servers share the log.
    [[nodiscard]] bool is_shared() const { return state_.log.shared() != nullptr; }

    /// Looks the session's server up again at the next use of the session, because the known one does not answer.
    void forget_owner(std::string_view name) { state_.cache.set_owner(name, nullptr); }

    /// Returns the servers that share the log, by name; empty: this one uses it alone.
    [[nodiscard]] std::vector<store::Node> nodes() const { return state_.nodes.all(); }

    /// Returns whether a server is dead, or another one has its name, as it was known a second ago.
    [[nodiscard]] bool is_dead(const store::NodeInfo& server) const { return state_.nodes.is_dead(server); }

    /// Creates an empty session.
    ///
    /// @param creator  the creator and its limits
    /// @param is_localize_only  whether it begins in this mode
    /// Errors: kInvalidField if the name or an option is invalid; kAlreadyExists; kFull if the creator has reached its
    /// limit of sessions; kStoreFailed; kShuttingDown.
    [[nodiscard]] Result<std::shared_ptr<Session>> create(std::string_view name, const SessionOptions& options,
                                                          const Creator& creator = {}, bool is_localize_only = false);

    /// Creates a session that starts with an imported map, whose patches become the first entries of the log.
    ///
    /// After a crash during the import, the next start removes the incomplete session.
    /// @param patches  parts of the map, with cells of the size in `options`
    /// @param is_localize_only  whether it is in this mode after the import
    /// Errors: those of create(); kInvalidField or kFull also if the map is invalid or too large with this cell size;
    /// kOverloaded if there is no memory for it now.
    [[nodiscard]] Result<std::shared_ptr<Session>> import_map(std::string_view name, const SessionOptions& options,
                                                              const std::vector<MapPatch>& patches,
                                                              const Creator& creator = {},
                                                              bool is_localize_only = false);

    /// Excludes scans of a robot from the session's maps by appending an entry to its log.
    ///
    /// Evicts the session: robots and viewers are asked to connect again, and the maps are computed again from the log
    /// when the session is next loaded.
    /// @param robot  a robot that has joined the session
    /// Errors: kNotFound if there is no such session, or the error in damaged() if it is damaged; kNotOwner; kFull if
    /// Exclusions::kMost are in effect; kOverloaded or kStoreFailed if the entry was not stored; kShuttingDown.
    [[nodiscard]] Result<Exclusion> exclude(std::string_view name, RobotIndex robot,
                                            const std::variant<StampRange, SeqRange>& scans);

    /// Lifts an exclusion by appending an entry to the log. Evicts the session as exclude() does.
    /// Errors: those of exclude(); kNotFound also if no exclusion with that id is in effect.
    [[nodiscard]] Result<> lift_exclusion(std::string_view name, std::uint64_t id);

    /// Replaces the session by a copy in which the poses that robots sent as poses in the map frame are their odometry,
    /// so that the server estimates the poses. Evicts the session as exclude() does, and forgets its SessionInfo::id.
    ///
    /// If all poses are estimated already, the session is only evicted: poses are estimated when it is loaded.
    /// @return its properties before the call
    /// Errors: kNotFound or the error in damaged(), as exclude(); kConflict if a robot that sends poses in the map frame
    /// is connected; those of copy_as_odometry(); kOverloaded; kShuttingDown.
    [[nodiscard]] Result<SessionInfo> estimate(std::string_view name);

    /// Deletes a session, damaged or not, with its log and its maps.
    /// Errors: kNotFound, kNotOwner, kStoreFailed.
    [[nodiscard]] Result<> remove(std::string_view name);

    /// Evicts unused sessions and retries work that was postponed. Call periodically, on a thread that may wait for the
    /// store.
    ///
    /// Retries the loading of sessions for which there was no memory. If the store accepts writes, reloads the sessions
    /// that have failed, as a restart would; their robots and viewers are asked to connect again. Finds the sessions
    /// that other servers of a shared log have created or removed.
    void tidy() { loader_.tidy(); }

    /// Shuts down: refuses new sessions, stops recover() and closes all sessions. Robots are sent to the successors.
    /// Returns when everything that was submitted is durable.
    void drain();

    /// Makes drain() end soon. See Session::finish_early().
    void finish_early();

    [[nodiscard]] const SessionCounters& counters() const noexcept { return *state_.factory.counters; }

    [[nodiscard]] bool is_draining() const noexcept { return state_.draining; }

    /// Returns the budget of the maps in memory.
    [[nodiscard]] const limits::MemoryBudget& pages() const noexcept { return *state_.pages; }

private:
    using MakeEntry = std::function<Result<LogEntry>(const SessionInfo&)>;

    [[nodiscard]] Result<std::shared_ptr<Session>> load_shared(std::string_view name);
    [[nodiscard]] Result<> check_new(std::string_view name, const Creator& creator) const;
    [[nodiscard]] Result<std::shared_ptr<Session>> add(SessionInfo info, mapping::Projection projection,
                                                       bool is_localize_only);
    [[nodiscard]] Result<> append_first(store::SessionId session, Revision revision, const LogEntry& entry);
    [[nodiscard]] Result<> take_as_odometry(ListedSession& left);
    [[nodiscard]] Result<Revision> change_exclusions(std::string_view name, const MakeEntry& make);

    RegistryState state_;
    SessionLoader loader_;
    Successors successors_;
    std::mutex changing_; // held by recover() and by the functions that write to the store; by estimate() at its start
};

} // namespace scanloom::sessions
