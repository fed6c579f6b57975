#pragma once

#include "common/error/error.hpp"
#include "server/app/options.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/thread_pools.hpp"
#include "server/auth/audit_log.hpp"
#include "server/auth/authenticator.hpp"
#include "server/auth/login_sessions.hpp"
#include "server/http/api.hpp"
#include "server/http/server.hpp"
#include "server/ingest/ingest_server.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sessions/background_check.hpp"
#include "server/sessions/replay_jobs.hpp"
#include "server/sessions/session_registry.hpp"
#include "server/store/backups.hpp"
#include "server/store/open_store.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include <atomic>
#include <memory>
#include <optional>

namespace scanloom::app {

/// Creates and connects the parts of scanloom-server, and owns its threads.
///
/// The io_context serves the sockets: it receives frames and requests, sends answers, and answers what is at hand
/// (health, the viewer's files, cached tiles). ThreadPools does the rest.
/// Threads: open() and run() from the main thread.
class Server {
public:
    /// Opens the store and the ports.
    /// Errors: those of the parts that cannot be opened; the message is one sentence that says what to do.
    [[nodiscard]] static Result<std::unique_ptr<Server>> open(const ServerOptions& options,
                                                              const ConnectionLimits& limits = {},
                                                              const store::OpenStore& open_log = store::open_store);

    ~Server();

    /// Recovers the sessions, reports that the server is ready, serves until SIGTERM, SIGINT or a request to drain, and
    /// drains. On SIGHUP it reads the tokens and the certificates again.
    /// Errors: kStoreFailed if the sessions cannot be listed, or the store has failed since.
    [[nodiscard]] Result<> run();

private:
    Server(const ServerOptions& options, const ConnectionLimits& limits, std::unique_ptr<store::ScanLog> log);

    [[nodiscard]] Result<> listen(http::WebFiles web);
    void enter_addresses(const std::string& robots);
    void announce() const;
    void wait_for_signal();
    void run_maintenance();
    void maintain_later();
    void log_store_failure();
    void wait_for_hangup();
    void read_tokens_again();
    void read_certificates_again();
    void drain();
    void end_pools();

    ServerOptions options_;
    ConnectionLimits limits_;
    std::unique_ptr<store::ScanLog> log_;
    std::unique_ptr<store::Backups> backups_; // null: backups are disabled
    metrics::Metrics metrics_;
    auth::Authenticator authenticator_;
    auth::AuditLog audit_;
    auth::LoginSessions logins_;
    // Links left open in `io_` hold sessions whose strands run on `pools_`, so io_ must be destroyed first.
    ThreadPools pools_;
    boost::asio::io_context io_;
    sessions::SessionRegistry sessions_;
    sessions::BackgroundCheck check_;
    sessions::ReplayJobs replay_jobs_;
    guidance::GoalAssignments goals_;
    guidance::Locator locator_;
    ingest::RequestExecutor requests_;
    std::optional<http::WorkClasses> http_work_;
    std::unique_ptr<http::Services> services_; // of api_
    std::optional<http::Api> api_;
    std::shared_ptr<sockets::PortTls> robot_tls_; // null: the port does not use TLS; so for http_tls_
    std::shared_ptr<sockets::PortTls> http_tls_;
    std::unique_ptr<ingest::IngestServer> ingest_;
    std::shared_ptr<http::Server> http_;
    std::optional<boost::asio::signal_set> signals_;
    boost::asio::signal_set hangup_;
    boost::asio::steady_timer stop_timeout_;
    boost::asio::steady_timer integration_timeout_;
    boost::asio::steady_timer tidying_;
    std::atomic<bool> is_draining_ = false;
    std::atomic<bool> store_has_failed_ = false; // and the failure was logged
};

} // namespace scanloom::app
