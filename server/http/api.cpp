#include "server/http/api.hpp"

#include "server/http/content_coding.hpp"
#include "server/http/handlers/backups.hpp"
#include "server/http/handlers/changes.hpp"
#include "server/http/handlers/coverage.hpp"
#include "server/http/handlers/difference.hpp"
#include "server/http/handlers/digest.hpp"
#include "server/http/handlers/exclusions.hpp"
#include "server/http/handlers/frontiers.hpp"
#include "server/http/handlers/goal.hpp"
#include "server/http/handlers/goals.hpp"
#include "server/http/handlers/health.hpp"
#include "server/http/handlers/import.hpp"
#include "server/http/handlers/landmarks.hpp"
#include "server/http/handlers/live.hpp"
#include "server/http/handlers/log.hpp"
#include "server/http/handlers/login.hpp"
#include "server/http/handlers/map_files.hpp"
#include "server/http/handlers/metrics.hpp"
#include "server/http/handlers/openapi.hpp"
#include "server/http/handlers/plan.hpp"
#include "server/http/handlers/points.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/handlers/sessions.hpp"
#include "server/http/handlers/tile.hpp"
#include "server/http/handlers/tilejson.hpp"
#include "server/http/handlers/trajectory.hpp"
#include "server/http/handlers/viewer.hpp"
#include "server/http/handlers/weaves.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/json_read.hpp"
#include "server/http/multipart.hpp"
#include "server/http/permission.hpp"
#include "server/http/problem.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

#include <fmt/format.h>

#include <optional>
#include <variant>

namespace scanloom::http {
namespace {

bool needs_sessions(Operation operation) {
    switch (operation) {
    case Operation::kViewer:
    case Operation::kViewerAsset:
    case Operation::kLivez:
    case Operation::kReadyz:
    case Operation::kGetLogin:
    case Operation::kLogin:
    case Operation::kLogout:
    case Operation::kMetrics:
    case Operation::kListBackups:
    case Operation::kMakeBackup:
    case Operation::kOpenapi: return false;
    default: return true;
    }
}

/// Returns whether the session in the path must be in memory.
bool needs_maps(Operation operation) {
    switch (operation) {
    case Operation::kListSessions:
    case Operation::kCreateSession:
    case Operation::kImportMap:
    case Operation::kGetSession:
    case Operation::kDeleteSession:
    case Operation::kExclude:
    case Operation::kListExclusions:
    case Operation::kLiftExclusion: return false;
    default: return needs_sessions(operation);
    }
}

std::optional<tiles::TileFormat> tile_format_of(Operation operation) {
    if (operation == Operation::kTilePng) return tiles::TileFormat::kPng;
    if (operation == Operation::kTileBin) return tiles::TileFormat::kCodes;
    return std::nullopt;
}

/// Checks that the Content-Type is the one that the operation reads.
Result<> check_content_type(Operation operation, const Request& request) {
    if (request.method != "POST") return {};
    const bool wants_form = operation == Operation::kImportMap;
    if (wants_form ? is_form(request.content_type) : is_json(request.content_type)) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("the body is {}; send Content-Type: {}", in_quotes(request.content_type),
                             wants_form ? "multipart/form-data" : "application/json")};
}

} // namespace

std::variant<Api::Admitted, Response> Api::admit(const Request& request) const {
    const auto path = instance_of(request.target);
    auto target = parse_target(request.target);
    if (!target) return problem(target.error(), path);

    auto routing = find_route(request.method, target->segments);
    if (std::holds_alternative<NoSuchPath>(routing)) {
        return problem(Error{Errc::kNotFound, "there is nothing at this path; /openapi.json lists what there is"},
                       path);
    }
    if (const auto* refused = std::get_if<MethodNotAllowed>(&routing)) {
        return problem(Status::method_not_allowed,
                       fmt::format("{} is not possible here; use one of {}", in_quotes(request.method), refused->allow),
                       path)
            .set("Allow", refused->allow);
    }
    auto& match = std::get<Match>(routing);
    auto who = doorman_.admit(request, match);
    if (auto* refusal = std::get_if<Response>(&who)) return std::move(*refusal);
    if (auto accepted = check_content_type(match.operation, request); !accepted) {
        return problem(Status::unsupported_media_type, accepted.error().message, path);
    }
    return Admitted{std::move(match), std::move(target->query), std::get<access::TokenRef>(std::move(who))};
}

Response Api::answer(const Request& request) {
    auto admitted = admit(request);
    if (auto* refusal = std::get_if<Response>(&admitted)) return std::move(*refusal);
    auto& [match, query, who] = std::get<Admitted>(admitted);
    auto response = call(match, {request, match.arguments, query, std::move(who)});
    if (!response) return problem(response.error(), instance_of(request.target));
    auto plain = for_who_asked(match.operation, std::move(*response));
    const bool is_on_io_thread = lane_of(match, query) == Lane::kAtOnce;
    if (is_on_io_thread && !plain.gzip) return plain; // compressing takes milliseconds
    return encoded_for(request.accept_encoding, std::move(plain));
}

std::optional<Response> Api::refuse(const Request& request) const {
    auto admitted = admit(request);
    auto* refusal = std::get_if<Response>(&admitted);
    return refusal == nullptr ? std::nullopt : std::optional(std::move(*refusal));
}

