#include "server/sessions/recovery.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "server/sessions/log_readers.hpp"
#include "server/sessions/map_correction.hpp"
#include "server/sessions/odometry_copy.hpp"
#include "server/sessions/registry_state.hpp"
#include "server/store/store_error.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <latch>
#include <set>
#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

Error stopped() { return {Errc::kShuttingDown, "stopped before the log's end"}; }

/// Not a failure: the whole log is replayed.
const Error kOutdated{Errc::kConflict,
                      "the rest of the log excludes scans that are in these maps, or brings some back"};

struct FromCheckpoint {
    localization::LocalizedProjection maps;
    bool can_be_added_to; // the next checkpoint may write only what has changed
};

Result<FromCheckpoint> read_checkpoint(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                       const std::atomic<bool>& stop) {
    CheckpointReader reader(config);
    auto read = log.read_checkpoint(session, [&](std::string_view key, std::string_view value) -> Result<> {
        if (stop) return stopped();
        return reader.add(key, value);
    });
    if (!read) return read.error();
    const bool can_be_added_to = reader.is_newest_format();
    auto maps = std::move(reader).finish();
    if (!maps) return maps.error();
    return FromCheckpoint{std::move(*maps), can_be_added_to};
}

/// Applies the entries after those that the maps contain. @return false if it was stopped before the end of the log
Result<bool> apply_rest(store::ScanLog& log, store::SessionId session, localization::LocalizedProjection& maps,
                        const std::atomic<bool>& stop) {
    const auto apply = [&](Revision revision, std::string_view bytes) -> Result<> {
        if (stop) return stopped();
        auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        if (maps.projection().is_outdated_by(*entry)) return kOutdated;
        double work = HUGE_VAL;
        const auto applied = maps.apply(*entry, work);
        return applied ? Result<>() : applied.error();
    };
    auto read = log.read(session, maps.projection().revision(), apply);
    if (read) read = correct_as_announced(log, session, maps, stop);
    if (!read && stop) return false;
    if (!read) return read.error();
    return true;
}

/// Replays the whole log, with its exclusions from the start.
Result<Recovered> recover_from_log(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                                   const std::atomic<bool>& stop) {
    auto exclusions =
        read_exclusions(log, session, [&](Revision, const std::optional<ScanPose>&) { return !stop.load(); });
    if (!exclusions) return exclusions.error();
    Recovered recovered{mapping::Projection(config, std::make_shared<const Exclusions>(std::move(*exclusions)))};
    const auto complete = stop ? Result<bool>(false) : apply_rest(log, session, recovered.maps, stop);
    if (!complete) return complete.error();
    recovered.complete = *complete;
    return recovered;
}

Result<Recovered> recover_from_checkpoint(store::ScanLog& log, store::SessionId session,
                                          const mapping::MapConfig& config, const std::atomic<bool>& stop) {
    auto checkpoint = read_checkpoint(log, session, config, stop);
    Recovered recovered{checkpoint ? std::move(checkpoint->maps)
                                   : localization::LocalizedProjection(mapping::Projection(config))};
    if (!checkpoint && checkpoint.error() == stopped()) {
        recovered.complete = false;
        return recovered;
    }
    if (!checkpoint) {
        recovered.checkpoint_rejected = checkpoint.error();
    } else if (checkpoint->can_be_added_to) {
        recovered.checkpointed = recovered.maps.projection().revision();
    }
    const auto complete = apply_rest(log, session, recovered.maps, stop);
    if (!complete) return complete.error();
    recovered.complete = *complete;
    if (recovered.complete && recovered.maps.projection().revision() < recovered.maps.projection().newest_restored()) {
        return Error{Errc::kDataLoss,
                     fmt::format("the log ends with entry {}, but its checkpoint holds entry {} already; the store is "
                                 "damaged; {}",
                                 recovered.maps.projection().revision(), recovered.maps.projection().newest_restored(),
                                 store::kRecoverOrRemove)};
    }
    return recovered;
}

} // namespace

Result<Recovered> recover(store::ScanLog& log, store::SessionId session, const mapping::MapConfig& config,
                          const std::atomic<bool>& stop) {
    try {
        auto recovered = recover_from_checkpoint(log, session, config, stop);
        if (recovered || recovered.error() != kOutdated) return recovered;
        return recover_from_log(log, session, config, stop); // the outdated maps are already freed
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left for its map; free some and start the server again"};
    }
}

// All sessions

