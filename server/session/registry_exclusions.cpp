#include "server/session/session_registry.hpp"

#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>

/// How scans are excluded from the maps of a session.
namespace scanloom::session {
namespace {

Result<RobotIndex> find_robot(const Session& session, std::string_view name) {
    const auto maps = session.snapshot();
    const auto found = std::ranges::find(maps->robots, name, &mapping::RobotState::name);
    if (found != maps->robots.end()) return static_cast<RobotIndex>(found - maps->robots.begin());
    return Error{
        Errc::kInvalidField,
        fmt::format("session '{}' has no robot of that name; GET the session lists its robots", session.info().name)};
}

Error maps_are_computed_again(const std::string& name) {
    return {Errc::kShuttingDown,
            fmt::format("the maps of session '{}' are computed again from its log; connect again", name)};
}

} // namespace

Result<Exclusion> SessionRegistry::exclude(std::string_view name, std::string_view robot,
                                           const std::variant<StampRange, SeqRange>& scans) {
    const std::lock_guard changing(changing_);
    auto session = wake(name);
    if (!session) return session.error();
    const auto index = find_robot(**session, robot);
    if (!index) return index.error();
    const SessionInfo info = (*session)->info();
    if (info.exclusions->count_in_effect() >= Exclusions::kMost) {
        return Error{Errc::kFull, fmt::format("session '{}' has {} exclusions in effect, the most there may be; lift "
                                              "some, or exclude larger ranges",
                                              name, Exclusions::kMost)};
    }
    const auto& known = info.exclusions->all();
    const ScansExcluded excluded{known.empty() ? 1 : known.back().excluded.id + 1, *index, scans};
    session->reset();
    const auto since = append_and_read_again(info, excluded);
    if (!since) return since.error();
    return Exclusion{excluded, *since};
}

Result<> SessionRegistry::lift_exclusion(std::string_view name, std::uint64_t id) {
    const std::lock_guard changing(changing_);
    auto session = wake(name);
    if (!session) return session.error();
    const SessionInfo info = (*session)->info();
    const bool is_in_effect = std::ranges::any_of(
        info.exclusions->all(), [&](const Exclusion& one) { return one.excluded.id == id && one.lifted == 0; });
    if (!is_in_effect) {
        return Error{Errc::kNotFound,
                     fmt::format("session '{}' has no exclusion {}, or it is lifted already", name, id)};
    }
    session->reset();
    const auto appended = append_and_read_again(info, ExclusionLifted{id});
    return appended ? Result<>() : appended.error();
}

/// Appends an entry while the session is closed, so that no other thread writes to its log.
/// Pre  changing_ is held. @return the entry's revision
Result<Revision> SessionRegistry::append_and_read_again(const SessionInfo& info, const LogEntry& entry) {
    if (draining_) return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
    auto left = roster_.leave(info.name);
    if (!left) return no_such_session(info.name);
    if (left->session) {
        const auto closed = std::make_shared<std::promise<void>>();
        auto is_closed = closed->get_future();
        left->session->discard(maps_are_computed_again(info.name), [closed] { closed->set_value(); });
        is_closed.wait();
        left->summary = summary_of(*left->session->snapshot());
    }
    const auto end = log_.end_of(info.id);
    const auto appended =
        end ? store::append_and_wait(log_, info.id, *end + 1, {wire::encode_entry(entry)}) : Result<>(end.error());
    if (const auto wanted = roster_.arrived(info.name, left->summary)) start_reading(*wanted);
    wake(info.name, [](const Result<std::shared_ptr<Session>>&) {}); // robots and viewers come back for it
    if (!appended) return appended.error();
    return *end + 1;
}

} // namespace scanloom::session