Outlook Api::look(const Request& request) {
    const auto target = parse_target(request.target);
    if (!target) return Lane::kAtOnce;
    const auto routing = find_route(request.method, target->segments);
    const auto* match = std::get_if<Match>(&routing);
    if (match == nullptr) return Lane::kAtOnce;
    auto who = doorman_.admit(request, *match);
    if (auto* refusal = std::get_if<Response>(&who)) return std::move(*refusal);
    if (recovered_ && needs_maps(match->operation)) {
        const auto& session = match->arguments["session"];
        if (sessions_.is_asleep(session)) return Asleep{session};
    }
    const auto format = tile_format_of(match->operation);
    if (!format || !recovered_) return lane_of(*match, target->query);
    const Call call{request, match->arguments, target->query, std::get<access::TokenRef>(std::move(who))};
    auto outlook = look_at_tile(maps_, tiles_, call, *format);
    if (!outlook) return problem(outlook.error(), instance_of(request.target));
    if (auto* response = std::get_if<Response>(&*outlook)) return for_who_asked(match->operation, std::move(*response));
    return std::move(*outlook);
}

void Api::wake(const Asleep& asleep, std::function<void()> on_loaded) {
    sessions_.wake(asleep.session, [on_loaded = std::move(on_loaded)](
                                       const Result<std::shared_ptr<session::Session>>&) { on_loaded(); });
}

/// A response that depends on permissions must not be kept by shared caches, so "public" becomes "private".
Response Api::for_who_asked(Operation operation, Response response) const {
    if (need_of(operation) == Need::kNothing || doorman_.gate().is_open()) return response;
    for (auto& [field, value] : response.fields) {
        constexpr std::string_view kPublic = "public";
        if (field == "Cache-Control" && value.starts_with(kPublic)) value.replace(0, kPublic.size(), "private");
    }
    return response;
}

Result<Response> Api::call(const Match& match, const Call& call) {
    if (needs_sessions(match.operation) && !recovered_) {
        return Error{Errc::kOverloaded, "the sessions are still being recovered from the store; try again soon"};
    }
    switch (match.operation) {
    case Operation::kViewer: return get_viewer(web_, call);
    case Operation::kViewerAsset: return get_viewer_asset(web_, call);
    case Operation::kLivez: return get_livez(call);
    case Operation::kReadyz: return get_readyz(sessions_, check_, log_, recovered_, robots_, call);
    case Operation::kMetrics: return get_metrics(metrics_, sessions_, check_, weaves_, log_, tiles_.stats(), call);
    case Operation::kOpenapi: return get_openapi(call);
    case Operation::kGetLogin: return get_login(doorman_, call);
    case Operation::kLogin: return post_login(doorman_, call);
    case Operation::kLogout: return delete_login(doorman_, call);
    case Operation::kListBackups: return list_backups(backups_, call);
    case Operation::kMakeBackup: return make_backup(backups_, log_, call);
    case Operation::kListSessions: return list_sessions(sessions_, check_, call);
    case Operation::kCreateSession: return create_session(sessions_, doorman_, call);
    case Operation::kGetSession: return get_session(sessions_, check_, call);
    case Operation::kDeleteSession: return delete_session(sessions_, {weaves_, landmarks_, locator_, tiles_}, call);
    case Operation::kImportMap: return import_map(sessions_, doorman_, call);
    case Operation::kTilePng: return get_tile(maps_, tiles_, call, tiles::TileFormat::kPng);
    case Operation::kTileBin: return get_tile(maps_, tiles_, call, tiles::TileFormat::kCodes);
    case Operation::kTileJson: return get_tilejson(maps_, call);
    case Operation::kChanges: return get_changes(maps_, call);
    case Operation::kMapPng: return get_map_png(maps_, slots_, call);
    case Operation::kMapPgm: return get_map_pgm(maps_, slots_, call);
    case Operation::kMapYaml: return get_map_yaml(maps_, call);
    case Operation::kMapCsv: return get_map_csv(maps_, slots_, call);
    case Operation::kMapNpy: return get_map_npy(maps_, slots_, call);
    case Operation::kDigest: return get_digest(maps_, call);
    case Operation::kDifference: return get_difference(maps_, call);
    case Operation::kDifferencePng: return get_difference_png(maps_, slots_, call);
    case Operation::kTrajectory: return get_trajectory(sessions_, log_, slots_, call);
    case Operation::kFrontiers: return get_frontiers(maps_, slots_, call);
    case Operation::kLandmarks: return get_landmarks(sessions_, landmarks_, slots_, call);
    case Operation::kPointsCsv: return get_points(sessions_, log_, slots_, PointFile::kCsv, call);
    case Operation::kPointsPly: return get_points(sessions_, log_, slots_, PointFile::kPly, call);
    case Operation::kPlan: return post_plan(maps_, slots_, call);
    case Operation::kCoverage: return post_coverage(maps_, slots_, call);
    case Operation::kGoal: return get_goal(sessions_, goals_.ways(), slots_, call);
    case Operation::kAssignGoal: return assign_goal(maps_, goals_, slots_, call);
    case Operation::kGoals: return get_goals(sessions_, goals_.ways(), slots_, call);
    case Operation::kLog: return get_log(sessions_, log_, call);
    case Operation::kLive: return get_live(sessions_, goals_.ways(), watched_landmarks_, doorman_, call);
    case Operation::kStartWeave: return start_weave(maps_, call);
    case Operation::kListWeaves: return list_weaves(maps_, call);
    case Operation::kGetWeave: return get_weave(maps_, call);
    case Operation::kDeleteWeave: return delete_weave(maps_, call);
    case Operation::kExclude: return exclude_scans(sessions_, call);
    case Operation::kListExclusions: return list_exclusions(sessions_, call);
    case Operation::kLiftExclusion: return lift_exclusion(sessions_, call);
    }
    return Error{Errc::kNotFound, "this operation has no handler"};
}

} // namespace scanloom::http
