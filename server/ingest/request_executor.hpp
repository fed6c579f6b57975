#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "common/link/requests.hpp"
#include "common/wire/messages.hpp"
#include "server/guidance/goal_assignments.hpp"
#include "server/guidance/locator.hpp"
#include "server/sessions/session.hpp"
#include "server/sessions/session_registry.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::ingest {

/// The robot that sent a request.
struct Requester {
    std::shared_ptr<sessions::Session> session;
    RobotIndex robot = 0;
    /// Set when the link is closed, so that the reply is no longer needed.
    std::shared_ptr<const std::atomic<bool>> is_gone = std::make_shared<const std::atomic<bool>>(false);
};

/// The objects that answer requests. All outlive this struct and its copies.
struct RequestServices {
    guidance::GoalAssignments& goals;
    guidance::Locator& locator;
    const sessions::SessionRegistry& sessions;
};

/// Answers the requests of all links outside the I/O threads, from each session's newest maps. A reply takes
/// milliseconds; seconds if the maps are huge or the robot is to be relocalized.
///
/// Queue: "requests of links": at most kRequestsMax for paths and kLocatingMax for relocalization, from submit() until
///        the reply is written; further ones are refused.
/// Threads: any thread. It must outlive the work on its executors.
class RequestExecutor {
public:
    static constexpr std::size_t kRequestsMax = 256;
    static constexpr std::size_t kLocatingMax = 32; ///< with more, a request would wait for minutes

    /// Receives the frame of the reply, and a permit to be kept until the frame is written. Called once, on the
    /// executor of the request.
    using Done = std::function<void(std::string frame, limits::Semaphore::Permit permit)>;

    /// @param planning      has one thread, because a search may take half a gigabyte of memory
    /// @param locating      has one thread; separate, because a relocalization takes seconds in which planned paths
    ///                      would have to wait
    /// @param requests_max  bound on requests for paths that are not answered yet
    RequestExecutor(boost::asio::any_io_executor planning, boost::asio::any_io_executor locating,
                    RequestServices services, std::size_t requests_max = kRequestsMax)
        : planning_(std::move(planning)), locating_(std::move(locating)), services_(services), permits_(requests_max) {}

    /// Queues a request.
    /// @return kOverloaded if too many requests wait; `done` is not called then
    [[nodiscard]] std::optional<Error> submit(Requester requester, link::Request request, Done done);

private:
    [[nodiscard]] wire::Message answer(const link::Request& request, const Requester& requester) const;

    boost::asio::any_io_executor planning_;
    boost::asio::any_io_executor locating_;
    RequestServices services_;
    limits::Semaphore permits_;
    limits::Semaphore locating_permits_{kLocatingMax};
};

} // namespace scanloom::ingest
