#include "server/sessions/session_registry.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <latch>
#include <set>

/// Recovery of all sessions when the server starts.
namespace scanloom::session {
namespace {

/// The contents of a session's record.
struct Recorded {
    SessionInfo info;
    std::uint32_t map_patches = 0;
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
                    record->map_patches};
}

/// Returns the error for the second session of a name, which only a fault can have stored. The older one is served.
Error second_of_a_name(const std::string& name) {
    return {Errc::kConflict,
            fmt::format("the store holds a second session '{}'; delete this one, or delete the other and restart the "
                        "server to be served this one",
                        name)};
}

} // namespace

Result<> SessionRegistry::recover() {
    const auto stored = log_.sessions();
    if (!stored) return stored.error();
    const std::lock_guard changing(changing_); // drain() waits for it
    std::vector<Recorded> found;
    std::set<std::string> names;
    for (const auto& session : *stored) {
        std::string name = fmt::format("#{}", session.id); // used if its record cannot be decoded
        auto record = recorded(session, name);
        if (!record) {
            keep_damaged(name, session.id, record.error());
        } else if (!names.insert(name).second) {
            keep_damaged(fmt::format("{}#{}", name, session.id), session.id, second_of_a_name(name));
        } else {
            found.push_back(std::move(*record));
        }
    }
    const auto done = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(found.size()));
    for (const auto& session : found) {
        boost::asio::post(config_.compute, [this, &session, done] {
            recover_one(session.info, session.map_patches, [done] { done->count_down(); });
        });
    }
    done->wait();
    return {};
}

void SessionRegistry::recover_one(const SessionInfo& info, std::uint32_t map_patches, std::function<void()> done) {
    if (draining_) return done(); // the next start replays the rest
    if (try_add_evicted(info, map_patches)) return done();
    auto session = factory_.read(info, draining_, hurried_);
    if (session && *session && (*session)->snapshot()->revision < map_patches) {
        log::warn({.session = info.name}, "session '{}' is removed: its import came to {} of {} parts before a crash",
                  info.name, (*session)->snapshot()->revision, map_patches); // its creation was never confirmed
        if (auto removed = log_.remove_session(info.id); !removed) keep_damaged(info.name, info.id, removed.error());
        return done();
    }
    if (session && *session) return add_recovered(std::move(*session), std::move(done));
    if (!session) keep_damaged(info.name, info.id, session.error());
    done();
}

/// Adds the session without its maps if its checkpoint has the facts that a list shows. @return whether it was added
bool SessionRegistry::try_add_evicted(const SessionInfo& info, std::uint32_t map_patches) {
    auto summary = read_summary(log_, info.id, info.config);
    if (!summary || !*summary || (*summary)->facts->revision < map_patches) return false; // loading it gives the reason
    SessionInfo asleep = info;
    asleep.exclusions = (*summary)->facts->exclusions;
    cache_.add(std::move(asleep), std::move(**summary));
    return true;
}

void SessionRegistry::add_recovered(std::shared_ptr<Session> session, std::function<void()> done) {
    if (pages_->free() >= 0) {
        cache_.add(std::move(session), config_.clock());
        return done();
    }
    auto& recovered = *session; // the memory for maps is exceeded: evict it immediately
    recovered.close({Errc::kShuttingDown, "the session is evicted from memory"},
                    [this, session, done = std::move(done)] {
                        cache_.add(session->info(), summary_of(*session->snapshot()));
                        done();
                    });
}

} // namespace scanloom::session
