#include "server/sessions/session_registry.hpp"

#include "common/limits/memory_budget.hpp"
#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"
#include "server/sessions/imported_map.hpp"
#include "server/sessions/odometry_copy.hpp"
#include "server/sessions/registry_recovery.hpp"
#include "server/store/shared_sessions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <latch>
#include <new>
#include <semaphore>
#include <utility>

namespace scanloom::sessions {
namespace {

/// Sessions that are closed at the same time when a server drains that shares the log: about as many as other servers
/// load at the same time. The others go on until it is their turn, so that each is without acknowledgements for a short
/// time only.
constexpr std::ptrdiff_t kHandedOverAtOnce = 4;

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

Result<> check_room(const SessionInfo& info) {
    if (info.exclusions->count_in_effect() < Exclusions::kMost) return {};
    return Error{Errc::kFull, fmt::format("session '{}' has {} exclusions in effect, the limit; lift some, "
                                          "or exclude larger ranges",
                                          info.name, Exclusions::kMost)};
}

} // namespace

Result<> SessionRegistry::recover() {
    const std::lock_guard changing(changing_); // drain() waits for it
    return recover_sessions(state_);
}

std::shared_ptr<Session> SessionRegistry::find(std::string_view name) const {
    return state_.cache.find(name, state_.config.clock());
}

Result<std::shared_ptr<Session>> SessionRegistry::load(std::string_view name) {
    const auto promise = std::make_shared<std::promise<Result<std::shared_ptr<Session>>>>();
    auto on_loaded = promise->get_future();
    load(name, [promise](Result<std::shared_ptr<Session>> session) { promise->set_value(std::move(session)); });
    return on_loaded.get();
}

/// Loads a session of a shared log: what the cache says of one that is not in memory may have changed on another
/// server.
/// @return the session, which is not evicted while it is held; null: one server alone uses the log
Result<std::shared_ptr<Session>> SessionRegistry::load_shared(std::string_view name) {
    if (state_.log.shared() == nullptr) return std::shared_ptr<Session>();
    return load(name);
}

Result<> SessionRegistry::check_new(std::string_view name, const Creator& creator) const {
    if (state_.draining)
        return Error{Errc::kShuttingDown,
                     "the server is shutting down and makes no new sessions; try again when it is back"};
    if (state_.cache.contains(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists already; choose another name or delete it first", name)};
    }
    if (state_.damaged.find(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists but is damaged; delete it first or choose another name", name)};
    }
    if (creator.token.empty()) return {};
    const auto made = static_cast<std::size_t>(std::ranges::count_if(
        state_.cache.all(), [&](const ListedSession& listed) { return listed.info.created_by == creator.token; }));
    if (made < creator.sessions_max) return {};
    return Error{Errc::kFull, fmt::format("there are {} sessions that were created with the token '{}', the most that "
                                          "its limit `sessions` allows; delete one, or raise the limit",
                                          made, creator.token)};
}

/// Appends an entry to the log of a session that is being created. Removes the session if that fails.
Result<> SessionRegistry::append_first(store::SessionId session, Revision revision, const LogEntry& entry) {
    auto appended = store::append_and_wait(state_.log, session, revision, {wire::encode_entry(entry)});
    if (!appended) static_cast<void>(state_.log.remove_session(session)); // if this fails, the next start removes it
    return appended;
}

Result<std::shared_ptr<Session>> SessionRegistry::add(SessionInfo info, mapping::Projection projection,
                                                      bool is_localize_only) {
    if (is_localize_only) {
        const ModeChanged mode{true};
        if (auto appended = append_first(info.id, projection.revision() + 1, mode); !appended) return appended.error();
        if (auto applied = projection.apply(mode); !applied) return applied.error();
    }
    auto session = state_.factory.make(std::move(info), std::move(projection), 0);
    state_.cache.add(session, state_.config.clock());
    return session;
}

Result<std::shared_ptr<Session>> SessionRegistry::create(std::string_view name, const SessionOptions& options,
                                                         const Creator& creator, bool is_localize_only) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, creator); !is_new) return is_new.error();
    auto record = record_of(name, state_.config.now(), *config, creator);
    record.entries_at_creation = is_localize_only ? 1 : 0;
    const SessionCache::Reservation reserved(state_.cache, record.name);
    const auto id = state_.log.create_session(wire::encode_session(record));
    if (!id) return id.error();
    return add({*id, record.name, record.created, *config, creator.token, creator.chunks_max},
               mapping::Projection(*config), is_localize_only);
}