namespace {

/// The contents of a session's record.
struct Recorded {
    SessionInfo info;
    std::uint32_t entries_at_creation = 0;
};

/// Decodes the record of a stored session.
/// @param name  set to the session's name if the record can be decoded, even if an error is returned
Result<Recorded> recorded(const store::StoredSession& stored, std::string& name) {
    if (!stored.record) return stored.record.error();
    const auto record = wire::decode_session(*stored.record);
    if (!record) return record.error();
    name = record->name;
    if (stored.damage) return *stored.damage;
    const auto config = mapping::resolve(record->options);
    if (!config) return config.error();
    const auto chunks_max = record->chunks_max == 0 ? SessionLimits::kMost : record->chunks_max;
    return Recorded{{stored.id, name, record->created, *config, record->created_by,
                     std::min<std::size_t>(chunks_max, SessionLimits::kMost)},
                    record->replaces == 0 ? record->entries_at_creation : 0}; // a copy that is left is complete
}

/// Returns the error for the second session of a name, which only a fault can have stored. The older one is served.
Error second_of_a_name(const std::string& name) {
    return {Errc::kConflict,
            fmt::format("the store holds a second session '{}'; delete this one, or delete the other and restart the "
                        "server to be served this one",
                        name)};
}

/// Decodes the records of all stored sessions. Adds those that cannot be served to the damaged sessions.
std::vector<Recorded> recorded_sessions(const std::vector<store::StoredSession>& stored, DamagedSessions& damaged) {
    std::vector<Recorded> found;
    std::set<std::string> names;
    for (const auto& session : stored) {
        std::string name = fmt::format("#{}", session.id); // used if its record cannot be decoded
        auto record = recorded(session, name);
        if (!record) {
            damaged.add(name, session.id, record.error());
        } else if (!names.insert(name).second) {
            damaged.add(fmt::format("{}#{}", name, session.id), session.id, second_of_a_name(name));
        } else {
            found.push_back(std::move(*record));
        }
    }
    return found;
}

/// Adds the session without its maps if its checkpoint has the facts that a list shows. @return whether it was added
bool try_add_evicted(RegistryState& state, const Recorded& session) {
    const auto& info = session.info;
    auto summary = read_summary(state.log, info.id, info.config);
    const bool is_usable = summary && *summary && (*summary)->facts->revision >= session.entries_at_creation;
    if (!is_usable) return false; // loading it gives the reason
    SessionInfo evicted = info;
    evicted.exclusions = (*summary)->facts->exclusions;
    state.cache.add(std::move(evicted), std::move(**summary));
    return true;
}

void add_recovered(RegistryState& state, std::shared_ptr<Session> session, std::function<void()> done) {
    if (state.pages->free() >= 0) {
        state.cache.add(std::move(session), state.config.clock());
        return done();
    }
    auto& recovered = *session; // the memory for maps is exceeded: evict it immediately
    recovered.close({Errc::kShuttingDown, "the session is evicted from memory"},
                    [&state, session, done = std::move(done)] {
                        state.cache.add(session->info(), summary_of(*session->snapshot()));
                        done();
                    });
}

void recover_one(RegistryState& state, const Recorded& recorded, std::function<void()> done) {
    if (state.draining) return done(); // the next start replays the rest
    if (try_add_evicted(state, recorded)) return done();
    const auto& info = recorded.info;
    auto session = state.factory.read(info, state.draining, state.finish_early);
    if (session && *session && (*session)->snapshot()->revision < recorded.entries_at_creation) {
        log::warn({.session = info.name},
                  "session '{}' is removed: its creation came to {} of {} entries before a crash", info.name,
                  (*session)->snapshot()->revision,
                  recorded.entries_at_creation); // its creation was never confirmed
        if (auto removed = state.log.remove_session(info.id); !removed) {
            state.damaged.add(info.name, info.id, removed.error());
        }
        return done();
    }
    if (session && *session) return add_recovered(state, std::move(*session), std::move(done));
    if (!session) state.damaged.add(info.name, info.id, session.error());
    done();
}

} // namespace

Result<> recover_sessions(RegistryState& state) {
    auto all = state.log.sessions();
    if (!all) return all.error();
    const auto stored = settle_copies(state.log, std::move(*all));
    if (!stored) return stored.error();
    const auto found = recorded_sessions(*stored, state.damaged);
    const auto done = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(found.size()));
    for (const auto& session : found) {
        boost::asio::post(state.config.compute,
                          [&state, &session, done] { recover_one(state, session, [done] { done->count_down(); }); });
    }
    done->wait();
    return {};
}

} // namespace scanloom::sessions
