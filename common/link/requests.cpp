#include "common/link/requests.hpp"

#include <algorithm>
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

std::optional<std::uint64_t> OpenRequests::add(Request request, Answered answered) {
    if (open_.size() >= kMax) return std::nullopt;
    const std::uint64_t id = ++newest_;
    std::visit([id](auto& kind) { kind.id = id; }, request);
    open_.emplace(id, Open{std::move(request), std::move(answered)});
    return id;
}

void OpenRequests::abandon(std::uint64_t id) {
    const auto asked = open_.find(id);
    if (asked == open_.end()) return; // it was answered before
    if (id > sent_) {
        open_.erase(asked);
    } else {
        asked->second.answered = nullptr;
    }
}

void OpenRequests::rewind() {
    sent_ = 0;
    std::erase_if(open_, [](const auto& one) { return !one.second.answered; });
}

std::optional<wire::Message> OpenRequests::next() {
    const auto unsent = open_.upper_bound(sent_);
    if (unsent == open_.end()) return std::nullopt;
    sent_ = unsent->first;
    return std::visit([](const auto& kind) -> wire::Message { return kind; }, unsent->second.request);
}

bool OpenRequests::answer(const wire::Message& message) {
    const auto reply = as_reply(message);
    if (!reply) return false;
    const auto asked = open_.find(std::visit([](const auto& kind) { return kind.id; }, *reply));
    const bool is_of_it =
        asked != open_.end() && asked->first <= sent_ && asked->second.request.index() == reply->index();
    if (!is_of_it) return false;
    const auto answered = std::move(asked->second.answered);
    open_.erase(asked);
    if (answered) answered(*reply);
    return true;
}

bool OpenRequests::is_locating() const {
    return std::any_of(open_.begin(), open_.upper_bound(sent_),
                       [](const auto& one) { return std::holds_alternative<wire::LocateRequest>(one.second.request); });
}

} // namespace scanloom::link
