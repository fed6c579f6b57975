#include "server/sessions/session_registry.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <chrono>
#include <future>
#include <limits>
#include <utility>

/// Eviction and loading of sessions.
namespace scanloom::session {
namespace {

/// How long a request waits for memory, because the users of other sessions may release them soon.
constexpr std::chrono::seconds kPatience{5};

Error leaves_memory() { return {Errc::kShuttingDown, "the session is evicted from memory; connect again"}; }

Error shutting_down() { return {Errc::kShuttingDown, "the server is shutting down; try again when it is back"}; }

Error no_room(const EvictedSession& evicted) {
    return {Errc::kOverloaded, fmt::format("session '{}' needs {} MiB for its maps, and the maps in use leave less of "
                                           "the memory for maps; try again later, or raise the server's --map-memory",
                                           evicted.info.name, evicted.pages * mapping::kPageBytes >> 20)};
}

} // namespace

// Loading

void SessionRegistry::load(std::string_view name, SessionCache::Loaded on_loaded) {
    auto on_session = [this, name = std::string(name),
                       on_loaded = std::move(on_loaded)](Result<std::shared_ptr<Session>> session) {
        if (!session || *session) return on_loaded(std::move(session));
        const auto damage = damage_of(name);
        on_loaded(damage ? *damage : no_such_session(name));
    };
    if (const auto evicted = cache_.want(name, config_.clock(), std::move(on_session))) start_load(*evicted);
}

Result<std::shared_ptr<Session>> SessionRegistry::load(std::string_view name) {
    const auto promise = std::make_shared<std::promise<Result<std::shared_ptr<Session>>>>();
    auto on_loaded = promise->get_future();
    load(name, [promise](Result<std::shared_ptr<Session>> session) { promise->set_value(std::move(session)); });
    return on_loaded.get();
}

void SessionRegistry::start_load(const EvictedSession& evicted) {
    boost::asio::post(reading_, [this, wanted = Wanted{evicted, config_.clock() + kPatience}] { read(wanted); });
}

void SessionRegistry::retry_loads() {
    std::vector<Wanted> again;
    {
        const std::lock_guard lock(room_mutex_);
        again.swap(waiting_for_room_);
    }
    for (auto& wanted : again) boost::asio::post(reading_, [this, wanted = std::move(wanted)] { read(wanted); });
}

void SessionRegistry::read(const Wanted& wanted) {
    const auto& [info, pages] = wanted.evicted;
    if (draining_) return cache_.failed(info.name, shutting_down());
    if (!reserve_pages(wanted)) return;
    auto session = factory_.read(info, draining_, hurried_);
    pages_->give_back(static_cast<std::int64_t>(pages)); // the session has taken its own pages
    if (session && *session) return cache_.arrived(std::move(*session), config_.clock());
    if (session) return cache_.failed(info.name, shutting_down());
    const Error& why = session.error();
    if (log_.stats().last_error) return cache_.failed(info.name, {Errc::kStoreFailed, why.message}); // it may be intact
    const bool may_pass = why.code == Errc::kOverloaded || why.code == Errc::kStoreFailed;
    if (may_pass) return cache_.failed(info.name, why); // the next request tries again
    keep_damaged(info.name, info.id, why);
    cache_.remove(info.name, why);
}

/// Takes the pages for a session. @return false if it will be retried or was refused
bool SessionRegistry::reserve_pages(const Wanted& wanted) {
    const auto& [info, pages] = wanted.evicted;
    if (pages_->take(static_cast<std::int64_t>(pages))) return true;
    if (config_.clock() >= wanted.until) {
        cache_.failed(info.name, no_room(wanted.evicted));
        return false;
    }
    {
        const std::lock_guard lock(room_mutex_);
        waiting_for_room_.push_back(wanted);
    }
    free_pages(pages);            // the end of an eviction retries it
    if (draining_) retry_loads(); // the last eviction may be over already
    return false;
}

// Eviction

void SessionRegistry::tidy() {
    if (!log_.stats().last_error) reload_failed();
    close_for_eviction(cache_.evict(config_.clock() - config_.idle_after, std::numeric_limits<std::size_t>::max()),
                       leaves_memory());
    free_pages(spare_pages()); // before scans must be refused
    retry_loads();
}

/// Returns the number of pages to keep free for growing maps, as long as there are sessions to evict.
std::size_t SessionRegistry::spare_pages() const noexcept { return static_cast<std::size_t>(pages_->total()) / 16; }

/// Evicts sessions without users until `pages` pages are free.
void SessionRegistry::free_pages(std::size_t pages) {
    const auto missing = static_cast<std::int64_t>(pages) - pages_->free();
    if (missing <= 0) return;
    close_for_eviction(cache_.evict(SessionCache::Clock::time_point::max(), static_cast<std::size_t>(missing)),
                       leaves_memory());
}

void SessionRegistry::close_for_eviction(std::vector<std::shared_ptr<Session>> sessions, const Error& why) {
    for (const auto& session : sessions) session->close(why, [this, session] { on_evicted(*session); });
}

void SessionRegistry::on_evicted(const Session& session) {
    auto summary = summary_of(*session.snapshot());
    boost::asio::post(may_wait_, [this, pages = summary.pages] { trim_heap(pages); });
    const auto wanted = cache_.arrived(session.info().name, std::move(summary));
    if (wanted) start_load(*wanted);
    retry_loads();
}

/// Reloads all failed sessions. Called each time, because a session may notice its failure only after the store was
/// opened again.
void SessionRegistry::reload_failed() {
    auto failed = cache_.evict_failed();
    std::vector<std::string> names;
    for (const auto& session : failed) names.push_back(session->info().name);
    close_for_eviction(std::move(failed),
                       {Errc::kShuttingDown, "the session is reloaded from the store; connect again"});
    for (const auto& name : names) load(name, [](const Result<std::shared_ptr<Session>>&) {});
}

} // namespace scanloom::session
