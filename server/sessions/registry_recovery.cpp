#include "server/sessions/registry_recovery.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/odometry_copy.hpp"
#include "server/sessions/registry_state.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <latch>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

/// Decodes the record of a stored session.
/// @param name  set to the session's name if the record can be decoded, even if an error is returned
Result<SessionInfo> recorded(const store::StoredSession& stored, std::string& name) {
    if (!stored.record) return stored.record.error();
    const auto record = wire::decode_session(*stored.record);
    if (!record) return record.error();
    name = record->name;
    if (stored.damage) return *stored.damage;
    const auto config = mapping::resolve(record->options);
    if (!config) return config.error();
    const auto chunks_max = record->chunks_max == 0 ? SessionLimits::kMost : record->chunks_max;
    SessionInfo info{stored.id,          name,
                     record->created,    *config,
                     record->created_by, std::min<std::size_t>(chunks_max, SessionLimits::kMost)};
    if (record->replaces == 0)
        info.entries_at_creation = record->entries_at_creation; // a copy that is left is complete
    return info;
}

/// Returns the error for the second session of a name, which only a fault can have stored. The older one is served.
Error second_of_a_name(const std::string& name) {
    return {Errc::kConflict,
            fmt::format("the store holds a second session '{}'; delete this one, or delete the other and restart the "
                        "server to be served this one",
                        name)};
}

/// Decodes the records of all stored sessions. Adds those that cannot be served to the damaged sessions.
std::vector<SessionInfo> recorded_sessions(const std::vector<store::StoredSession>& stored, DamagedSessions& damaged) {
    std::vector<SessionInfo> found;
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
bool try_add_evicted(RegistryState& state, SessionInfo info) {
    auto summary = read_summary(state.log, info.id, info.config);
    const bool is_usable = summary && *summary && (*summary)->facts->revision >= info.entries_at_creation;
    if (!is_usable) return false; // loading it gives the reason
    info.exclusions = (*summary)->facts->exclusions;
    state.cache.add(std::move(info), std::move(**summary));
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

void recover_one(RegistryState& state, const SessionInfo& info, std::function<void()> done) {
    if (state.draining) return done(); // the next start replays the rest
    if (try_add_evicted(state, info)) return done();
    auto session = state.factory.read(info, state.draining, state.finish_early);
    if (session && *session) return add_recovered(state, std::move(*session), std::move(done));
    if (!session && session.error().code != Errc::kGone) state.damaged.add(info.name, info.id, session.error());
    done();
}

/// Adds a session of a shared log without its maps, with the facts of its last checkpoint. Its owner may be writing it.
void add_shared(RegistryState& state, SessionInfo info, const store::SharedSession& shared) {
    auto checkpointed = read_checkpointed_summary(state.log, info.id, info.config);
    Summary summary;
    if (checkpointed && *checkpointed) summary = std::move(**checkpointed);
    mapping::Snapshot facts{.config = info.config};
    if (summary.facts) facts = *summary.facts;
    facts.revision = shared.end;
    info.exclusions = facts.exclusions;
    summary.facts = std::make_shared<const mapping::Snapshot>(std::move(facts));
    state.cache.add(std::move(info), std::move(summary), shared);
}

/// Calls `recover` for each session, on the threads that compute, and waits for the ends.
void for_each_session(RegistryState& state, const std::vector<SessionInfo>& sessions,
                      const std::function<void(const SessionInfo&, std::function<void()> done)>& recover) {
    const auto done = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(sessions.size()));
    for (const auto& session : sessions) {
        boost::asio::post(state.config.compute,
                          [&recover, &session, done] { recover(session, [done] { done->count_down(); }); });
    }
    done->wait();
}

Result<> add_all_shared(RegistryState& state, const std::vector<SessionInfo>& found) {
    auto list = state.log.shared()->list();
    if (!list) return list.error();
    for_each_session(state, found, [&](const SessionInfo& info, const std::function<void()>& done) {
        const auto shared = list->sessions.find(info.id);
        if (shared != list->sessions.end()) add_shared(state, info, shared->second);
        done();
    });
    state.nodes.replace(std::move(list->nodes));
    return {};
}

} // namespace

Result<> recover_sessions(RegistryState& state) {
    auto all = state.log.sessions();
    if (!all) return all.error();
    if (state.log.shared() != nullptr) {
        return add_all_shared(state, recorded_sessions(without_copies(std::move(*all)), state.damaged));
    }
    const auto stored = settle_copies(state.log, std::move(*all));
    if (!stored) return stored.error();
    const auto found = recorded_sessions(*stored, state.damaged);
    for_each_session(state, found, [&](const SessionInfo& info, std::function<void()> done) {
        recover_one(state, info, std::move(done));
    });
    return {};
}

Result<> discover(RegistryState& state, std::string_view name) {
    auto* const shared = state.log.shared();
    if (shared == nullptr) return no_such_session(name);
    const auto found = shared->find(name);
    if (!found) return found.error();
    if (!*found) return no_such_session(name);
    for (auto& info : recorded_sessions({(*found)->stored}, state.damaged)) {
        add_shared(state, std::move(info), (*found)->shared);
    }
    return {};
}

Result<std::vector<std::shared_ptr<Session>>> discover_all(RegistryState& state) {
    std::vector<std::shared_ptr<Session>> lost;
    auto* const shared = state.log.shared();
    if (shared == nullptr) return lost;
    const auto asked = state.config.clock();
    auto list = shared->list();
    if (!list) return list.error();
    auto followed = state.cache.follow(list->sessions, asked);
    lost = std::move(followed.lost);
    state.nodes.replace(std::move(list->nodes));
    std::erase_if(followed.unknown, [&](store::SessionId id) { return state.damaged.contains(id); });
    if (followed.unknown.empty()) return lost;
    auto stored = state.log.sessions();
    if (!stored) return lost; // found the next time
    std::erase_if(*stored, [&](const store::StoredSession& one) { return !followed.unknown.contains(one.id); });
    for (auto& info : recorded_sessions(*stored, state.damaged)) {
        const auto id = info.id;
        add_shared(state, std::move(info), list->sessions[id]);
    }
    return lost;
}

} // namespace scanloom::sessions
