#pragma once

#include "common/error/error.hpp"
#include "common/limits/memory_budget.hpp"
#include "server/sessions/session_cache.hpp"
#include "server/store/scan_log.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <algorithm>
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
#include <utility>
#include <vector>

/// The state that the parts of a registry share: SessionRegistry, SessionLoader and recover_sessions().
namespace scanloom::sessions {

/// Returns the error (kNotFound) for a session that does not exist.
/// @param name  any string, also an invalid session name
[[nodiscard]] Error no_such_session(std::string_view name);

/// Returns the reason (kShuttingDown) for which robots and viewers of a session must connect again.
[[nodiscard]] Error maps_are_computed_again(const std::string& name);

/// Closes the session and waits for it. Acknowledged scans are durable; robots send the others again.
/// @param reason  for robots and viewers
/// Threads: any thread that may wait, but not one of the session's executor.
void discard_and_wait(Session& session, Error reason);

/// Executors, clocks and memory limits of a registry.
struct RegistryConfig {
    boost::asio::any_io_executor compute; ///< sessions apply entries on it
    std::function<double()> now;          ///< seconds since the epoch, for SessionInfo::created
    std::optional<boost::asio::any_io_executor>
        blocking_executor{};                               ///< sessions write checkpoints on it; default: `compute`
    std::optional<boost::asio::any_io_executor> reading{}; ///< sessions are loaded on it; default: `compute`

    std::function<SessionCache::Clock::time_point()> clock = [] { return SessionCache::Clock::now(); };

    /// Pages of the maps of all sessions in memory. When they are used up, unused sessions are evicted. If that is not
    /// enough, new scans and requests for sessions that are not in memory are refused.
    std::size_t pages_max = std::numeric_limits<std::int64_t>::max();
    SessionCache::Clock::duration idle_after =
        std::chrono::minutes(10); ///< tidy() evicts sessions that are unused as long
};

/// Creates the sessions of a server from what they share.
struct SessionFactory {
    store::ScanLog& log;
    boost::asio::any_io_executor compute;           ///< sessions apply entries on it
    boost::asio::any_io_executor blocking_executor; ///< sessions write checkpoints on it, which blocks
    SessionLimits limits{};
    std::shared_ptr<SessionCounters> counters = std::make_shared<SessionCounters>();

    /// Creates a session from the maps of its whole log.
    /// @param checkpointed  revision of the stored checkpoint, as Recovered::checkpointed
    [[nodiscard]] std::shared_ptr<Session> make(SessionInfo info, localization::LocalizedProjection maps,
                                                std::optional<Revision> checkpointed) const;

    /// Loads a session from the store: the newest checkpoint, then the rest of the log.
    ///
    /// If `stop` becomes true before the end of the log, stores a checkpoint of the entries applied so far, unless
    /// `finish_early` is true.
    /// @return the session; null if it was stopped
    /// Errors: those of recover(); kGone: its creation was interrupted, and it was removed.
    /// Threads: any thread that may wait for the disk.
    [[nodiscard]] Result<std::shared_ptr<Session>> read(const SessionInfo& info, const std::atomic<bool>& stop,
                                                        const std::atomic<bool>& finish_early) const;
};

/// The sessions that could not be recovered, by name.
/// Threads: any thread.
class DamagedSessions {
public:
    /// Adds a session, or replaces the reason, and writes it to the program's log.
    /// @param name  the session's name, or '#' and its number if its record cannot be decoded
    void add(std::string name, store::SessionId id, Error why);

    [[nodiscard]] bool contains(store::SessionId id) const;

    /// Returns why the session cannot be recovered: kDataLoss, kMalformed or kConflict for stored data that must be
    /// deleted or repaired, kOverloaded if memory ran out; nullopt if it is not damaged.
    [[nodiscard]] std::optional<Error> find(std::string_view name) const;

    /// Returns the sessions with the reason for each.
    [[nodiscard]] std::map<std::string, Error> all() const;

    /// Deletes a session from the store.
    /// Errors: kNotFound if it is not damaged; kNotOwner; kStoreFailed.
    [[nodiscard]] Result<> remove(std::string_view name, store::ScanLog& log);

private:
    struct Damaged {
        store::SessionId id = 0;
        Error error;
    };

    mutable std::shared_mutex mutex_;
    std::map<std::string, Damaged, std::less<>> damaged_;
};

/// The servers that share the log, as read last.
/// Threads: any thread.
class NodeList {
public:
    void replace(std::vector<store::Node> nodes) {
        const std::lock_guard lock(mutex_);
        nodes_ = std::move(nodes);
    }

    [[nodiscard]] std::vector<store::Node> all() const {
        const std::lock_guard lock(mutex_);
        return nodes_;
    }

    /// Returns whether a server is dead, or another one has its name.
    [[nodiscard]] bool is_dead(const store::NodeInfo& server) const {
        const std::lock_guard lock(mutex_);
        return std::ranges::none_of(nodes_, [&](const store::Node& node) {
            return !node.is_dead && node.info->name == server.name && node.info->http == server.http;
        });
    }

private:
    mutable std::mutex mutex_;
    std::vector<store::Node> nodes_;
};

struct RegistryState {
    RegistryState(store::ScanLog& scan_log, RegistryConfig registry_config)
        : log(scan_log), config(std::move(registry_config)),
          blocking_executor(config.blocking_executor.value_or(config.compute)),
          reading(config.reading.value_or(config.compute)),
          pages(std::make_shared<limits::MemoryBudget>(config.pages_max)), factory{log, config.compute,
                                                                                   blocking_executor} {
        factory.limits.shared = {pages};
    }

    /// Returns why a session that the cache does not have cannot be served.
    [[nodiscard]] Error why_missing(std::string_view name) const {
        return damaged.find(name).value_or(no_such_session(name));
    }

    store::ScanLog& log;
    const RegistryConfig config;
    const boost::asio::any_io_executor blocking_executor;
    const boost::asio::any_io_executor reading;
    const std::shared_ptr<limits::MemoryBudget> pages; ///< of the maps in memory
    SessionFactory factory;
    std::atomic<bool> draining = false;     ///< the server shuts down: no recovery, no loading, no new sessions
    std::atomic<bool> finish_early = false; ///< the shutdown must end soon
    SessionCache cache;
    DamagedSessions damaged;
    NodeList nodes; ///< empty: this server uses the log alone
};

} // namespace scanloom::sessions
