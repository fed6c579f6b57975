#pragma once

#include "common/link/requests.hpp"
#include "common/wire/messages.hpp"
#include "server/guide/goal_book.hpp"
#include "server/guide/locator.hpp"
#include "server/session/session.hpp"
#include "server/session/session_registry.hpp"

#include <atomic>
#include <memory>

/// Replies to the requests that robots send on their links.
namespace scanloom::ingest {

/// The robot that sent a request.
struct Asker {
    std::shared_ptr<session::Session> session;
    RobotIndex robot = 0;
    /// Set when the link is closed, so that the reply is no longer needed.
    std::shared_ptr<const std::atomic<bool>> is_gone = std::make_shared<const std::atomic<bool>>(false);
};

/// The objects that answer requests. All outlive this struct and its copies.
struct Services {
    guide::GoalBook& goals;
    guide::Locator& locator;
    const session::SessionRegistry& sessions;
};

/// Answers the request from the session's newest maps. Takes milliseconds; seconds if the maps are huge or the robot is
/// to be relocalized.
/// Post: the reply fits into one frame.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] wire::Message reply_to(const link::Request& request, const Asker& asker, const Services& services);

} // namespace scanloom::ingest
