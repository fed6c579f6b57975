#include "server/http/lane.hpp"

#include "server/http/handlers/weave_request.hpp"
#include "server/http/number.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

#include <string>
#include <variant>

namespace scanloom::http {
namespace {

/// A tile of a lower zoom shows more than a thousand native ones.
constexpr int kServedZoomMin = 5;

Lane lane_of_tile(const std::string& zoom) {
    const auto level = parse_integer<int>(zoom);
    return level && *level < kServedZoomMin ? Lane::kSurvey : Lane::kServing;
}

Lane lane_of(const Match& match, const Query& query) {
    switch (match.operation) {
    case Operation::kViewer:
    case Operation::kViewerAsset:
    case Operation::kLivez:
    case Operation::kReadyz:
    case Operation::kOpenapi: return Lane::kAtOnce;
    case Operation::kMetrics: return Lane::kTelling;
    case Operation::kTilePng:
    case Operation::kTileBin: return lane_of_tile(match.arguments["z"]);
    case Operation::kMapYaml: return asks_for_weaving(query) ? Lane::kWeaving : Lane::kServing;
    case Operation::kDifference:
    case Operation::kDifferencePng:
    case Operation::kLog: return Lane::kSurvey;
    case Operation::kDigest:
    case Operation::kMapPng:
    case Operation::kMapPgm:
    case Operation::kMapCsv:
    case Operation::kMapNpy: return asks_for_weaving(query) ? Lane::kWeaving : Lane::kSurvey;
    case Operation::kImportMap: return Lane::kImporting;
    case Operation::kFrontiers:
    case Operation::kPlan:
    case Operation::kCoverage:
    case Operation::kGoal: return Lane::kPlanning;
    case Operation::kCreateSession:
    case Operation::kDeleteSession: return Lane::kChanging;
    default: return Lane::kServing;
    }
}

} // namespace

Lane lane_of(const Request& request) {
    const auto target = parse_target(request.target);
    if (!target) return Lane::kAtOnce;
    const auto routing = find_route(request.method, target->segments);
    const auto* match = std::get_if<Match>(&routing);
    return match == nullptr ? Lane::kAtOnce : lane_of(*match, target->query);
}

} // namespace scanloom::http
