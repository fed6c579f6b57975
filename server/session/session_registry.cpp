#include "server/session/session_registry.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "server/mapping/reach.hpp"
#include "server/session/checkpoint.hpp"

#include <malloc.h>

#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

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

/// Whether a map fits into a session.
Result<> check_patches(const mapping::MapConfig& config, const std::vector<MapPatch>& patches, const Maker& maker) {
    if (patches.empty()) return Error{Errc::kInvalidField, "the map has no cells"};
    grid::CellBox cells;
    for (const auto& patch : patches) {
        const auto reach = mapping::reach_of(config, patch);
        if (auto ok = mapping::check_work(reach); !ok) return ok;
        cells.include(reach.cells);
    }
    if (mapping::chunk_count_of(cells) <= static_cast<std::int64_t>(maker.limits.chunks_max)) return {};
    const auto whose = maker.limits.chunks_max == SessionLimits::kMost
                           ? std::string("a session can have")
                           : fmt::format("the limit `cells` of the token '{}' allows", maker.token);
    return Error{Errc::kFull, fmt::format("the map has {} x {} cells of {} metres, more than {}; use larger cells",
                                          cells.width(), cells.height(), config.cell_size, whose)};
}

/// What the store keeps of a new session.
wire::SessionRecord record_of(std::string_view name, double created, const mapping::MapConfig& config,
                              const Maker& maker) {
    wire::SessionRecord record{std::string(name), created, mapping::options_of(config)};
    record.created_by = maker.token;
    record.chunks_max = maker.limits.chunks_max == SessionLimits::kMost ? 0 : maker.limits.chunks_max;
    return record;
}

SessionLimits limits_in(const wire::SessionRecord& record) {
    if (record.chunks_max == 0) return {};
    return {std::min<std::size_t>(record.chunks_max, SessionLimits::kMost)};
}

/// Errors  kOverloaded: the memory ran out.
Result<mapping::Projection> woven(const mapping::MapConfig& config, const std::vector<MapPatch>& patches) {
    try {
        mapping::Projection projection(config);
        for (const auto& patch : patches) {
            if (auto folded = projection.fold(patch); !folded) return folded.error();
        }
        static_cast<void>(projection.snapshot()); // the classes are made here
        return projection;
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left for this map; use larger cells"};
    }
}

Result<> append_and_wait(store::ScanLog& log, store::SessionId id, Revision revision, const MapPatch& patch) {
    std::promise<Result<>> appended;
    log.append(id, revision, {wire::encode_entry(patch)}, [&](Result<> done) { appended.set_value(std::move(done)); });
    return appended.get_future().get();
}

} // namespace

SessionRegistry::SessionRegistry(store::ScanLog& log, boost::asio::any_io_executor compute, std::function<double()> now,
                                 std::optional<boost::asio::any_io_executor> may_wait)
    : log_(log), compute_(compute), may_wait_(may_wait.value_or(compute)), now_(std::move(now)) {}

Result<> SessionRegistry::recover() {
    const auto stored = log_.sessions();
    if (!stored) return stored.error();
    const std::lock_guard changing(changing_); // drain() waits
    const auto done = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(stored->size()));
    for (const auto& session : *stored) {
        boost::asio::post(compute_, [this, &session, done] {
            recover_one(session);
            done->count_down();
        });
    }
    done->wait();
    return {};
}

void SessionRegistry::recover_one(const store::StoredSession& stored) {
    if (draining_) return; // told to stop meanwhile: what is not woven now will be at the next start
    std::string name = fmt::format("#{}", stored.id); // until its record has told
    auto session = weave(stored, name);
    if (!session && session.error().code == Errc::kGone) { // nobody was told that it exists
        spdlog::warn("session '{}' is removed: {}", name, session.error().message);
        if (log_.remove_session(stored.id)) return;
    }
    const std::unique_lock lock(mutex_);
    if (session && *session) {
        keep_recovered(std::move(*session));
    } else if (!session) {
        spdlog::error("session '{}' cannot be recovered: {}", name, session.error().message);
        damaged_[name] = {stored.id, session.error()};
    }
}

