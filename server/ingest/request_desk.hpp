#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "server/ingest/requests.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::ingest {

/// Answers the requests of all links outside the I/O threads.
///
/// Queue: "requests of links": at most kRequestsMax for paths and kLocatingMax for relocalization, from ask() until the
///        reply is written; further ones are refused.
/// Threads: any thread. It must outlive the work on its executors.
class RequestDesk {
public:
    static constexpr std::size_t kRequestsMax = 256;
    static constexpr std::size_t kLocatingMax = 32; ///< with more, a request would wait for minutes

    /// Receives the frame of the reply, and a slot to be kept until the frame is written. Called once, on the executor
    /// of the request.
    using Done = std::function<void(std::string frame, std::shared_ptr<const void> slot)>;

    /// @param planning      has one thread, because a search may take half a gigabyte of memory
    /// @param locating      has one thread; separate, because a relocalization takes seconds in which planned paths
    ///                      would have to wait
    /// @param requests_max  bound on requests for paths that are not answered yet
    RequestDesk(boost::asio::any_io_executor planning, boost::asio::any_io_executor locating, Services services,
                std::size_t requests_max = kRequestsMax)
        : planning_(std::move(planning)), locating_(std::move(locating)), services_(services), slots_(requests_max) {}

    /// Queues a request.
    /// @return kOverloaded if too many requests wait; `done` is not called then
    [[nodiscard]] std::optional<Error> ask(Asker asker, link::Request request, Done done);

private:
    [[nodiscard]] wire::Message meet(const link::Request& request, const Asker& asker) const;

    boost::asio::any_io_executor planning_;
    boost::asio::any_io_executor locating_;
    Services services_;
    limits::Semaphore slots_;
    limits::Semaphore locating_slots_{kLocatingMax};
};

} // namespace scanloom::ingest
