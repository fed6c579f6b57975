#include "common/link/requests.hpp"

#include <utility>

namespace scanloom::link {

std::optional<Request> as_request(wire::Message&& message) {
    if (auto* plan = std::get_if<wire::PlanRequest>(&message)) return std::move(*plan);
    if (auto* goal = std::get_if<wire::GoalRequest>(&message)) return std::move(*goal);
    if (auto* coverage = std::get_if<wire::CoverageRequest>(&message)) return std::move(*coverage);
    if (auto* locate = std::get_if<wire::LocateRequest>(&message)) return std::move(*locate);
    return std::nullopt;
}

std::optional<Reply> as_reply(const wire::Message& message) {
    if (const auto* plan = std::get_if<wire::PlanReply>(&message)) return *plan;
    if (const auto* goal = std::get_if<wire::GoalReply>(&message)) return *goal;
    if (const auto* coverage = std::get_if<wire::CoverageReply>(&message)) return *coverage;
    if (const auto* location = std::get_if<wire::LocateReply>(&message)) return *location;
    return std::nullopt;
}

wire::PlanReply reply(const wire::PlanRequest& to, std::uint64_t revision, Result<wire::Path> path) {
    return {to.id, revision, std::move(path)};
}
wire::GoalReply reply(const wire::GoalRequest& to, std::uint64_t revision, Result<wire::Goal> goal) {
    return {to.id, revision, std::move(goal)};
}
wire::CoverageReply reply(const wire::CoverageRequest& to, std::uint64_t revision, Result<wire::Coverage> coverage) {
    return {to.id, revision, std::move(coverage)};
}
wire::LocateReply reply(const wire::LocateRequest& to, std::uint64_t revision, Result<wire::Correction> correction) {
    return {to.id, revision, std::move(correction)};
}

wire::Message refusal_of(const Request& request, const Error& why) {
    return std::visit([&](const auto& kind) -> wire::Message { return reply(kind, 0, why); }, request);
}

} // namespace scanloom::link