/// Of two with one name, which only a fault can have stored, the older is served and the other kept aside.
/// Pre  mutex_ is held.
void SessionRegistry::keep_recovered(std::shared_ptr<Session> session) {
    const std::string name = session->info().name;
    auto& served = sessions_[name];
    if (!served || session->info().id < served->info().id) std::swap(served, session);
    if (!session) return;
    const auto id = session->info().id;
    const Error why{Errc::kConflict,
                    fmt::format("the store holds a second session '{}'; delete this one, or delete the other and "
                                "restart the server to be served this one",
                                name)};
    damaged_[fmt::format("{}#{}", name, id)] = {id, why};
    spdlog::error("session '{}#{}' is not served: {}", name, id, why.message);
}

/// @return nothing when told to stop before its end.
Result<std::shared_ptr<Session>> SessionRegistry::weave(const store::StoredSession& stored, std::string& name) {
    if (!stored.record) return stored.record.error();
    const auto record = wire::decode_session(*stored.record);
    if (!record) return record.error();
    name = record->name;
    if (stored.damage) return *stored.damage;
    const auto config = mapping::resolve(record->options);
    if (!config) return config.error();
    auto recovered = session::recover(log_, stored.id, *config, draining_);
    if (!recovered) return recovered.error();
    if (recovered->checkpoint_rejected) {
        spdlog::warn("session '{}': its checkpoint cannot be used ({}); it was woven from its whole log", name,
                     recovered->checkpoint_rejected->message);
    }
    if (recovered->complete && recovered->projection.revision() < record->map_patches) {
        return Error{Errc::kGone, fmt::format("its import came to {} of {} parts before a crash",
                                              recovered->projection.revision(), record->map_patches)};
    }
    if (!recovered->complete) {
        keep_progress(stored.id, name, *recovered);
        return std::shared_ptr<Session>();
    }
    return std::make_shared<Session>(SessionInfo{stored.id, name, record->created, *config, record->created_by},
                                     std::move(recovered->projection), recovered->checkpointed, log_, compute_,
                                     counters_, limits_in(*record), may_wait_);
}

/// A long recovery that is stopped again and again should come to its end all the same.
void SessionRegistry::keep_progress(store::SessionId id, const std::string& name, Recovered& recovered) {
    if (recovered.projection.revision() <= recovered.checkpointed.value_or(0)) return; // there is none
    const auto snapshot = recovered.projection.snapshot();
    const auto written =
        write_checkpoint(log_, id, snapshot, recovered.projection.state(), recovered.checkpointed, hurried_);
    spdlog::info("session '{}': recovery stopped after entry {}{}", name, snapshot.revision,
                 written ? "; the next start continues there" : "");
}

Error no_such_session(std::string_view name) {
    if (!is_valid_name(name)) return {Errc::kNotFound, "there is no session of that name; see the list of sessions"};
    return {Errc::kNotFound, fmt::format("there is no session '{}'; see the list of sessions", name)};
}

std::shared_ptr<Session> SessionRegistry::find(std::string_view name) const {
    const std::shared_lock lock(mutex_);
    const auto found = sessions_.find(name);
    return found == sessions_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<Session>> SessionRegistry::list() const {
    const std::shared_lock lock(mutex_);
    std::vector<std::shared_ptr<Session>> sessions;
    sessions.reserve(sessions_.size());
    for (const auto& [name, session] : sessions_) sessions.push_back(session);
    return sessions;
}

std::map<std::string, Error> SessionRegistry::damaged() const {
    const std::shared_lock lock(mutex_);
    std::map<std::string, Error> reasons;
    for (const auto& [name, damaged] : damaged_) reasons.emplace(name, damaged.error);
    return reasons;
}

Result<> SessionRegistry::check_new(std::string_view name, const Maker& maker) const {
    if (draining_)
        return Error{Errc::kShuttingDown,
                     "the server is shutting down and makes no new sessions; try again when it is back"};
    const std::shared_lock lock(mutex_);
    if (sessions_.contains(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists already; choose another name or delete it first", name)};
    }
    if (damaged_.contains(name)) {
        return Error{Errc::kAlreadyExists,
                     fmt::format("session '{}' exists but is damaged; delete it first or choose another name", name)};
    }
    if (maker.token.empty()) return {};
    const auto made = static_cast<std::size_t>(std::ranges::count_if(
        sessions_, [&](const auto& entry) { return entry.second->info().created_by == maker.token; }));
    if (made < maker.sessions_max) return {};
    return Error{Errc::kFull, fmt::format("there are {} sessions that were made with the token '{}', the most that its "
                                          "limit `sessions` allows; delete one, or have the limit raised",
                                          made, maker.token)};
}

std::shared_ptr<Session> SessionRegistry::add(SessionInfo info, mapping::Projection projection,
                                              const SessionLimits& limits) {
    auto session = std::make_shared<Session>(std::move(info), std::move(projection), 0, log_, compute_, counters_,
                                             limits, may_wait_);
    const std::unique_lock lock(mutex_);
    sessions_.emplace(session->info().name, session);
    return session;
}

Result<std::shared_ptr<Session>> SessionRegistry::create(std::string_view name, const SessionOptions& options,
                                                         const Maker& maker) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, maker); !is_new) return is_new.error();
    const auto record = record_of(name, now_(), *config, maker);
    const auto id = log_.create_session(wire::encode_session(record));
    if (!id) return id.error();
    return add({*id, record.name, record.created, *config, maker.token}, mapping::Projection(*config), maker.limits);
}

