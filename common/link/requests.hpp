#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <cstdint>
#include <optional>
#include <variant>

/// Requests that robots send on their links, and the replies. Source: proto/scanloom/v1/frame.proto.
namespace scanloom::link {

using Request = std::variant<wire::PlanRequest, wire::GoalRequest, wire::CoverageRequest, wire::LocateRequest>;

/// The reply to a request, of the same kind.
using Reply = std::variant<wire::PlanReply, wire::GoalReply, wire::CoverageReply, wire::LocateReply>;

/// Moves the request out of the message. Returns nullopt, and leaves the message unchanged, if it is not a request.
[[nodiscard]] std::optional<Request> as_request(wire::Message&& message);

/// Copies the reply out of the message. Returns nullopt if the message is not a reply.
[[nodiscard]] std::optional<Reply> as_reply(const wire::Message& message);

/// Build the reply to each kind of request.
[[nodiscard]] wire::PlanReply reply(const wire::PlanRequest& to, std::uint64_t revision, Result<wire::Path> path);
[[nodiscard]] wire::GoalReply reply(const wire::GoalRequest& to, std::uint64_t revision, Result<wire::Goal> goal);
[[nodiscard]] wire::CoverageReply reply(const wire::CoverageRequest& to, std::uint64_t revision,
                                        Result<wire::Coverage> coverage);
[[nodiscard]] wire::LocateReply reply(const wire::LocateRequest& to, std::uint64_t revision,
                                      Result<wire::Correction> correction);

/// Returns the reply that refuses the request with `why`.
[[nodiscard]] wire::Message refusal_of(const Request& request, const Error& why);

} // namespace scanloom::link