Result<std::shared_ptr<Session>> SessionRegistry::import_map(std::string_view name, const SessionOptions& options,
                                                             const std::vector<MapPatch>& patches,
                                                             const Creator& creator, bool is_localize_only) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    // Done before the lock and before anything is stored, because it takes seconds and may run out of memory.
    limits::MemoryShare share({state_.pages});
    auto projection = integrate_imported(*config, patches, creator, share);
    if (!projection) {
        share.give_back_all();
        if (projection.error().code == Errc::kOverloaded) {
            const std::size_t pages = pages_of_imported(*config, patches);
            loader_.free_pages(pages);
            loader_.trim_heap(pages); // of the patches that were integrated
        }
        return projection.error();
    }

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, creator); !is_new) return is_new.error();
    auto record = record_of(name, state_.config.now(), *config, creator);
    record.entries_at_creation = static_cast<std::uint32_t>(patches.size()) + (is_localize_only ? 1 : 0);
    const SessionCache::Reservation reserved(state_.cache, record.name);
    const auto id = state_.log.create_session(wire::encode_session(record));
    if (!id) return id.error();
    for (std::size_t n = 0; n < patches.size(); ++n) {
        if (auto imported = append_first(*id, n + 1, patches[n]); !imported) return imported.error();
    }
    share.give_back_all(); // the session takes its pages itself
    return add({*id, record.name, record.created, *config, creator.token, creator.chunks_max}, std::move(*projection),
               is_localize_only);
}

Result<> SessionRegistry::remove(std::string_view name) {
    const std::lock_guard changing(changing_);
    if (!state_.cache.contains(name)) static_cast<void>(discover(state_, name));
    auto left = state_.cache.begin_change(name);
    if (!left) return state_.damaged.remove(name, state_.log);
    if (auto owned = store::own(state_.log, left->info.id); !owned) {
        loader_.load(state_.cache.cancel_change(name));
        return owned;
    }
    const Error gone{Errc::kGone, fmt::format("session '{}' was deleted", name)};
    if (left->session) discard_and_wait(*left->session, gone);
    const auto summary = left->session ? summary_of(*left->session->snapshot()) : left->summary;
    auto removed = remove_copies(state_.log, left->info.id); // that failed requests have left
    if (removed) removed = state_.log.remove_session(left->info.id);
    if (!removed) { // it still exists, closed
        loader_.load(state_.cache.end_eviction(left->info.name, summary));
        return removed.error();
    }
    state_.cache.remove(name, no_such_session(name));
    left.reset(); // frees the maps, unless the strand still holds the session
    loader_.trim_heap_later(summary.pages);
    return {};
}

// Exclusions

Result<Exclusion> SessionRegistry::exclude(std::string_view name, RobotIndex robot,
                                           const std::variant<StampRange, SeqRange>& scans) {
    ScansExcluded excluded{0, robot, scans};
    const auto since = change_exclusions(name, [&](const SessionInfo& info) -> Result<LogEntry> {
        if (auto room = check_room(info); !room) return room.error();
        const auto& known = info.exclusions->all();
        excluded.id = known.empty() ? 1 : known.back().excluded.id + 1;
        return LogEntry(excluded);
    });
    if (!since) return since.error();
    log::info({.session = name}, "session '{}': exclusion {} was added; its maps are computed again", name,
              excluded.id);
    return Exclusion{excluded, *since};
}

