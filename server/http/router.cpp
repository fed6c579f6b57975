#include "server/http/router.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>

namespace scanloom::http {
namespace {

constexpr std::array kRoutes = {
    Route{"GET", "/", Operation::kViewer},
    Route{"GET", "/assets/{file}", Operation::kViewerAsset},
    Route{"GET", "/livez", Operation::kLivez},
    Route{"GET", "/readyz", Operation::kReadyz},
    Route{"GET", "/metrics", Operation::kMetrics},
    Route{"GET", "/openapi.json", Operation::kOpenapi},
    Route{"GET", "/api/v1/login", Operation::kGetLogin},
    Route{"POST", "/api/v1/login", Operation::kLogin},
    Route{"DELETE", "/api/v1/login", Operation::kLogout},
    Route{"GET", "/api/v1/backups", Operation::kListBackups},
    Route{"POST", "/api/v1/backups", Operation::kMakeBackup},
    Route{"GET", "/api/v1/sessions", Operation::kListSessions},
    Route{"POST", "/api/v1/sessions", Operation::kCreateSession},
    Route{"GET", "/api/v1/sessions/{session}", Operation::kGetSession},
    Route{"DELETE", "/api/v1/sessions/{session}", Operation::kDeleteSession},
    Route{"POST", "/api/v1/sessions/{session}/import", Operation::kImportMap},
    Route{"GET", "/api/v1/sessions/{session}/tiles/{layer}/{z}/{x}/{y}.png", Operation::kTilePng},
    Route{"GET", "/api/v1/sessions/{session}/tiles/{layer}/{z}/{x}/{y}.bin", Operation::kTileBin},
    Route{"GET", "/api/v1/sessions/{session}/tiles/{layer}.json", Operation::kTileJson},
    Route{"GET", "/api/v1/sessions/{session}/changes", Operation::kChanges},
    Route{"GET", "/api/v1/sessions/{session}/map.png", Operation::kMapPng},
    Route{"GET", "/api/v1/sessions/{session}/map.pgm", Operation::kMapPgm},
    Route{"GET", "/api/v1/sessions/{session}/map.yaml", Operation::kMapYaml},
    Route{"GET", "/api/v1/sessions/{session}/map.csv", Operation::kMapCsv},
    Route{"GET", "/api/v1/sessions/{session}/map.npy", Operation::kMapNpy},
    Route{"GET", "/api/v1/sessions/{session}/digest", Operation::kDigest},
    Route{"GET", "/api/v1/sessions/{session}/difference", Operation::kDifference},
    Route{"GET", "/api/v1/sessions/{session}/difference.png", Operation::kDifferencePng},
    Route{"GET", "/api/v1/sessions/{session}/trajectory.geojson", Operation::kTrajectory},
    Route{"GET", "/api/v1/sessions/{session}/frontiers.geojson", Operation::kFrontiers},
    Route{"GET", "/api/v1/sessions/{session}/landmarks.geojson", Operation::kLandmarks},
    Route{"GET", "/api/v1/sessions/{session}/points.csv", Operation::kPointsCsv},
    Route{"GET", "/api/v1/sessions/{session}/points.ply", Operation::kPointsPly},
    Route{"POST", "/api/v1/sessions/{session}/plan", Operation::kPlan},
    Route{"POST", "/api/v1/sessions/{session}/coverage", Operation::kCoverage},
    Route{"GET", "/api/v1/sessions/{session}/goal", Operation::kGoal},
    Route{"POST", "/api/v1/sessions/{session}/goal", Operation::kAssignGoal},
    Route{"GET", "/api/v1/sessions/{session}/goals.geojson", Operation::kGoals},
    Route{"GET", "/api/v1/sessions/{session}/log", Operation::kLog},
    Route{"GET", "/api/v1/sessions/{session}/live", Operation::kLive},
    Route{"GET", "/api/v1/sessions/{session}/weave", Operation::kListWeaves},
    Route{"POST", "/api/v1/sessions/{session}/weave", Operation::kStartWeave},
    Route{"GET", "/api/v1/sessions/{session}/weave/{weave}", Operation::kGetWeave},
    Route{"DELETE", "/api/v1/sessions/{session}/weave/{weave}", Operation::kDeleteWeave},
    Route{"POST", "/api/v1/sessions/{session}/exclude", Operation::kExclude},
    Route{"GET", "/api/v1/sessions/{session}/exclusions", Operation::kListExclusions},
    Route{"DELETE", "/api/v1/sessions/{session}/exclusions/{exclusion}", Operation::kLiftExclusion},
};

/// Removes the first segment from a pattern that begins with '/', and returns it.
std::string_view take_segment(std::string_view& pattern) {
    pattern.remove_prefix(1);
    const auto segment = pattern.substr(0, pattern.find('/'));
    pattern.remove_prefix(segment.size());
    return segment;
}

bool match_segment(std::string_view pattern, const std::string& segment, Arguments& arguments) {
    if (!pattern.starts_with('{')) return pattern == segment;
    const auto close = pattern.find('}');
    const auto ending = pattern.substr(close + 1);
    if (segment.size() <= ending.size() || !segment.ends_with(ending)) return false;
    arguments.add(pattern.substr(1, close - 1), segment.substr(0, segment.size() - ending.size()));
    return true;
}

std::optional<Arguments> match(std::string_view pattern, const std::vector<std::string>& segments) {
    Arguments arguments;
    for (const auto& segment : segments) {
        if (pattern.empty() || !match_segment(take_segment(pattern), segment, arguments)) return std::nullopt;
    }
    if (!pattern.empty()) return std::nullopt;
    return arguments;
}

} // namespace

std::span<const Route> routes() noexcept { return kRoutes; }

const std::string& Arguments::operator[](std::string_view name) const {
    const auto found = std::ranges::find(values_, name, &std::pair<std::string_view, std::string>::first);
    assert(found != values_.end());
    return found->second;
}

Routing find_route(std::string_view method, const std::vector<std::string>& segments) {
    std::string allow;
    for (const auto& route : kRoutes) {
        auto arguments = match(route.pattern, segments);
        if (!arguments) continue;
        if (route.method == method || (route.method == "GET" && method == "HEAD")) {
            return Match{route.operation, std::move(*arguments)};
        }
        if (!allow.empty()) allow += ", ";
        allow += route.method == "GET" ? "GET, HEAD" : route.method;
    }
    if (allow.empty()) return NoSuchPath{};
    return MethodNotAllowed{std::move(allow)};
}

} // namespace scanloom::http
