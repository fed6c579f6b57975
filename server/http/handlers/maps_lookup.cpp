#include "server/http/handlers/maps_lookup.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/handlers/weave_request.hpp"
#include "server/http/in_quotes.hpp"

#include <fmt/format.h>

#include <vector>

namespace scanloom::http {
namespace {

constexpr std::string_view kWeave = "weave";
constexpr std::string_view kWith = "with";

/// Returns the maps of a replay job, or the reason why it has none.
Result<Maps> maps_of(std::shared_ptr<session::Session> session, const std::shared_ptr<session::Weave>& weave,
                     std::shared_ptr<const mapping::Snapshot> maps) {
    if (maps) {
        auto tag = fmt::format("{}-{}", session_tag(session->info()), weave->id());
        tag = tag_with(tag, *maps->exclusions);
        return Maps{std::move(session), std::move(maps), weave, std::move(tag)};
    }
    const auto progress = weave->progress();
    if (progress.error) return *progress.error;
    const auto earlier =
        progress.revision ? fmt::format(", or take those with {} of them as weave={}", *progress.revision, weave->id())
                          : std::string();
    return Error{
        Errc::kOverloaded,
        fmt::format("these maps are being woven, {} of {} entries are in; ask again soon, see weave/{} for how "
                    "far it is{}",
                    progress.woven, progress.target, weave->id(), earlier)};
}

} // namespace

Result<std::shared_ptr<session::Weave>> find_weave(session::Weaves& weaves, const session::Session& session,
                                                   std::string_view id) {
    if (auto weave = weaves.find(session.info().id, id)) return weave;
    return Error{
        Errc::kNotFound,
        fmt::format("there is no weave {} of this session, or no longer; start it with POST .../weave", in_quotes(id))};
}

Result<> MapsLookup::check(const Call& call, std::initializer_list<std::string_view> known) {
    std::vector<std::string_view> all(known);
    all.push_back(kWeave);
    return call.query.check_only(all);
}

Result<Maps> MapsLookup::find(const Call& call, std::initializer_list<std::string_view> known) const {
    if (auto ok = check(call, known); !ok) return ok.error();
    return chosen(call, kWeave);
}

Result<Maps> MapsLookup::find_at_once(const Call& call, std::initializer_list<std::string_view> known) const {
    if (auto ok = check(call, known); !ok) return ok.error();
    return chosen(call, kWeave, Waiting::kNotAllowed);
}

Result<TwoMaps> MapsLookup::find_two(const Call& call, std::initializer_list<std::string_view> known) const {
    std::vector<std::string_view> all(known);
    all.insert(all.end(), {kWeave, kWith});
    if (auto ok = call.query.check_only(all); !ok) return ok.error();
    if (!call.query.find(kWeave) && !call.query.find(kWith)) {
        return Error{Errc::kInvalidField,
                     "a weave to compare with is needed: weave=, with=, or both; where one is left out, the session's "
                     "own map takes its place"};
    }
    auto a = chosen(call, kWeave);
    if (!a) return a.error();
    auto b = chosen(call, kWith);
    if (!b) return b.error();
    return TwoMaps{std::move(*a), std::move(*b)};
}

Result<Maps> MapsLookup::find_or_weave(const Call& call, std::initializer_list<std::string_view> known) const {
    std::vector<std::string_view> all(known);
    all.push_back(kWeave);
    const auto settings = weave_parameters();
    all.insert(all.end(), settings.begin(), settings.end());
    if (auto ok = call.query.check_only(all); !ok) return ok.error();
    if (!asks_for_weaving(call.query)) return chosen(call, kWeave);
    if (!call.query.find(kWeave)) return woven(call);
    return Error{Errc::kInvalidField, "weave names maps that have their settings; leave the other settings out"};
}

/// Returns the maps of the replay job that `parameter` names, or the session's own maps.
Result<Maps> MapsLookup::chosen(const Call& call, std::string_view parameter, Waiting waiting) const {
    if (waiting == Waiting::kNotAllowed) {
        const auto info = sessions_.info(call.arguments["session"]);
        if (info && !sessions_.find(info->name)) return Maps{nullptr, nullptr, nullptr, session_tag(*info)};
    }
    auto session = find_session(sessions_, call);
    if (!session) return session.error();
    const auto id = call.query.find(parameter);
    if (!id) {
        auto snapshot = waiting == Waiting::kAllowed ? (*session)->snapshot() : (*session)->try_snapshot();
        auto tag = session_tag((*session)->info());
        return Maps{*session, std::move(snapshot), *session, std::move(tag)};
    }
    const auto weave = find_weave(weaves_, **session, *id);
    if (!weave) return weave.error();
    return maps_of(std::move(*session), *weave, (*weave)->maps());
}

Result<Maps> MapsLookup::woven(const Call& call) const {
    auto session = find_session(sessions_, call);
    if (!session) return session.error();
    const auto request = weave_request(**session, call.query);
    if (!request) return request.error();
    const Revision newest = (*session)->snapshot()->revision;
    const auto weave = weaves_.start((*session)->info(), *request, newest, session::Weaves::Listing::kUnlisted);
    if (!weave) return weave.error();
    return maps_of(std::move(*session), *weave, (*weave)->wait(session::target_of(*request, newest), patience_));
}

} // namespace scanloom::http
