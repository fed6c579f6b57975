#include "server/http/api.hpp"

#include "server/http/content_coding.hpp"
#include "server/http/handlers/handlers.hpp"
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
    auto who = services_.doorman.admit(request, match);
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
    Context context{services_, request, match.arguments, query, std::move(who)};
    auto response = call(match.operation, context);
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
    auto who = services_.doorman.admit(request, *match);
    if (auto* refusal = std::get_if<Response>(&who)) return std::move(*refusal);
    if (services_.recovered && needs_maps(match->operation)) {
        const auto& session = match->arguments["session"];
        if (services_.sessions.is_asleep(session)) return Asleep{session};
    }
    const auto format = tile_format_of(match->operation);
    if (!format || !services_.recovered) return lane_of(*match, target->query);
    const Context context{services_, request, match->arguments, target->query,
                          std::get<access::TokenRef>(std::move(who))};
    auto outlook = look_at_tile(context, *format);
    if (!outlook) return problem(outlook.error(), instance_of(request.target));
    if (auto* response = std::get_if<Response>(&*outlook)) return for_who_asked(match->operation, std::move(*response));
    return std::move(*outlook);
}

void Api::wake(const Asleep& asleep, std::function<void()> on_loaded) {
    services_.sessions.wake(asleep.session, [on_loaded = std::move(on_loaded)](
                                                const Result<std::shared_ptr<session::Session>>&) { on_loaded(); });
}

/// A response that depends on permissions must not be kept by shared caches, so "public" becomes "private".
Response Api::for_who_asked(Operation operation, Response response) const {
    if (need_of(operation) == Need::kNothing || services_.doorman.gate().is_open()) return response;
    for (auto& [field, value] : response.fields) {
        constexpr std::string_view kPublic = "public";
        if (field == "Cache-Control" && value.starts_with(kPublic)) value.replace(0, kPublic.size(), "private");
    }
    return response;
}

Result<Response> Api::call(Operation operation, Context& context) {
    if (needs_sessions(operation) && !services_.recovered) {
        return Error{Errc::kOverloaded, "the sessions are still being recovered from the store; try again soon"};
    }
    switch (operation) {
    case Operation::kViewer: return get_viewer(context);
    case Operation::kViewerAsset: return get_viewer_asset(context);
    case Operation::kLivez: return get_livez(context);
    case Operation::kReadyz: return get_readyz(context);
    case Operation::kMetrics: return get_metrics(context);
    case Operation::kOpenapi: return get_openapi(context);
    case Operation::kGetLogin: return get_login(context);
    case Operation::kLogin: return post_login(context);
    case Operation::kLogout: return delete_login(context);
    case Operation::kListBackups: return list_backups(context);
    case Operation::kMakeBackup: return make_backup(context);
    case Operation::kListSessions: return list_sessions(context);
    case Operation::kCreateSession: return create_session(context);
    case Operation::kGetSession: return get_session(context);
    case Operation::kDeleteSession: return delete_session(context);
    case Operation::kImportMap: return import_map(context);
    case Operation::kTilePng: return get_tile_png(context);
    case Operation::kTileBin: return get_tile_bin(context);
    case Operation::kTileJson: return get_tilejson(context);
    case Operation::kChanges: return get_changes(context);
    case Operation::kMapPng: return get_map_png(context);
    case Operation::kMapPgm: return get_map_pgm(context);
    case Operation::kMapYaml: return get_map_yaml(context);
    case Operation::kMapCsv: return get_map_csv(context);
    case Operation::kMapNpy: return get_map_npy(context);
    case Operation::kDigest: return get_digest(context);
    case Operation::kDifference: return get_difference(context);
    case Operation::kDifferencePng: return get_difference_png(context);
    case Operation::kTrajectory: return get_trajectory(context);
    case Operation::kFrontiers: return get_frontiers(context);
    case Operation::kLandmarks: return get_landmarks(context);
    case Operation::kPointsCsv: return get_points_csv(context);
    case Operation::kPointsPly: return get_points_ply(context);
    case Operation::kPlan: return post_plan(context);
    case Operation::kCoverage: return post_coverage(context);
    case Operation::kGoal: return get_goal(context);
    case Operation::kAssignGoal: return assign_goal(context);
    case Operation::kGoals: return get_goals(context);
    case Operation::kLog: return get_log(context);
    case Operation::kLive: return get_live(context);
    case Operation::kStartWeave: return start_weave(context);
    case Operation::kListWeaves: return list_weaves(context);
    case Operation::kGetWeave: return get_weave(context);
    case Operation::kDeleteWeave: return delete_weave(context);
    case Operation::kExclude: return exclude_scans(context);
    case Operation::kListExclusions: return list_exclusions(context);
    case Operation::kLiftExclusion: return lift_exclusion(context);
    }
    return Error{Errc::kNotFound, "this operation has no handler"};
}

} // namespace scanloom::http
