#include "server/http/routes.hpp"

#include "server/http/handlers/handlers.hpp"

#include <array>
#include <utility>

namespace scanloom::http {

std::span<const Route> routes() noexcept {
    using enum Method;
    using enum Access;
    using enum Pool;
    using enum Sessions;
    // clang-format off
    // Query parameters. Those of whole maps include every setting of a session.
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
    static constexpr std::string_view kTrajectory[] = {"since", "times"};
    static constexpr std::string_view kMapFile[] = {"layer", "bbox", "weave", "until",
#define SCANLOOM_SETTING(type, name, ...) #name,
#include "common/scan/settings.def"
    };
    static constexpr std::string_view kDigest[] = {"layer", "weave", "until",
#define SCANLOOM_SETTING(type, name, ...) #name,
#include "common/scan/settings.def"
    };
    static constexpr auto kRoutes = std::to_array<Route>({
        // method  path, name
        // access   pool         sessions parameters, handler
        {kGet,     "/", "viewer",
         kOpen,   kIo,         kUnused, kAnyParameters, get_viewer},
        {kGet,     "/assets/{file}", "viewerAsset",
         kOpen,   kIo,         kUnused, {}, get_viewer_asset},
        {kGet,     "/livez", "livez",
         kOpen,   kIo,         kUnused, {}, get_livez},
        {kGet,     "/readyz", "readyz",
         kOpen,   kIo,         kUnused, {}, get_readyz},
        {kGet,     "/metrics", "metrics",
         kServer, kMetrics,    kUnused, {}, get_metrics},
        {kGet,     "/openapi.json", "openapi",
         kOpen,   kIo,         kUnused, {}, get_openapi},
        {kGet,     "/api/v1/login", "getLogin",
         kOpen,   kIo,         kUnused, {}, get_login},
        {kPost,    "/api/v1/login", "login",
         kOpen,   kIo,         kUnused, {}, post_login},
        {kDelete,  "/api/v1/login", "logout",
         kOpen,   kIo,         kUnused, {}, delete_login},
        {kGet,     "/api/v1/backups", "listBackups",
         kBackup, kQueries,    kUnused, {}, list_backups},
        {kPost,    "/api/v1/backups", "makeBackup",
         kBackup, kStore,      kUnused, {}, make_backup},
        {kGet,     "/api/v1/sessions", "listSessions",
         kList,   kQueries,    kListed, kPage, list_sessions},
        {kPost,    "/api/v1/sessions", "createSession",
         kCreate, kStore,      kListed, {}, create_session},
        {kGet,     "/api/v1/sessions/{session}", "getSession",
         kRead,   kQueries,    kListed, {}, get_session},
        {kDelete,  "/api/v1/sessions/{session}", "deleteSession",
         kChange, kStore,      kListed, {}, delete_session},
        {kPostForm,"/api/v1/sessions/{session}/import", "importMap",
         kChange, kImport,     kListed, {}, import_map},
        {kPost,    "/api/v1/sessions/{session}/exclude", "excludeScans",
         kChange, kStore,      kListed, {}, exclude_scans},
        {kGet,     "/api/v1/sessions/{session}/exclusions", "listExclusions",
         kRead,   kQueries,    kListed, {}, list_exclusions},
        {kDelete,  "/api/v1/sessions/{session}/exclusions/{exclusion}", "liftExclusion",
         kChange, kStore,      kListed, {}, lift_exclusion},
        {kGet,     "/api/v1/sessions/{session}/tiles/{layer}/{z}/{x}/{y}.png", "tilePng",
         kRead,   kIo,         kLoaded, kTile, get_tile_png},
        {kGet,     "/api/v1/sessions/{session}/tiles/{layer}/{z}/{x}/{y}.bin", "tileBin",
         kRead,   kIo,         kLoaded, kTile, get_tile_bin},
        {kGet,     "/api/v1/sessions/{session}/tiles/{layer}.json", "tileJson",
         kRead,   kQueries,    kLoaded, kJob, get_tilejson},
        {kGet,     "/api/v1/sessions/{session}/changes", "changes",
         kRead,   kQueries,    kLoaded, kChanges, get_changes},
        {kGet,     "/api/v1/sessions/{session}/map.png", "mapPng",
         kRead,   kWholeMaps,  kLoaded, kMapFile, get_map_png},
        {kGet,     "/api/v1/sessions/{session}/map.pgm", "mapPgm",
         kRead,   kWholeMaps,  kLoaded, kMapFile, get_map_pgm},
        {kGet,     "/api/v1/sessions/{session}/map.yaml", "mapYaml",
         kRead,   kQueries,    kLoaded, kMapFile, get_map_yaml},
        {kGet,     "/api/v1/sessions/{session}/map.csv", "mapCsv",
         kRead,   kWholeMaps,  kLoaded, kMapFile, get_map_csv},
        {kGet,     "/api/v1/sessions/{session}/map.npy", "mapNpy",
         kRead,   kWholeMaps,  kLoaded, kMapFile, get_map_npy},
        {kGet,     "/api/v1/sessions/{session}/digest", "digest",
         kRead,   kWholeMaps,  kLoaded, kDigest, get_digest},
        {kGet,     "/api/v1/sessions/{session}/difference", "difference",
         kRead,   kWholeMaps,  kLoaded, kDifference, get_difference},
        {kGet,     "/api/v1/sessions/{session}/difference.png", "differencePng",
         kRead,   kWholeMaps,  kLoaded, kDifference, get_difference_png},
        {kGet,     "/api/v1/sessions/{session}/trajectory.geojson", "trajectory",
         kRead,   kLogReading, kLoaded, kTrajectory, get_trajectory},
        {kGet,     "/api/v1/sessions/{session}/landmarks.geojson", "landmarks",
         kRead,   kLogReading, kLoaded, kLandmarks, get_landmarks},
        {kGet,     "/api/v1/sessions/{session}/points.csv", "pointsCsv",
         kRead,   kLogReading, kLoaded, kPoints, get_points_csv},
        {kGet,     "/api/v1/sessions/{session}/points.ply", "pointsPly",
         kRead,   kLogReading, kLoaded, kPoints, get_points_ply},
        {kGet,     "/api/v1/sessions/{session}/frontiers.geojson", "frontiers",
         kRead,   kPlanning,   kLoaded, kFrontiers, get_frontiers},
        {kPost,    "/api/v1/sessions/{session}/plan", "plan",
         kRead,   kPlanning,   kLoaded, kJob, post_plan},
        {kPost,    "/api/v1/sessions/{session}/coverage", "coverage",
         kRead,   kPlanning,   kLoaded, kJob, post_coverage},
        {kGet,     "/api/v1/sessions/{session}/goal", "goal",
         kRead,   kQueries,    kLoaded, kRobot, get_goal},
        {kPost,    "/api/v1/sessions/{session}/goal", "assignGoal",
         kGuide,  kPlanning,   kLoaded, kJob, assign_goal},
        {kGet,     "/api/v1/sessions/{session}/goals.geojson", "goals",
         kRead,   kQueries,    kLoaded, {}, get_goals},
        {kGet,     "/api/v1/sessions/{session}/weave", "listWeaves",
         kRead,   kQueries,    kLoaded, {}, list_weaves},
        {kPost,    "/api/v1/sessions/{session}/weave", "startWeave",
         kRead,   kQueries,    kLoaded, {}, start_weave},
        {kGet,     "/api/v1/sessions/{session}/weave/{weave}", "getWeave",
         kRead,   kQueries,    kLoaded, {}, get_weave},
        {kDelete,  "/api/v1/sessions/{session}/weave/{weave}", "deleteWeave",
         kChange, kQueries,    kLoaded, {}, delete_weave},
        {kGet,     "/api/v1/sessions/{session}/log", "getLog",
         kRead,   kLogExport,  kLoaded, kLog, get_log},
        {kGet,     "/api/v1/sessions/{session}/live", "live",
         kRead,   kQueries,    kLoaded, {}, get_live},
    });
    // clang-format on
    return kRoutes;
}

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
