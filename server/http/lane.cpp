#include "server/http/lane.hpp"

#include "server/http/router.hpp"
#include "server/http/target.hpp"

#include <variant>

namespace scanloom::http {
namespace {

Lane lane_of(Operation operation) {
    switch (operation) {
    case Operation::kViewer:
    case Operation::kViewerAsset:
    case Operation::kLivez:
    case Operation::kReadyz:
    case Operation::kOpenapi: return Lane::kAtOnce;
    case Operation::kMetrics: return Lane::kTelling;
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
    return match == nullptr ? Lane::kAtOnce : lane_of(match->operation);
}

} // namespace scanloom::http
