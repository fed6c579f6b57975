#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
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

/// Builds the reply to a request.
/// @param to        the request; the reply has its id
/// @param revision  of the session's maps that were used
/// @param result    of the kind that the request asks for (metres and radians, map frame), or why there is none
template <class Kind>
[[nodiscard]] typename Kind::Reply reply(const Kind& to, std::uint64_t revision, decltype(Kind::Reply::result) result) {
    return {to.id, revision, std::move(result)};
}

/// Returns the reply that refuses the request with `why`.
/// @param request  the reply has its kind and its id
/// @param why      code and message of the reply
[[nodiscard]] wire::Message refusal_of(const Request& request, const Error& why);

/// Receives the reply to a request.
using Answered = std::function<void(const Reply&)>;

/// Requests that have no reply yet, with ids that this class sets. Pre of each request: points are finite and within
/// common/scan/limits.hpp.
///
///  They outlive links: a request sent on a link that broke is sent again.
/// Threads: one at a time.
class OpenRequests {
public:
    static constexpr std::size_t kMax = 4; ///< the most that a server processes at a time

    /// Adds a request to be sent.
    /// @param request   its id is replaced
    /// @param answered  called once, from answer(), unless the request is abandoned first
    /// @return the request's id, or nullopt if kMax requests are open; then it is not added
    [[nodiscard]] std::optional<std::uint64_t> add(Request request, Answered answered);

    /// Drops the callback of a request. An unsent request is never sent. The server counts a sent one as open until its
    /// reply was read or the link has ended.
    /// @param id  what add() returned; unknown ids are ignored
    void abandon(std::uint64_t id);

    /// Marks all requests as unsent after a link has ended, and forgets the abandoned ones.
    void rewind();

    /// Returns the next request to send, in the order of add(), and counts it as sent.
    [[nodiscard]] std::optional<wire::Message> next();

    /// Passes a reply to the callback of its request, which may add a request at once.
    /// @param message  any message from the server
    /// @return false if the message is not a reply to an open request
    [[nodiscard]] bool answer(const wire::Message& message);

    /// Returns whether a LocateRequest was sent on the current link and is not answered yet.
    [[nodiscard]] bool is_locating() const;

private:
    struct Open {
        Request request;
        Answered answered; ///< empty: abandoned
    };

    std::map<std::uint64_t, Open> open_; // by id, which increases
    std::uint64_t newest_ = 0;           // id
    std::uint64_t sent_ = 0;             // up to this id, on the current link
};

} // namespace scanloom::link
