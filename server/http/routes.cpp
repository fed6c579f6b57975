#include "server/http/routes.hpp"

#include "server/http/handlers/handlers.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

/// Begins the paths of a session.
#define SESSION "/api/v1/sessions/{session}"

namespace scanloom::http {
namespace {

/// Returns `names` and the name of every setting of a session.
template <std::size_t N>
consteval auto with_settings(const std::string_view (&names)[N]) {
    constexpr auto kSettings = std::to_array<std::string_view>({
#define SCANLOOM_SETTING(type, name, ...) #name,
#include "common/scan/settings.def"
    });
    std::array<std::string_view, N + kSettings.size()> all;
    std::ranges::copy(kSettings, std::ranges::copy(names, all.begin()).out);
    return all;
}

} // namespace

std::span<const Route> routes() noexcept {
    using enum Method;
    using enum Access;
    using enum WorkClass;
    using enum Sessions;
    // The query parameters of an operation.
    static constexpr std::string_view kChanges[] = {"layer", "since", "weave"};
    static constexpr std::string_view kDifference[] = {"weave", "with", "layer", "bbox"};
    static constexpr std::string_view kFrontiers[] = {"robot", "size_min", "body_radius", "weave"};
    static constexpr std::string_view kJob[] = {"weave"};
    static constexpr std::string_view kLandmarks[] = {"since", "bbox", "seen_min"};
    static constexpr std::string_view kLog[] = {"format"};
    static constexpr std::string_view kPage[] = {"limit", "after"};
    static constexpr std::string_view kPoints[] = {"since", "until", "robot", "threshold"};
    static constexpr std::string_view kRobot[] = {"robot"};
    static constexpr std::string_view kTile[] = {"v", "id", "weave"};
    static constexpr std::string_view kToken[] = {"token"};
    static constexpr std::string_view kTrajectory[] = {"since", "times"};
    static constexpr std::string_view kTum[] = {"robot", "as"};
    static constexpr auto kMapFile = with_settings({"layer", "bbox", "weave", "until", "poses"});
    static constexpr auto kDigest = with_settings({"layer", "weave", "until", "poses"});
    static constexpr auto kRoutes = std::to_array<Route>({
        // method, path, name, permission, work, sessions, parameters, handler
        {kGet, "/", "viewer", kOpen, kIo, kUnused, kAnyParameters, get_viewer},
        {kGet, "/assets/{file}", "viewerAsset", kOpen, kIo, kUnused, {}, get_viewer_asset},
        {kGet, "/livez", "livez", kOpen, kIo, kUnused, {}, get_livez},
        {kGet, "/readyz", "readyz", kOpen, kIo, kUnused, {}, get_readyz},
        {kGet, "/metrics", "metrics", kServer, kMetrics, kUnused, {}, get_metrics},
        {kGet, "/openapi.json", "openapi", kOpen, kIo, kUnused, {}, get_openapi},
        {kGet, "/api/v1/login", "getLogin", kOpen, kIo, kUnused, {}, get_login},
        {kPost, "/api/v1/login", "login", kOpen, kIo, kUnused, {}, post_login},
        {kDelete, "/api/v1/login", "logout", kOpen, kIo, kUnused, {}, delete_login},
        {kGet, "/api/v1/nodes", "listNodes", kServer, kQueries, kListed, {}, list_nodes},
        {kPost, "/api/v1/node/drain", "drainNode", kOperate, kQueries, kUnused, {}, drain_node},
        {kGet, "/api/v1/backups", "listBackups", kOperate, kQueries, kUnused, {}, list_backups},
        {kPost, "/api/v1/backups", "makeBackup", kOperate, kStore, kUnused, {}, make_backup},
        {kGet, "/api/v1/sessions", "listSessions", kList, kQueries, kListed, kPage, list_sessions},
        {kPost, "/api/v1/sessions", "createSession", kCreate, kStore, kListed, {}, create_session},
        {kGet, SESSION, "getSession", kRead, kQueries, kListed, {}, get_session},
        {kDelete, SESSION, "deleteSession", kChange, kStore, kListed, {}, delete_session},
        {kPostForm, SESSION "/import", "importMap", kChange, kImport, kListed, {}, import_map},
        {kPost, SESSION "/estimate", "estimateSession", kChange, kStore, kListed, {}, estimate_session},
        {kPost, SESSION "/exclude", "excludeScans", kChange, kStore, kListed, {}, exclude_scans},
        {kGet, SESSION "/exclusions", "listExclusions", kRead, kQueries, kListed, {}, list_exclusions},
        {kDelete, SESSION "/exclusions/{exclusion}", "liftExclusion", kChange, kStore, kListed, {}, lift_exclusion},
        {kGet, SESSION "/tiles/{layer}/{z}/{x}/{y}.png", "tilePng", kRead, kIo, kLoaded, kTile, get_tile_png},
        {kGet, SESSION "/tiles/{layer}/{z}/{x}/{y}.bin", "tileBin", kRead, kIo, kLoaded, kTile, get_tile_bin},
        {kGet, SESSION "/tiles/{layer}.json", "tileJson", kRead, kQueries, kLoaded, kJob, get_tilejson},
        {kGet, SESSION "/changes", "changes", kRead, kQueries, kLoaded, kChanges, get_changes},
        {kGet, SESSION "/map.png", "mapPng", kRead, kWholeMaps, kLoaded, kMapFile, get_map_png},
        {kGet, SESSION "/map.pgm", "mapPgm", kRead, kWholeMaps, kLoaded, kMapFile, get_map_pgm},
        {kGet, SESSION "/map.yaml", "mapYaml", kRead, kQueries, kLoaded, kMapFile, get_map_yaml},
        {kGet, SESSION "/map.pgw", "mapPgw", kRead, kQueries, kLoaded, kMapFile, get_map_pgw},
        {kGet, SESSION "/map.csv", "mapCsv", kRead, kWholeMaps, kLoaded, kMapFile, get_map_csv},
        {kGet, SESSION "/map.npy", "mapNpy", kRead, kWholeMaps, kLoaded, kMapFile, get_map_npy},
        {kGet, SESSION "/digest", "digest", kRead, kWholeMaps, kLoaded, kDigest, get_digest},
        {kGet, SESSION "/difference", "difference", kRead, kWholeMaps, kLoaded, kDifference, get_difference},
        {kGet, SESSION "/difference.png", "differencePng", kRead, kWholeMaps, kLoaded, kDifference, get_difference_png},
        {kGet, SESSION "/trajectory.geojson", "trajectory", kRead, kLogReading, kLoaded, kTrajectory, get_trajectory},
        {kGet, SESSION "/trajectory.tum", "trajectoryTum", kRead, kLogReading, kLoaded, kTum, get_trajectory_tum},
        {kGet, SESSION "/trajectory.kitti", "trajectoryKitti", kRead, kLogReading, kLoaded, kTum, get_trajectory_kitti},
        {kGet, SESSION "/pose_graph.geojson", "poseGraph", kRead, kLogReading, kLoaded, {}, get_pose_graph},
        {kGet, SESSION "/pose_graph.g2o", "poseGraphG2o", kRead, kLogReading, kLoaded, {}, get_pose_graph_g2o},
        {kPost, SESSION "/relocalize", "relocalize", kChange, kQueries, kLoaded, {}, relocalize},
        {kPost, SESSION "/mode", "changeMode", kChange, kQueries, kLoaded, {}, change_mode},
        {kGet, SESSION "/landmarks.geojson", "landmarks", kRead, kLogReading, kLoaded, kLandmarks, get_landmarks},
        {kGet, SESSION "/points.csv", "pointsCsv", kRead, kLogReading, kLoaded, kPoints, get_points_csv},
        {kGet, SESSION "/points.ply", "pointsPly", kRead, kLogReading, kLoaded, kPoints, get_points_ply},
        {kGet, SESSION "/points.pcd", "pointsPcd", kRead, kLogReading, kLoaded, kPoints, get_points_pcd},
        {kGet, SESSION "/frontiers.geojson", "frontiers", kRead, kPlanning, kLoaded, kFrontiers, get_frontiers},
        {kPost, SESSION "/plan", "plan", kRead, kPlanning, kLoaded, kJob, post_plan},
        {kPost, SESSION "/coverage", "coverage", kRead, kPlanning, kLoaded, kJob, post_coverage},
        {kGet, SESSION "/goal", "goal", kRead, kQueries, kLoaded, kRobot, get_goal},
        {kPost, SESSION "/goal", "assignGoal", kGuide, kPlanning, kLoaded, kJob, assign_goal},
        {kGet, SESSION "/goals.geojson", "goals", kRead, kQueries, kLoaded, {}, get_goals},
        {kGet, SESSION "/weave", "listWeaves", kRead, kQueries, kLoaded, {}, list_weaves},
        {kPost, SESSION "/weave", "startWeave", kRead, kQueries, kLoaded, {}, start_weave},
        {kGet, SESSION "/weave/{weave}", "getWeave", kRead, kQueries, kLoaded, {}, get_weave},
        {kDelete, SESSION "/weave/{weave}", "deleteWeave", kChange, kQueries, kLoaded, {}, delete_weave},
        {kGet, SESSION "/log", "getLog", kRead, kLogExport, kLoaded, kLog, get_log},
        {kGet, SESSION "/live", "live", kRead, kQueries, kLoaded, {}, get_live},
        {kGet, SESSION "/foxglove", "foxglove", kRead, kQueries, kLoaded, kToken, get_foxglove},
    });
    return kRoutes;
}

#undef SESSION

std::string_view name_of(Method method) noexcept {
    switch (method) {
    case Method::kGet: return "GET";
    case Method::kPost:
    case Method::kPostForm: return "POST";
    case Method::kDelete: return "DELETE";
    }
    return "";
}

boost::asio::awaitable<Result<Response>> Handler::operator()(Context& context) const {
    if (function_ != nullptr) co_return function_(context);
    co_return co_await coroutine_(context);
}

std::variant<Match, NoSuchPath, MethodNotAllowed> find_route(std::span<const Route> routes, std::string_view method,
                                                             const std::vector<std::string>& segments) {
    std::string allow;
    for (const auto& route : routes) {
        auto arguments = match_path(route.path, segments);
        if (!arguments) continue;
        const auto name = name_of(route.method);
        if (name == method || (name == "GET" && method == "HEAD")) return Match{route, std::move(*arguments)};
        if (!allow.empty()) allow += ", ";
        allow += name == "GET" ? "GET, HEAD" : name;
    }
    if (allow.empty()) return NoSuchPath{};
    return MethodNotAllowed{std::move(allow)};
}

} // namespace scanloom::http
