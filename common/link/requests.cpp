#include "common/link/requests.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace scanloom::link {
namespace {

template <class Kind, class Kinds>
constexpr bool kIsOneOf = false;
template <class Kind, class... Kinds>
constexpr bool kIsOneOf<Kind, std::variant<Kinds...>> = (std::is_same_v<Kind, Kinds> || ...);

/// Returns the message as one of the kinds that `Kinds`, a variant, may hold; nullopt if it is of another kind.
/// @param message  a wire::Message; moved from only if it is of such a kind and not const
template <class Kinds, class Message>
std::optional<Kinds> as_one_of(Message& message) {
    return std::visit(
        [](auto& kind) -> std::optional<Kinds> {
            if constexpr (kIsOneOf<std::remove_cvref_t<decltype(kind)>, Kinds>) {
                return std::move(kind);
            } else {
                return std::nullopt;
            }
        },
        message);
}

} // namespace

std::optional<Request> as_request(wire::Message&& message) { return as_one_of<Request>(message); }

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
    const auto reply = as_one_of<Reply>(message);
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
