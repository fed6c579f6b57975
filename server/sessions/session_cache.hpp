#pragma once

#include "common/error/error.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/summary.hpp"
#include "server/store/shared_sessions.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

/// One entry of the list of sessions, in memory or not.
struct ListedSession {
    SessionInfo info;
    std::shared_ptr<Session> session; ///< null: not in memory
    Summary summary;                  ///< only if it is not in memory
    store::SharedSession shared = {}; ///< only if it is not in memory and several servers share the log
};

/// A session that must be loaded from the store.
struct EvictedSession {
    SessionInfo info;
    std::size_t pages = 0; ///< that its maps will need
};

/// Session cache: the list of all sessions, which of them are in memory, and the callers that wait for the others.
///
/// A session is in memory, evicted, or in transition: being loaded, evicted or deleted. Only sessions
/// without an owner outside the cache are evicted, so holding a session keeps it in memory. A transition belongs to the
/// caller that started it; all other callers wait until it ends.
/// Threads: any thread. Only begin_change() and wait_for_transitions() block. Callbacks run before the call returns,
/// without a lock held.
class SessionCache {
public:
    using Clock = std::chrono::steady_clock;
    using Loaded = std::function<void(Result<std::shared_ptr<Session>>)>;

    /// Reserves the name of a session that is being created: it may be found in a shared log before it is in memory.
    class Reservation;

    /// Returns the session if it is in memory and sets its time of last use to `now`; otherwise null.
    [[nodiscard]] std::shared_ptr<Session> find(std::string_view name, Clock::time_point now) const;

    [[nodiscard]] bool contains(std::string_view name) const;

    /// Returns the session's properties; nullopt if it does not exist.
    [[nodiscard]] std::optional<SessionInfo> info(std::string_view name) const;

    /// Returns the session's entry of all(); nullopt if it does not exist.
    [[nodiscard]] std::optional<ListedSession> listed(std::string_view name) const;

    /// Returns the sessions in memory, sorted by name.
    [[nodiscard]] std::vector<std::shared_ptr<Session>> loaded() const;

    /// Returns all sessions, sorted by name.
    [[nodiscard]] std::vector<ListedSession> all() const;

    /// Adds a session that is in memory, last used at `now`. No session of that name may exist.
    void add(std::shared_ptr<Session> session, Clock::time_point now);

    /// Adds a session that is not in memory, unless there is one of that name or the name is reserved.
    void add(SessionInfo info, Summary summary, store::SharedSession shared = {});

    /// Passes the session to `on_loaded`: immediately if it is in memory, otherwise when it has been loaded.
    ///
    /// @param on_loaded  called once: with the session, with null if it does not exist, or with the error of
    ///                   fail_load() or remove()
    /// @return a session that the caller must load and then report with end_load() or fail_load(), if any
    [[nodiscard]] std::optional<EvictedSession> request(std::string_view name, Clock::time_point now, Loaded on_loaded);

    /// Starts to evict sessions, the least recently used first, until they have `pages_wanted` pages together.
    ///
    /// Only sessions without an owner outside the cache that were not used after `used_until` are evicted.
    /// @return the sessions, which the caller must close and then report with end_eviction()
    [[nodiscard]] std::vector<std::shared_ptr<Session>> evict(Clock::time_point used_until, std::size_t pages_wanted);

    /// Starts to evict all sessions that have failed, even if they have other owners.
    /// @return the sessions, which the caller must close and then report with end_eviction()
    [[nodiscard]] std::vector<std::shared_ptr<Session>> evict_failed();

    /// Ends a load: the session is in memory. Passes it to the waiting callers.
    void end_load(std::shared_ptr<Session> session, Clock::time_point now);

    /// Ends an eviction: the session is not in memory.
    /// @return the session if a caller has requested it in the meantime, to be loaded as after request()
    [[nodiscard]] std::optional<EvictedSession> end_eviction(const std::string& name, Summary summary);

    /// Ends the transition of begin_change(): another session, which is not in memory, has replaced this one.
    /// @return the session if a caller has requested it in the meantime, to be loaded as after request()
    [[nodiscard]] std::optional<EvictedSession> end_replacement(SessionInfo info, Summary summary);

    /// Ends a load that failed: passes `why` to the waiting callers. The session stays evicted.
    void fail_load(const std::string& name, const Error& why);

    /// Waits until the session is in no transition, then starts to delete it, or to change it while it is closed.
    /// @return the session in its state before; nullopt if it does not exist. The caller must end the transition with
    /// remove(), cancel_change() or end_eviction().
    [[nodiscard]] std::optional<ListedSession> begin_change(std::string_view name);

    /// Removes the session from the list and passes `why` to the waiting callers.
    void remove(std::string_view name, const Error& why);

    struct Followed {
        std::set<store::SessionId> unknown;         ///< sessions in the log that the cache lacks
        std::vector<std::shared_ptr<Session>> lost; ///< to be closed and reported as after evict()
    };

    /// Makes the list that of a log that several servers share: sets which server has each session, removes sessions
    /// that are not in the log any more, and starts to evict those that another server has taken. Does not change those
    /// that are in transition.
    /// @param all    the sessions in the log
    /// @param asked  when the log was asked; sessions loaded or used since then stay
    [[nodiscard]] Followed follow(const std::map<store::SessionId, store::SharedSession>& all, Clock::time_point asked);

    /// Sets which server has a session that is not in memory.
    void set_owner(std::string_view name, std::shared_ptr<const store::NodeInfo> owner);

    /// Returns the server that has the session, as far as is known; null: this one, or none.
    [[nodiscard]] std::shared_ptr<const store::NodeInfo> owner(std::string_view name) const;

    /// Ends the transition of begin_change() without a change.
    /// @return a session to load, as request()
    [[nodiscard]] std::optional<EvictedSession> cancel_change(std::string_view name);

    /// Waits until no session is in transition.
    void wait_for_transitions() const;

private:
    enum class State { kLoaded, kEvicted, kInTransition };

    struct Entry {
        SessionInfo info;
        State state = State::kEvicted;
        std::shared_ptr<Session> session; // also while it is being evicted or deleted
        Summary summary;                  // of a session that is not in memory
        store::SharedSession shared;      // of a session that is not in memory
        mutable std::atomic<Clock::rep> used = 0;
        Clock::time_point loaded; // of a session in memory
        std::vector<Loaded> waiting;
    };
    using Entries = std::map<std::string, Entry, std::less<>>;

    [[nodiscard]] static EvictedSession load(Entry& entry);
    [[nodiscard]] static std::optional<EvictedSession> load_if_wanted(Entry& entry);
    void touch(const Entry& entry, Clock::time_point now) const;

    mutable std::shared_mutex mutex_; // guards the entries and names; held briefly
    mutable std::condition_variable_any arrival_;
    Entries entries_;
    std::set<std::string> reserved_;
};

class SessionCache::Reservation {
public:
    /// @param cache  must outlive the reservation
    Reservation(SessionCache& cache, std::string name);
    ~Reservation();
    Reservation(const Reservation&) = delete;
    Reservation& operator=(const Reservation&) = delete;

private:
    SessionCache& cache_;
    const std::string name_;
};

} // namespace scanloom::sessions
