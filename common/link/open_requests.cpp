#include "common/link/open_requests.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::link {
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
