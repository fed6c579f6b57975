#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <cstdint>
#include <optional>
#include <variant>

/// Requests that robots send on their links, and the replies. Source: proto/scanloom/v1/frame.proto.
namespace scanloom::link {

/// A request of a robot to the server.
using Request = std::variant<wire::PlanRequest, wire::GoalRequest, wire::CoverageRequest, wire::LocateRequest>;

/// The reply to a request, of the same kind.
using Reply = std::variant<wire::PlanReply, wire::GoalReply, wire::CoverageReply, wire::LocateReply>;

/// Moves the request out of the message. Returns nullopt, and leaves the message unchanged, if it is not a request.
/// @param message  any message
[[nodiscard]] std::optional<Request> as_request(wire::Message&& message);

/// Copies the reply out of the message. Returns nullopt if the message is not a reply.
/// @param message  any message
[[nodiscard]] std::optional<Reply> as_reply(const wire::Message& message);

/// Build the reply to each kind of request.
/// @param to        the request; the reply has its id
/// @param revision  of the session's maps that were used
/// @param path      metres, map frame; or the error that the reply reports
[[nodiscard]] wire::PlanReply reply(const wire::PlanRequest& to, std::uint64_t revision, Result<wire::Path> path);
/// Builds the reply to a request for a goal.
/// @param to        the request; the reply has its id
/// @param revision  of the session's maps that were used
/// @param goal      metres, map frame; or the error that the reply reports
[[nodiscard]] wire::GoalReply reply(const wire::GoalRequest& to, std::uint64_t revision, Result<wire::Goal> goal);
/// Builds the reply to a request for a path that covers free ground.
/// @param to        the request; the reply has its id
/// @param revision  of the session's maps that were used
/// @param coverage  metres, map frame; or the error that the reply reports
[[nodiscard]] wire::CoverageReply reply(const wire::CoverageRequest& to, std::uint64_t revision,
                                        Result<wire::Coverage> coverage);
/// Builds the reply to a request for the robot's pose.
/// @param to          the request; the reply has its id
/// @param revision    of the session's maps that were used
/// @param correction  T_map_odom with its certainty; or the error that the reply reports
[[nodiscard]] wire::LocateReply reply(const wire::LocateRequest& to, std::uint64_t revision,
                                      Result<wire::Correction> correction);

/// Returns the reply that refuses the request with `why`.
/// @param request  the reply has its kind and its id
/// @param why      code and message of the reply
[[nodiscard]] wire::Message refusal_of(const Request& request, const Error& why);

} // namespace scanloom::link