Result<> SessionRegistry::lift_exclusion(std::string_view name, std::uint64_t id) {
    const ExclusionLifted lifted{id};
    const auto since = change_exclusions(name, [&](const SessionInfo& info) -> Result<LogEntry> {
        if (info.exclusions->check(lifted)) return LogEntry(lifted);
        return Error{Errc::kNotFound,
                     fmt::format("session '{}' has no exclusion {} in effect; GET .../exclusions lists "
                                 "those that it has",
                                 info.name, id)};
    });
    if (!since) return since.error();
    log::info({.session = name}, "session '{}': exclusion {} was lifted; its maps are computed again", name, id);
    return {};
}

/// Appends the entry while the session is closed, so that no other thread writes to its log. Its maps are computed
/// again when the next client or robot asks for it. @return the entry's revision
Result<Revision> SessionRegistry::change_exclusions(std::string_view name, const MakeEntry& make) {
    const std::lock_guard changing(changing_);
    if (state_.draining) return shutting_down();
    const auto used = load_shared(name);
    if (!used) return used.error();
    auto left = state_.cache.begin_change(name);
    if (!left) return state_.why_missing(name);
    const auto stay = [&](Error why) {
        loader_.load(state_.cache.cancel_change(name));
        return why;
    };
    try {
        const auto entry = make(left->info);
        if (!entry) return stay(entry.error());
        if (left->session) left->summary = summary_of(*left->session->snapshot());
        auto facts = std::make_shared<mapping::Snapshot>(*left->summary.facts);
        auto exclusions = std::make_shared<Exclusions>(*left->info.exclusions);
        std::vector<std::string> bytes = {wire::encode_entry(*entry)};
        if (left->session) discard_and_wait(*left->session, maps_are_computed_again(left->info.name));
        const auto end = state_.log.end_of(left->info.id);
        const auto appended =
            end ? store::append_and_wait(state_.log, left->info.id, *end + 1, std::move(bytes)) : Result<>(end.error());
        if (appended) { // the summary until the session is loaded again
            facts->revision = *end + 1;
            if (const auto* excluded = std::get_if<ScansExcluded>(&*entry)) {
                static_cast<void>(exclusions->add(*end + 1, *excluded));
            } else {
                static_cast<void>(exclusions->add(*end + 1, std::get<ExclusionLifted>(*entry)));
            }
            facts->exclusions = exclusions;
            left->summary.facts = facts;
        }
        loader_.load(state_.cache.end_eviction(left->info.name, left->summary));
        if (!appended) return appended.error();
        return *end + 1;
    } catch (const std::bad_alloc&) {
        if (left->session && left->session->closing()) { // it is closed and must be loaded again
            loader_.load(state_.cache.end_eviction(left->info.name, left->summary));
            return Error{Errc::kOverloaded, "there is no memory left for this; try again later"};
        }
        return stay({Errc::kOverloaded, "there is no memory left for this; try again later"});
    }
}

// Shutdown

void SessionRegistry::drain() {
    state_.draining = true; // stops recover() and loads
    loader_.retry();        // the thread that holds the mutex may wait for one of these loads
    const std::lock_guard changing(changing_);
    loader_.retry();
    state_.cache.wait_for_transitions();
    const auto sessions = list();
    std::vector<std::string> names;
    for (const auto& session : sessions) names.push_back(session->info().name);
    successors_.choose(names, nodes());
    const Error comes_back{Errc::kShuttingDown, "the server is shutting down; connect again when it is back"};
    const Error another_goes_on{Errc::kNotOwner,
                                "the server is shutting down; connect to the one that goes on with the session"};
    const auto count = static_cast<std::ptrdiff_t>(sessions.size());
    const auto turns = std::make_shared<std::counting_semaphore<>>(is_shared() ? kHandedOverAtOnce : count);
    const auto closed = std::make_shared<std::latch>(count);
    for (const auto& session : sessions) {
        if (!state_.finish_early) turns->acquire();
        const bool has_successor = successors_.of(session->info().name) != nullptr;
        session->close(has_successor ? another_goes_on : comes_back, [turns, closed] {
            turns->release();
            closed->count_down();
        });
    }
    closed->wait();
}

void SessionRegistry::finish_early() {
    state_.finish_early = true;
    for (const auto& listed : state_.cache.all()) {
        if (listed.session) listed.session->finish_early();
    }
}

} // namespace scanloom::sessions
