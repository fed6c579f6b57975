#include "server/sessions/session_registry.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/sessions/imported_map.hpp"

#include <malloc.h>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <future>
#include <latch>

namespace scanloom::session {
namespace {

Result<> check_name(std::string_view name) {
    if (is_valid_name(name)) return {};
    return Error{
        Errc::kInvalidField,
        fmt::format("name is not a valid session name; use 1 to {} characters of A-Z a-z 0-9 _ -", kNameBytesMax)};
}

/// Returns the record of a new session.
wire::SessionRecord record_of(std::string_view name, double created, const mapping::MapConfig& config,
                              const Creator& creator) {
    wire::SessionRecord record{std::string(name), created, mapping::options_of(config)};
    record.created_by = creator.token;
    record.chunks_max = creator.chunks_max == SessionLimits::kMost ? 0 : creator.chunks_max;
    return record;
}

} // namespace

SessionRegistry::SessionRegistry(store::ScanLog& log, RegistryConfig config)
    : log_(log), config_(std::move(config)), may_wait_(config_.may_wait.value_or(config_.compute)),
      reading_(config_.reading.value_or(config_.compute)),
      pages_(std::make_shared<limits::MemoryBudget>(config_.pages_max)), factory_{log_, config_.compute, may_wait_} {
    factory_.limits.shared = {pages_};
    factory_.limits.on_short = [this](std::size_t pages) {
        boost::asio::post(may_wait_, [this, pages] { free_pages(pages + spare_pages()); });
    };
}

Error no_such_session(std::string_view name) {
    if (!is_valid_name(name)) return {Errc::kNotFound, "there is no session of that name; see the list of sessions"};
    return {Errc::kNotFound, fmt::format("there is no session '{}'; see the list of sessions", name)};
}

std::shared_ptr<Session> SessionRegistry::find(std::string_view name) const {
    return cache_.find(name, config_.clock());
}

std::map<std::string, Error> SessionRegistry::damaged() const {
    const std::shared_lock lock(damaged_mutex_);
    std::map<std::string, Error> reasons;
    for (const auto& [name, damaged] : damaged_) reasons.emplace(name, damaged.error);
    return reasons;
}

std::optional<Error> SessionRegistry::damage_of(std::string_view name) const {
    const std::shared_lock lock(damaged_mutex_);
    const auto found = damaged_.find(name);
    return found == damaged_.end() ? std::nullopt : std::optional(found->second.error);
}

void SessionRegistry::keep_damaged(std::string name, store::SessionId id, Error why) {
    if (why.code == Errc::kStoreFailed) { // it is not retried before the next start
        why = {Errc::kDataLoss, why.message + "; if its disk is readable again, restart the server"};
    }
    log::error({.session = name}, "session '{}' cannot be recovered: {}", name, why.message);
    const std::unique_lock lock(damaged_mutex_);
    damaged_[std::move(name)] = {id, std::move(why)};
}

Result<> SessionRegistry::check_new(std::string_view name, const Creator& creator) const {
    if (draining_)
        return Error{Errc::kShuttingDown,
                     "the server is shutting down and makes no new sessions; try again when it is back"};
    if (cache_.contains(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists already; choose another name or delete it first", name)};
    }
    if (damage_of(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists but is damaged; delete it first or choose another name", name)};
    }
    if (creator.token.empty()) return {};
    const auto made = static_cast<std::size_t>(std::ranges::count_if(
        cache_.all(), [&](const ListedSession& listed) { return listed.info.created_by == creator.token; }));
    if (made < creator.sessions_max) return {};
    return Error{Errc::kFull, fmt::format("there are {} sessions that were created with the token '{}', the most that "
                                          "its limit `sessions` allows; delete one, or raise the limit",
                                          made, creator.token)};
}

std::shared_ptr<Session> SessionRegistry::add(SessionInfo info, mapping::Projection projection) {
    auto session = factory_.make(std::move(info), std::move(projection), 0);
    cache_.add(session, config_.clock());
    return session;
}

Result<std::shared_ptr<Session>> SessionRegistry::create(std::string_view name, const SessionOptions& options,
                                                         const Creator& creator) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, creator); !is_new) return is_new.error();
    const auto record = record_of(name, config_.now(), *config, creator);
    const auto id = log_.create_session(wire::encode_session(record));
    if (!id) return id.error();
    return add({*id, record.name, record.created, *config, creator.token, creator.chunks_max},
               mapping::Projection(*config));
}

