#pragma once

#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <variant>

namespace scanloom::robot {

/// What a robot may ask of the server: see proto/scanloom/v1/frame.proto. Pre: points are finite and within
/// common/scan/limits.hpp. The id is given when it is asked.
using Request = std::variant<wire::PlanRequest, wire::GoalRequest, wire::CoverageRequest, wire::LocateRequest>;

/// The reply to a request is of the same kind.
using Reply = std::variant<wire::PlanReply, wire::GoalReply, wire::CoverageReply, wire::LocateReply>;
using Answered = std::function<void(const Reply&)>;

/// Requests that are not answered yet. They outlive links: what was asked on a link that broke is asked again.
/// Thread  one at a time.
class OpenRequests {
public:
    static constexpr std::size_t kMax = 4; ///< what a server meets at a time

    /// @return its id; nothing when kMax are open, and nothing is asked then.
    [[nodiscard]] std::optional<std::uint64_t> add(Request request, Answered answered);

    /// Nobody waits for the reply any more. What was not sent never is; of what was, the server counts one until its
    /// reply was read, or the link is gone.
    void abandon(std::uint64_t id);

    /// The link is gone: all are unsent, and those that were abandoned are forgotten.
    void rewind();

    /// The next to be sent, in the order in which they were asked; counts as sent from then on.
    [[nodiscard]] std::optional<wire::Message> next();

    /// Hands a reply to whoever asked, who may ask again at once.
    /// @return false for a message that answers none of them.
    [[nodiscard]] bool answer(const wire::Message& message);

    /// Whether the server was asked on the present link where the robot is, and has not answered yet.
    [[nodiscard]] bool is_locating() const;

private:
    struct Open {
        Request request;
        Answered answered; ///< none: abandoned
    };

    std::map<std::uint64_t, Open> open_; // by id, which grows
    std::uint64_t newest_ = 0;           // id
    std::uint64_t sent_ = 0;             // up to this id, on the present link
};

} // namespace scanloom::robot
