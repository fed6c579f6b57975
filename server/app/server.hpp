#pragma once

#include "common/error/error.hpp"
#include "server/app/descriptors.hpp"
#include "server/app/options.hpp"
#include "server/guard/audit.hpp"
#include "server/guard/gate.hpp"
#include "server/guard/logins.hpp"
#include "server/http/api.hpp"
#include "server/http/server.hpp"
#include "server/ingest/ingest_server.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/background_check.hpp"
#include "server/session/session_registry.hpp"
#include "server/session/weaves.hpp"
#include "server/sockets/worker_pool.hpp"
#include "server/store/backups.hpp"
#include "server/store/reopening_log.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace scanloom::app {

/// The parts of scanloom-server, and what connects them.
///
///   io             sockets: frames and requests come in, answers go out; health and the viewer's files
///   weaving        the sessions' strands: everything that changes a map
///   serving        answers made from a part of a snapshot
///   survey         answers made from a whole snapshot: one at a time, as they may take a second
///   paths          paths of robots, likewise: read from a log where they are long
///   logs           logs, piece by piece
///   reweaving      maps woven once more, with other settings: with a lower priority than all else
///   awaiting       answers that wait for such maps
///   planning       ways through maps, for robots and people: one search at a time
///   locating       robots that ask where they are: one at a time
///   changing       creating and deleting sessions, excluding scans, making backups: waits for the disk and for strands
///   checkpointing  writes checkpoints: waits for the disk
///   reading        sessions that come back to memory: reads them from the store; from time to time, sends idle ones
///   away checking       reads the sessions that the start left in the store: behind all others, at a bounded rate
///   telling        metrics
///   showing        what viewers are told live: one event at a time, as snapshots are read for it
///
/// Thread  open() and run() from the main thread.
class Server {
public:
    /// Opens the store and the ports. Errors: one sentence that says what to do.
    [[nodiscard]] static Result<std::unique_ptr<Server>> open(const ServerOptions& options,
                                                              const ConnectionLimits& limits = {},
                                                              const store::OpenStore& open_log = store::open_rocksdb);

    ~Server();

    /// Recovers the sessions, says that it is ready, serves until SIGTERM or SIGINT, drains. SIGHUP has it read the
    /// tokens and the certificates again.
    /// Errors  kStoreFailed: the sessions cannot be listed, or the store failed meanwhile.
    [[nodiscard]] Result<> run();

private:
    Server(const ServerOptions& options, const ConnectionLimits& limits, std::unique_ptr<store::ReopeningLog> log,
           http::WebFiles web);

    [[nodiscard]] Result<> listen();
    void announce() const;
    void wait_for_signal();
    void tidy_up();
    void tell_of_failed_store();
    void wait_for_hangup();
    void read_tokens_again();
    void read_certificates_again();
    void drain();
    void join_pools();

    ServerOptions options_;
    ConnectionLimits limits_;
    std::unique_ptr<store::ReopeningLog> log_;
    std::unique_ptr<store::Backups> backups_; // null: none are kept
    metrics::Metrics metrics_;
    guard::Gate gate_;
    guard::Audit audit_;
    guard::Logins logins_;
    // The links left open in `io_` hold sessions, whose strands live in `weaving_`: io_ goes first.
    sockets::WorkerPool weaving_;
    sockets::WorkerPool serving_;
    sockets::WorkerPool survey_{1};
    sockets::WorkerPool paths_{1};
    sockets::WorkerPool logs_{1};
    sockets::WorkerPool reweaving_{2};
    sockets::WorkerPool awaiting_{http::ServerConfig{}.weaves_max}; // each only waits
    sockets::WorkerPool planning_{1};
    sockets::WorkerPool locating_{1};
    sockets::WorkerPool changing_{2};
    sockets::WorkerPool checkpointing_{1};
    sockets::WorkerPool reading_{2};
    sockets::WorkerPool checking_{1};
    sockets::WorkerPool telling_{1};
    sockets::WorkerPool showing_{1};
    boost::asio::io_context io_;
    session::SessionRegistry sessions_;
    session::BackgroundCheck check_;
    session::Weaves weaves_;
    guide::GoalBook goals_;
    guide::Locator locator_;
    ingest::RequestDesk desk_;
    http::Api api_;
    std::shared_ptr<sockets::PortTls> robot_tls_; // none: the port speaks plainly, as the next
    std::shared_ptr<sockets::PortTls> http_tls_;
    std::unique_ptr<ingest::IngestServer> ingest_;
    std::shared_ptr<http::Server> http_;
    std::optional<boost::asio::signal_set> signals_;
    boost::asio::signal_set hangup_;
    boost::asio::steady_timer patience_;
    boost::asio::steady_timer weaving_patience_;
    boost::asio::steady_timer tidying_;
    std::atomic<bool> store_has_failed_ = false; // and the log says why
};

} // namespace scanloom::app