Result<std::shared_ptr<Session>> SessionRegistry::import_map(std::string_view name, const SessionOptions& options,
                                                             const std::vector<MapPatch>& patches,
                                                             const Creator& creator) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    // Done before the lock and before anything is stored, because it takes seconds and may run out of memory.
    limits::MemoryShare share({pages_});
    auto projection = integrate_imported(*config, patches, creator, share);
    if (!projection) {
        share.give_back_all();
        if (projection.error().code == Errc::kOverloaded) {
            const std::size_t pages = pages_of_imported(*config, patches);
            free_pages(pages);
            trim_heap(pages); // of the patches that were integrated
        }
        return projection.error();
    }

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, creator); !is_new) return is_new.error();
    auto record = record_of(name, config_.now(), *config, creator);
    record.map_patches = static_cast<std::uint32_t>(patches.size());
    const auto id = log_.create_session(wire::encode_session(record));
    if (!id) return id.error();
    for (std::size_t n = 0; n < patches.size(); ++n) {
        const auto imported = store::append_and_wait(log_, *id, n + 1, {wire::encode_entry(patches[n])});
        if (imported) continue;
        static_cast<void>(log_.remove_session(*id)); // if this fails, the next start removes it
        return imported.error();
    }
    share.give_back_all(); // the session takes its pages itself
    return add({*id, record.name, record.created, *config, creator.token, creator.chunks_max}, std::move(*projection));
}

Result<> SessionRegistry::remove(std::string_view name) {
    const std::lock_guard changing(changing_);
    auto left = cache_.leave(name);
    if (!left) {
        const std::unique_lock lock(damaged_mutex_);
        const auto damaged = damaged_.find(name);
        if (damaged == damaged_.end()) return no_such_session(name);
        if (auto removed = log_.remove_session(damaged->second.id); !removed) return removed.error();
        damaged_.erase(damaged);
        return {};
    }
    const Error gone{Errc::kGone, fmt::format("session '{}' was deleted", name)};
    if (left->session) {
        const auto closed = std::make_shared<std::promise<void>>();
        auto is_closed = closed->get_future();
        left->session->discard(gone, [closed] { closed->set_value(); });
        is_closed.wait();
    }
    const auto summary = left->session ? summary_of(*left->session->snapshot()) : left->summary;
    if (auto removed = log_.remove_session(left->info.id); !removed) { // it still exists, closed
        if (const auto wanted = cache_.arrived(left->info.name, summary)) start_load(*wanted);
        return removed.error();
    }
    cache_.remove(name, no_such_session(name));
    left.reset(); // frees the maps, unless the strand still holds the session
    boost::asio::post(may_wait_, [this, pages = summary.pages] { trim_heap(pages); });
    return {};
}

/// Returns free memory to the system after `pages` were freed, but not each time. The allocator keeps free memory
/// between used blocks, and for each thread as much as it ever used.
void SessionRegistry::trim_heap(std::size_t pages) {
    constexpr std::size_t kWorthwhile = 4096; // 80 MiB
    {
        const std::lock_guard lock(room_mutex_);
        freed_pages_ += pages;
        if (freed_pages_ < kWorthwhile) return;
        freed_pages_ = 0;
    }
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void SessionRegistry::drain() {
    draining_ = true; // stops recover() and loads
    retry_loads();    // the thread that holds the mutex may wait for one of these loads
    const std::lock_guard changing(changing_);
    retry_loads();
    cache_.settle();
    const auto sessions = list();
    const auto closed = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(sessions.size()));
    for (const auto& session : sessions) {
        session->close({Errc::kShuttingDown, "the server is shutting down; connect again when it is back"},
                       [closed] { closed->count_down(); });
    }
    closed->wait();
}

void SessionRegistry::hurry() {
    hurried_ = true;
    for (const auto& listed : cache_.all()) {
        if (listed.session) listed.session->hurry();
    }
}

} // namespace scanloom::session
