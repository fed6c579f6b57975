#pragma once

#include "server/sockets/worker_pool.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/strand.hpp>

#include <algorithm>
#include <cstddef>

namespace scanloom::app {

/// The threads of the server, but for those that serve sockets (io_context) and those of the store.
///
/// A pool has one kind of work: short computation, long computation, work at low priority, or work that waits. A class
/// of work that must not run twice at a time has a strand of its pool, and occupies at most one of the pool's threads.
///
/// Short work never waits for long work, and acknowledgements wait for neither. Long work can wait for other long work:
/// five classes share the long pool, so with two cores two of them run and the other three wait until one task ends.
/// More threads would let them share the cores instead, but an idle server should have few threads: at most 16 with two
/// cores.
/// Threads: any thread. join() from the thread that owns the pools.
class ThreadPools {
public:
    /// @param threads    that integrate scans; the same number, but at least two, answers requests and searches maps
    /// @param is_remote  whether the store is a database: then loads and checkpoints wait for answers, not for a disk
    ThreadPools(std::size_t threads, bool is_remote)
        : sessions_(threads), short_(std::max<std::size_t>(2, threads)), long_(std::max<std::size_t>(2, threads)),
          store_(is_remote ? 4 : std::clamp<std::size_t>(threads / 2, 1, 2)),
          checkpoints(is_remote ? loading : strand(loading)) {}

    /// Runs all tasks that were posted, also by tasks, then ends the threads.
    void join() {
        background_.join();
        long_.join();
        short_.join();
        changes_.join(); // its tasks wait for the disk and for sessions
        store_.join();
        sessions_.join();
    }

private:
    template <class Executor>
    static boost::asio::any_io_executor strand(const Executor& executor) {
        return boost::asio::make_strand(executor);
    }

    sockets::WorkerPool sessions_;
    sockets::WorkerPool short_;
    sockets::WorkerPool long_;
    sockets::WorkerPool background_{1, 10}; // robots and viewers are more urgent
    sockets::WorkerPool changes_{2};
    sockets::WorkerPool store_;

public:
    using Executor = boost::asio::any_io_executor;

    const Executor sessions = sessions_.get_executor(); ///< the sessions' strands: everything that changes a map
    const Executor queries = short_.get_executor();     ///< answers from a part of a snapshot
    const Executor metrics = strand(queries);           ///< answers about the process and the store
    const Executor live = strand(queries);              ///< encodes the events of viewers; each event reads a snapshot
    const Executor whole_maps = strand(long_.get_executor());  ///< answers from a whole snapshot, up to a second each
    const Executor log_reading = strand(long_.get_executor()); ///< trajectories and landmarks from the log
    const Executor log_export = strand(long_.get_executor());  ///< logs, piece by piece
    const Executor planning = strand(long_.get_executor());    ///< one search at a time: it may take half a gigabyte
    const Executor locating = strand(long_.get_executor());    ///< relocalization of robots
    const Executor replay = background_.get_executor();        ///< replay jobs, in turns
    const Executor changes = changes_.get_executor(); ///< creates and deletes sessions, makes backups: waits for the
                                                      ///< disk, for sessions and for `loading`
    const Executor loading = store_.get_executor();   ///< loads sessions from the store
    const Executor checkpoints;                       ///< writes checkpoints, to a disk one at a time
};

} // namespace scanloom::app
