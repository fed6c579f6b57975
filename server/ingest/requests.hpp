#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"
#include "server/guide/goal_book.hpp"
#include "server/planning/coverage.hpp"
#include "server/session/session.hpp"

#include <memory>
#include <optional>
#include <variant>

/// What robots ask for on their links, and the replies.
namespace scanloom::ingest {

using Request = std::variant<wire::PlanRequest, wire::GoalRequest, wire::CoverageRequest>;

/// Nothing when the message is no request, which it then still is.
[[nodiscard]] std::optional<Request> as_request(wire::Message&& message);

/// Who asks.
struct Asker {
    std::shared_ptr<session::Session> session;
    RobotIndex robot = 0;
};

/// Searches the session's newest maps: takes milliseconds, and seconds where they are huge.
/// Post  the reply fits a frame.
[[nodiscard]] wire::Message reply_to(const Request& request, const Asker& asker, guide::GoalBook& goals,
                                     const planning::MayGoOn& may_go_on);

/// The reply to a request that is not met.
[[nodiscard]] wire::Message refusal_of(const Request& request, const Error& why);

} // namespace scanloom::ingest
