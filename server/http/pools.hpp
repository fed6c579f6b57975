#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "server/http/server_config.hpp"

#include <boost/asio/any_io_executor.hpp>

namespace scanloom::http {

/// The thread pools that compute responses, by what the work may wait for. No pool delays another.
enum class Pool {
    kIo,         ///< I/O threads; for work of microseconds that waits for nothing: health, the viewer, cached tiles
    kMetrics,    ///< queries about the process and the store
    kQueries,    ///< computation on a part of a snapshot: tiles, session data
    kWholeMaps,  ///< computation on a whole map, up to a second: digests, images, first rendering of tiles that cover
                 ///< much
    kLogReading, ///< the disk, and computation on a part of a log, for seconds: trajectories, landmarks
    kLogExport,  ///< logs, one piece after another as the client reads them
    kPlanning,   ///< a search in a map, which takes seconds and half a gigabyte in a huge map; one at a time
    kStore,      ///< the disk, or a session's strand: creating and deleting sessions, making backups
    kImport,     ///< the threads of kStore, for requests with a large body
};

/// The executors of the pools. A pool that waits must not share an executor with the work that it waits for: deleting a
/// session waits for the executor of the sessions.
struct Executors {
    boost::asio::any_io_executor metrics;
    boost::asio::any_io_executor queries;
    boost::asio::any_io_executor whole_maps;
    boost::asio::any_io_executor log_reading;
    boost::asio::any_io_executor log_export;
    boost::asio::any_io_executor planning;
    boost::asio::any_io_executor store;
    boost::asio::any_io_executor live; ///< not a pool; encodes the events of live viewers
};

/// The pools and the limits on the number of requests that use them.
/// Threads: any thread.
class Pools {
public:
    /// Held by a request while it counts.
    using Permit = limits::Semaphore::Permit;

    Pools(Executors executors, const ServerConfig& config);

    [[nodiscard]] const Executors& executors() const noexcept { return executors_; }

    /// @param pool  not Pool::kIo
    [[nodiscard]] const boost::asio::any_io_executor& executor_of(Pool pool) const noexcept;

    /// Takes a permit of a pool. Keep it until the request is answered.
    /// @return the permit; null for a pool without a limit
    /// Errors: kOverloaded if all permits are taken.
    [[nodiscard]] Result<Permit> enter(Pool pool) const;

    /// Takes a permit of the requests that wait for replay jobs.
    /// Errors: kOverloaded if all permits are taken.
    [[nodiscard]] Result<Permit> wait_for_replay() const;

private:
    Executors executors_;
    limits::Semaphore store_;
    limits::Semaphore imports_;
    limits::Semaphore log_readings_;
    limits::Semaphore plans_;
    limits::Semaphore replays_;
};

} // namespace scanloom::http
