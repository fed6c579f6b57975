#pragma once

#include "common/error/error.hpp"
#include "server/sessions/registry_state.hpp"
#include "server/sessions/session_cache.hpp"

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::sessions {

/// Loads sessions from the store when they are requested, and evicts unused ones so that there is memory for them.
/// Threads: any thread. No function blocks, except for tidy(), which may wait for the store.
class SessionLoader {
public:
    /// @param state  must outlive this object; its sessions report to this object when they are short of memory
    explicit SessionLoader(RegistryState& state);

    /// Passes the session to `on_loaded`, after loading it from the store if necessary.
    /// @param on_loaded  called once, possibly before this function returns; see SessionRegistry::load()
    void load(std::string_view name, SessionCache::Loaded on_loaded);

    /// Loads a session for the callers that wait for it in the cache.
    /// @param wanted  returned by the cache; nullopt: does nothing
    void load(const std::optional<EvictedSession>& wanted);

    /// Tries again to load the sessions for which there was no memory.
    void retry();

    /// Evicts unused sessions, reloads failed ones and retries; see SessionRegistry::tidy().
    void tidy();

    /// Evicts sessions without users, the least recently used first, until `pages` pages are free.
    void free_pages(std::size_t pages);

    /// Returns free memory to the system after `pages` were freed, but not each time. The allocator keeps free memory
    /// between used blocks, and for each thread as much as it ever used.
    void trim_heap(std::size_t pages);

    /// Does trim_heap() on a thread that may wait.
    void trim_heap_later(std::size_t pages);

private:
    /// A session that was requested and must be loaded.
    struct Wanted {
        EvictedSession evicted;
        SessionCache::Clock::time_point until; // refused after this time if there is still no memory
    };

    void read(const Wanted& wanted);
    [[nodiscard]] bool reserve_pages(const Wanted& wanted);
    [[nodiscard]] std::size_t spare_pages() const noexcept;
    void reload_failed();
    void close(std::vector<std::shared_ptr<Session>> sessions, const Error& why);
    void on_evicted(const Session& session);
    void find_in_log(const std::string& name, SessionCache::Loaded on_loaded);

    RegistryState& state_;
    std::mutex mutex_;                     // guards the members below
    std::vector<Wanted> waiting_for_room_; // to be retried
    std::size_t freed_pages_ = 0;          // since memory was last returned to the system
};

} // namespace scanloom::sessions
