#pragma once

#include "common/error/error.hpp"
#include "server/guide/goal_book.hpp"
#include "server/ingest/requests.hpp"
#include "server/session/session_registry.hpp"
#include "server/sockets/slots.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::ingest {

/// Meets the requests of all links, away from the I/O threads.
///
/// Queue   "requests of links": at most kRequestsMax, from being asked until the reply was written; one more is refused.
/// Thread  any; it must outlive the work on its executor.
class RequestDesk {
public:
    static constexpr std::size_t kRequestsMax = 256;

    /// Takes the frame of the reply, and a slot to be kept until that was written. Called once, on the executor.
    using Done = std::function<void(std::string frame, std::shared_ptr<const void> slot)>;

    /// `planning` has one thread: a search may take half a gigabyte.
    RequestDesk(boost::asio::any_io_executor planning, guide::GoalBook& goals, const session::SessionRegistry& sessions,
                std::size_t requests_max = kRequestsMax)
        : planning_(std::move(planning)), goals_(goals), sessions_(sessions), slots_(requests_max) {}

    /// @return kOverloaded when it cannot be taken now; `done` is not called then.
    [[nodiscard]] std::optional<Error> ask(Asker asker, Request request, Done done);

private:
    [[nodiscard]] wire::Message meet(const Request& request, const Asker& asker) const;

    boost::asio::any_io_executor planning_;
    guide::GoalBook& goals_;
    const session::SessionRegistry& sessions_;
    sockets::Slots slots_;
};

} // namespace scanloom::ingest
