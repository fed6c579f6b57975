#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/guide/goal_book.hpp"
#include "server/guide/locator.hpp"
#include "server/session/session.hpp"
#include "server/session/session_registry.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <variant>

/// What robots ask for on their links, and the replies.
namespace scanloom::ingest {

using Request = std::variant<wire::PlanRequest, wire::GoalRequest, wire::CoverageRequest, wire::LocateRequest>;

/// Nothing when the message is no request, which it then still is.
[[nodiscard]] std::optional<Request> as_request(wire::Message&& message);

/// Who asks.
struct Asker {
    std::shared_ptr<session::Session> session;
    RobotIndex robot = 0;
    /// Set when its link is closed: nobody waits for the reply any more.
    std::shared_ptr<const std::atomic<bool>> is_gone = std::make_shared<const std::atomic<bool>>(false);
};

/// Who meets them. All outlive whoever has this.
struct Services {
    guide::GoalBook& goals;
    guide::Locator& locator;
    const session::SessionRegistry& sessions;
};

/// Searches the session's newest maps: takes milliseconds, and seconds where they are huge.
/// Post  the reply fits a frame.
[[nodiscard]] wire::Message reply_to(const Request& request, const Asker& asker, const Services& services);

/// The reply to a request that is not met.
[[nodiscard]] wire::Message refusal_of(const Request& request, const Error& why);

} // namespace scanloom::ingest