Result<std::shared_ptr<Session>> SessionRegistry::import_map(std::string_view name, const SessionOptions& options,
                                                             const std::vector<MapPatch>& patches, const Maker& maker) {
    if (auto ok = check_name(name); !ok) return ok.error();
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    if (auto ok = check_patches(*config, patches, maker); !ok) return ok.error();
    // Before anything is stored, and before others have to wait: it takes seconds, and the memory may run out.
    auto projection = woven(*config, patches);
    if (!projection) return projection.error();

    const std::lock_guard changing(changing_);
    if (auto is_new = check_new(name, maker); !is_new) return is_new.error();
    auto record = record_of(name, now_(), *config, maker);
    record.map_patches = static_cast<std::uint32_t>(patches.size());
    const auto id = log_.create_session(wire::encode_session(record));
    if (!id) return id.error();
    for (std::size_t n = 0; n < patches.size(); ++n) {
        const auto imported = append_and_wait(log_, *id, n + 1, patches[n]);
        if (imported) continue;
        static_cast<void>(log_.remove_session(*id)); // if that fails, too, the next start does it
        return imported.error();
    }
    return add({*id, record.name, record.created, *config, maker.token}, std::move(*projection), maker.limits);
}

Result<> SessionRegistry::remove(std::string_view name) {
    const std::lock_guard changing(changing_);
    store::SessionId id = 0;
    if (const auto session = find(name)) {
        id = session->info().id;
        const auto closed = std::make_shared<std::promise<void>>();
        auto is_closed = closed->get_future();
        session->discard({Errc::kGone, fmt::format("session '{}' was deleted", name)},
                         [closed] { closed->set_value(); });
        is_closed.wait();
    } else {
        const std::shared_lock lock(mutex_);
        const auto damaged = damaged_.find(name);
        if (damaged == damaged_.end()) return no_such_session(name);
        id = damaged->second.id;
    }
    if (auto removed = log_.remove_session(id); !removed) return removed.error();
    if (auto session = forget(name)) {
        freed_chunks_ += session->snapshot()->chunk_count;
        session.reset();
        give_back_memory();
    }
    return {};
}

/// To the system, from time to time: the allocator keeps what lies between other things, and of each thread the most it
/// ever had.
void SessionRegistry::give_back_memory() {
    constexpr std::size_t kWorthwhile = 4096; // chunks: 84 MB
    if (freed_chunks_ < kWorthwhile) return;
    freed_chunks_ = 0;
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

/// @return the session, which goes with the last who holds it.
std::shared_ptr<Session> SessionRegistry::forget(std::string_view name) {
    const std::unique_lock lock(mutex_);
    if (const auto damaged = damaged_.find(name); damaged != damaged_.end()) damaged_.erase(damaged);
    const auto known = sessions_.find(name);
    if (known == sessions_.end()) return nullptr;
    auto session = std::move(known->second);
    sessions_.erase(known);
    return session;
}

void SessionRegistry::drain() {
    draining_ = true; // recover() gives up
    const std::lock_guard changing(changing_);
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
    for (const auto& session : list()) session->hurry();
}

} // namespace scanloom::session
