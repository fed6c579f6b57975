#include "server/http/lane.hpp"

#include "server/http/handlers/weave_request.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

#include <variant>

namespace scanloom::http {

Lane lane_of(const Match& match, const Query& query) {
    switch (match.operation) {
    case Operation::kViewer:
    case Operation::kViewerAsset:
    case Operation::kLivez:
    case Operation::kReadyz:
    case Operation::kGetLogin:
    case Operation::kLogin:
    case Operation::kLogout:
    case Operation::kOpenapi: return Lane::kAtOnce;
    case Operation::kMetrics: return Lane::kTelling;
    case Operation::kMapYaml: return asks_for_weaving(query) ? Lane::kWeaving : Lane::kServing;
    case Operation::kDifference:
    case Operation::kDifferencePng: return Lane::kSurvey;
    case Operation::kLandmarks:
    case Operation::kPointsCsv:
    case Operation::kPointsPly:
    case Operation::kTrajectory: return Lane::kPaths;
    case Operation::kLog: return Lane::kLog;
    case Operation::kDigest:
    case Operation::kMapPng:
    case Operation::kMapPgm:
    case Operation::kMapCsv:
    case Operation::kMapNpy: return asks_for_weaving(query) ? Lane::kWeaving : Lane::kSurvey;
    case Operation::kImportMap: return Lane::kImporting;
    case Operation::kFrontiers:
    case Operation::kPlan:
    case Operation::kCoverage:
    case Operation::kAssignGoal: return Lane::kPlanning;
    case Operation::kMakeBackup:
    case Operation::kCreateSession:
    case Operation::kDeleteSession:
    case Operation::kExclude:
    case Operation::kLiftExclusion: return Lane::kChanging;
    default: return Lane::kServing;
    }
}

Lane lane_of(const Request& request) {
    const auto target = parse_target(request.target);
    if (!target) return Lane::kAtOnce;
    const auto routing = find_route(request.method, target->segments);
    const auto* match = std::get_if<Match>(&routing);
    return match == nullptr ? Lane::kAtOnce : lane_of(*match, target->query);
}

} // namespace scanloom::http
