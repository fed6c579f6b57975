#pragma once

#include "common/error/error.hpp"
#include "server/ingest/requests.hpp"
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
/// Queue   "requests of links": at most kRequestsMax for ways and kLocatingMax for where a robot is, from being asked
///         until the reply was written; one more is refused.
/// Thread  any; it must outlive the work on its executor.
class RequestDesk {
public:
    static constexpr std::size_t kRequestsMax = 256;
    static constexpr std::size_t kLocatingMax = 32; ///< more would wait for minutes

    /// Takes the frame of the reply, and a slot to be kept until that was written. Called once, on the executor.
    using Done = std::function<void(std::string frame, std::shared_ptr<const void> slot)>;

    /// `planning` has one thread: a search may take half a gigabyte. `locating` has one, too: where a robot is takes
    /// seconds, and others wait for their ways.
    RequestDesk(boost::asio::any_io_executor planning, boost::asio::any_io_executor locating, Services services,
                std::size_t requests_max = kRequestsMax)
        : planning_(std::move(planning)), locating_(std::move(locating)), services_(services), slots_(requests_max) {}

    /// @return kOverloaded when it cannot be taken now; `done` is not called then.
    [[nodiscard]] std::optional<Error> ask(Asker asker, Request request, Done done);

private:
    [[nodiscard]] wire::Message meet(const Request& request, const Asker& asker) const;

    boost::asio::any_io_executor planning_;
    boost::asio::any_io_executor locating_;
    Services services_;
    sockets::Slots slots_;
    sockets::Slots locating_slots_{kLocatingMax};
};

} // namespace scanloom::ingest
