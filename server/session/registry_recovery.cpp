#include "server/session/session_registry.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <latch>
#include <set>

/// What a registry does when the server starts.
namespace scanloom::session {
namespace {

/// A session as its record describes it.
struct Recorded {
    SessionInfo info;
    std::uint32_t map_patches = 0;
};

/// @param name  becomes that of the session, as soon as its record has told.
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

/// Of two with one name, which only a fault can have stored, the older is served and the other kept aside.
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
    const std::lock_guard changing(changing_); // drain() waits
    std::vector<Recorded> found;
    std::set<std::string> names;
    for (const auto& session : *stored) {
        std::string name = fmt::format("#{}", session.id); // until its record has told
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
    if (draining_) return done(); // told to stop meanwhile: what is not woven now will be at the next start
    if (can_stay_asleep(info, map_patches)) return done();
    auto session = factory_.read(info, draining_, hurried_);
    if (session && *session && (*session)->snapshot()->revision < map_patches) {
        log::warn({.session = info.name}, "session '{}' is removed: its import came to {} of {} parts before a crash",
                  info.name, (*session)->snapshot()->revision, map_patches); // nobody was told that it exists
        if (auto removed = log_.remove_session(info.id); !removed) keep_damaged(info.name, info.id, removed.error());
        return done();
    }
    if (session && *session) return add_recovered(std::move(*session), std::move(done));
    if (!session) keep_damaged(info.name, info.id, session.error());
    done();
}

/// Whether all of it that a list shows is known without weaving anything.
bool SessionRegistry::can_stay_asleep(const SessionInfo& info, std::uint32_t map_patches) {
    auto summary = read_summary(log_, info.id, info.config);
    if (!summary || !*summary || (*summary)->facts->revision < map_patches) return false; // reading it will tell
    SessionInfo asleep = info;
    asleep.exclusions = (*summary)->facts->exclusions;
    roster_.add(std::move(asleep), std::move(**summary));
    return true;
}

void SessionRegistry::add_recovered(std::shared_ptr<Session> session, std::function<void()> done) {
    if (pages_->free() >= 0) {
        roster_.add(std::move(session), config_.clock());
        return done();
    }
    auto& recovered = *session; // with it there are more than fit into memory: it goes to sleep at once
    recovered.close({Errc::kShuttingDown, "the session leaves memory"}, [this, session, done = std::move(done)] {
        roster_.add(session->info(), summary_of(*session->snapshot()));
        done();
    });
}

} // namespace scanloom::session
