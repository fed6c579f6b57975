#include "server/sessions/session_registry.hpp"

#include "common/wire/log_codec.hpp"
#include "server/log/context.hpp"

#include <fmt/format.h>

#include <future>
#include <new>

/// Exclusion of scans from the maps of a session.
namespace scanloom::session {
namespace {

Error maps_are_computed_again(const std::string& name) {
    return {Errc::kShuttingDown,
            fmt::format("the maps of session '{}' are computed again from its log; connect again", name)};
}

/// Closes the session and waits for it. Acknowledged scans are durable; robots send the others again.
void close_and_wait(Session& session) {
    std::promise<void> closed;
    session.discard(maps_are_computed_again(session.info().name), [&closed] { closed.set_value(); });
    closed.get_future().wait();
}

Result<> check_room(const SessionInfo& info) {
    if (info.exclusions->count_in_effect() < Exclusions::kMost) return {};
    return Error{Errc::kFull, fmt::format("session '{}' has {} exclusions in effect, the limit; lift some, "
                                          "or exclude larger ranges",
                                          info.name, Exclusions::kMost)};
}

} // namespace

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
    if (draining_) return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
    auto left = cache_.leave(name);
    if (!left) return damage_of(name).value_or(no_such_session(name));
    const auto stay = [&](Error why) {
        if (const auto wanted = cache_.stay(name)) start_load(*wanted);
        return why;
    };
    try {
        const auto entry = make(left->info);
        if (!entry) return stay(entry.error());
        if (left->session) left->summary = summary_of(*left->session->snapshot());
        auto facts = std::make_shared<mapping::Snapshot>(*left->summary.facts);
        auto exclusions = std::make_shared<Exclusions>(*left->info.exclusions);
        std::vector<std::string> bytes = {wire::encode_entry(*entry)};
        if (left->session) close_and_wait(*left->session);
        const auto end = log_.end_of(left->info.id);
        const auto appended =
            end ? store::append_and_wait(log_, left->info.id, *end + 1, std::move(bytes)) : Result<>(end.error());
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
        if (const auto wanted = cache_.arrived(left->info.name, left->summary)) start_load(*wanted);
        if (!appended) return appended.error();
        return *end + 1;
    } catch (const std::bad_alloc&) {
        if (left->session && left->session->closing()) { // it is closed and must be loaded again
            if (const auto wanted = cache_.arrived(left->info.name, left->summary)) start_load(*wanted);
            return Error{Errc::kOverloaded, "there is no memory left for this; try again later"};
        }
        return stay({Errc::kOverloaded, "there is no memory left for this; try again later"});
    }
}

} // namespace scanloom::session
