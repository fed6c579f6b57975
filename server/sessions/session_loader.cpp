#include "server/sessions/session_loader.hpp"

#include "server/sessions/registry_recovery.hpp"
#include "server/store/shared_sessions.hpp"

#include <malloc.h>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <chrono>
#include <limits>
#include <utility>

namespace scanloom::sessions {
namespace {

/// How long a request waits for memory, because the users of other sessions may release them soon.
constexpr std::chrono::seconds kLoadTimeout{5};

Error leaves_memory() { return {Errc::kShuttingDown, "the session is evicted from memory; connect again"}; }

Error no_room(const EvictedSession& evicted) {
    return {Errc::kOverloaded, fmt::format("session '{}' needs {} MiB for its maps, and the maps in use leave less of "
                                           "the memory for maps; try again later, or raise the server's --map-memory",
                                           evicted.info.name, evicted.pages * mapping::kPageBytes >> 20)};
}

} // namespace

SessionLoader::SessionLoader(RegistryState& state) : state_(state) {
    state_.factory.limits.on_short = [this](std::size_t pages) {
        boost::asio::post(state_.blocking_executor, [this, pages] { free_pages(pages + spare_pages()); });
    };
}

// Loading

void SessionLoader::load(std::string_view name, SessionCache::Loaded on_loaded) {
    auto on_session = [this, name = std::string(name),
                       on_loaded = std::move(on_loaded)](Result<std::shared_ptr<Session>> session) {
        if (!session || *session) return on_loaded(std::move(session));
        if (state_.log.shared() != nullptr && !state_.draining) return find_in_log(name, on_loaded);
        on_loaded(state_.why_missing(name));
    };
    load(state_.cache.request(name, state_.config.clock(), std::move(on_session)));
}

/// Loads a session that another server may have created.
void SessionLoader::find_in_log(const std::string& name, SessionCache::Loaded on_loaded) {
    boost::asio::post(state_.reading, [this, name, on_loaded = std::move(on_loaded)] {
        const auto found = discover(state_, name);
        if (found && state_.cache.contains(name)) return load(name, on_loaded);
        const bool may_pass = !found && found.error().code != Errc::kNotFound;
        on_loaded(may_pass ? found.error() : state_.why_missing(name));
    });
}

void SessionLoader::load(const std::optional<EvictedSession>& wanted) {
    if (!wanted) return;
    boost::asio::post(state_.reading,
                      [this, next = Wanted{*wanted, state_.config.clock() + kLoadTimeout}] { read(next); });
}

void SessionLoader::retry() {
    std::vector<Wanted> again;
    {
        const std::lock_guard lock(mutex_);
        again.swap(waiting_for_room_);
    }
    for (auto& wanted : again) boost::asio::post(state_.reading, [this, wanted = std::move(wanted)] { read(wanted); });
}

void SessionLoader::read(const Wanted& wanted) {
    const auto& [info, pages] = wanted.evicted;
    auto& cache = state_.cache;
    if (state_.draining) return cache.fail_load(info.name, shutting_down());
    if (!reserve_pages(wanted)) return;
    const auto owned = store::own(state_.log, info.id);
    auto session = owned ? state_.factory.read(info, state_.draining, state_.finish_early)
                         : Result<std::shared_ptr<Session>>(owned.error());
    state_.pages->give_back(static_cast<std::int64_t>(pages)); // the session has taken its own pages
    if (session && *session) return cache.end_load(std::move(*session), state_.config.clock());
    if (session) return cache.fail_load(info.name, shutting_down());
    const Error& why = session.error();
    if (why.code == Errc::kNotOwner) {
        auto found = state_.log.shared()->find(info.name);
        if (found && *found) cache.set_owner(info.name, std::move((*found)->shared.owner));
        return cache.fail_load(info.name, why);
    }
    if (why.code == Errc::kNotFound || why.code == Errc::kGone)
        return cache.remove(info.name, no_such_session(info.name));
    if (state_.log.stats().last_error) { // the session may be intact
        return cache.fail_load(info.name, {Errc::kStoreFailed, why.message});
    }
    const bool may_pass = why.code == Errc::kOverloaded || why.code == Errc::kStoreFailed;
    if (may_pass) return cache.fail_load(info.name, why); // the next request tries again
    state_.damaged.add(info.name, info.id, why);
    cache.remove(info.name, why);
}

/// Takes the pages for a session. @return false if it will be retried or was refused
bool SessionLoader::reserve_pages(const Wanted& wanted) {
    const auto& [info, pages] = wanted.evicted;
    if (state_.pages->take(static_cast<std::int64_t>(pages))) return true;
    if (state_.config.clock() >= wanted.until) {
        state_.cache.fail_load(info.name, no_room(wanted.evicted));
        return false;
    }
    {
        const std::lock_guard lock(mutex_);
        waiting_for_room_.push_back(wanted);
    }
    free_pages(pages);            // the end of an eviction retries it
    if (state_.draining) retry(); // the last eviction may be over already
    return false;
}

// Eviction

void SessionLoader::tidy() {
    if (!state_.log.stats().last_error) reload_failed();
    close(state_.cache.evict(state_.config.clock() - state_.config.idle_after, std::numeric_limits<std::size_t>::max()),
          leaves_memory());
    free_pages(spare_pages()); // before scans must be refused
    retry();
    auto lost = discover_all(state_); // otherwise the next time
    if (lost) close(std::move(*lost), {Errc::kNotOwner, "another server has taken the session; connect again"});
}

/// Returns the number of pages to keep free for growing maps, as long as there are sessions to evict.
std::size_t SessionLoader::spare_pages() const noexcept { return static_cast<std::size_t>(state_.pages->total()) / 16; }

void SessionLoader::free_pages(std::size_t pages) {
    const auto missing = static_cast<std::int64_t>(pages) - state_.pages->free();
    if (missing <= 0) return;
    close(state_.cache.evict(SessionCache::Clock::time_point::max(), static_cast<std::size_t>(missing)),
          leaves_memory());
}

void SessionLoader::close(std::vector<std::shared_ptr<Session>> sessions, const Error& why) {
    for (const auto& session : sessions) session->close(why, [this, session] { on_evicted(*session); });
}

void SessionLoader::on_evicted(const Session& session) {
    auto summary = summary_of(*session.snapshot());
    trim_heap_later(summary.pages);
    load(state_.cache.end_eviction(session.info().name, summary));
    retry();
}

/// Reloads all failed sessions. Called each time, because a session may notice its failure only after the store was
/// opened again.
void SessionLoader::reload_failed() {
    auto failed = state_.cache.evict_failed();
    std::vector<std::string> names;
    for (const auto& session : failed) names.push_back(session->info().name);
    close(std::move(failed), {Errc::kShuttingDown, "the session is reloaded from the store; connect again"});
    for (const auto& name : names) load(name, [](const Result<std::shared_ptr<Session>>&) {});
}

void SessionLoader::trim_heap(std::size_t pages) {
    constexpr std::size_t kWorthwhile = 4096; // 80 MiB
    {
        const std::lock_guard lock(mutex_);
        freed_pages_ += pages;
        if (freed_pages_ < kWorthwhile) return;
        freed_pages_ = 0;
    }
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void SessionLoader::trim_heap_later(std::size_t pages) {
    boost::asio::post(state_.blocking_executor, [this, pages] { trim_heap(pages); });
}

} // namespace scanloom::sessions
