#pragma once

#include "common/link/requests.hpp"
#include "common/wire/messages.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>

namespace scanloom::link {

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
