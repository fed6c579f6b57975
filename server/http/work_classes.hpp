#pragma once

#include "common/error/error.hpp"
#include "common/limits/semaphore.hpp"
#include "server/http/server_config.hpp"

#include <boost/asio/any_io_executor.hpp>

namespace scanloom::http {

/// The classes of the work that computes responses. The class decides on which threads of app::ThreadPools a handler
/// runs, and how many requests may run. Two long-running requests of different classes can occupy the whole long pool
/// of a machine with two cores; then the other classes of this pool wait. kIo, kMetrics and kQueries never wait for
/// them.
enum class WorkClass {
    kIo,         ///< I/O threads: work of microseconds that waits for nothing: health, the viewer, cached tiles
    kMetrics,    ///< short pool, one at a time: queries about the process and the store
    kQueries,    ///< short pool: computation on a part of a snapshot: tiles, session data
    kWholeMaps,  ///< long pool, one at a time: computation on a whole map, up to a second: digests, images, first
                 ///< rendering of tiles that cover much
    kLogReading, ///< long pool, one at a time: the disk, and computation on a part of a log, for seconds: trajectories,
                 ///< landmarks
    kLogExport,  ///< long pool, one at a time: logs, one piece after another as the client reads them
    kPlanning,   ///< long pool, one at a time: a search in a map, which takes seconds and half a gigabyte in a huge map
    kStore,      ///< changes pool: the disk, or a session's strand: creating and deleting sessions, making backups
    kImport,     ///< changes pool: as kStore, for requests with a large body, with a limit of their own
};

/// The executors of the classes. Work that waits must not share an executor with the work that it waits for: deleting a
/// session waits for the executor of the sessions.
struct Executors {
    boost::asio::any_io_executor metrics;
    boost::asio::any_io_executor queries;
    boost::asio::any_io_executor whole_maps;
    boost::asio::any_io_executor log_reading;
    boost::asio::any_io_executor log_export;
    boost::asio::any_io_executor planning;
    boost::asio::any_io_executor store;
    boost::asio::any_io_executor live; ///< of no class; encodes the events of live viewers
};

/// The executor and the limit on the number of requests of each class.
/// Threads: any thread.
class WorkClasses {
public:
    /// Held by a request while it counts.
    using Permit = limits::Semaphore::Permit;

    WorkClasses(Executors executors, const ServerConfig& config);

    [[nodiscard]] const Executors& executors() const noexcept { return executors_; }

    /// @param work  not WorkClass::kIo
    [[nodiscard]] const boost::asio::any_io_executor& executor_of(WorkClass work) const noexcept;

    /// Takes a permit of a class. Keep it until the request is answered.
    /// @return the permit; null for a class without a limit
    /// Errors: kOverloaded if all permits are taken.
    [[nodiscard]] Result<Permit> enter(WorkClass work) const;

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
