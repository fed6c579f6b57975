#include "server/app/server.hpp"

#include "common/app/program.hpp"
#include "server/app/node.hpp"
#include "server/app/service_manager.hpp"
#include "server/auth/token_file.hpp"
#include "server/sockets/worker_pool.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <thread>
#include <vector>

namespace scanloom::app {
namespace asio = boost::asio;
namespace {

/// Time limit of the whole shutdown; clients that have not read their last answer by then are disconnected. Service
/// managers kill servers that take longer than ten seconds to stop.
constexpr auto kStopTimeout = std::chrono::seconds(9);

/// Time limit for integrating and acknowledging submitted scans at shutdown. The remaining scans are in the log for the
/// next start, or the robots still have them.
constexpr auto kIntegrationTimeout = std::chrono::seconds(5);

/// Interval of run_maintenance(), and so the longest delay before an idle session is evicted.
constexpr auto kTidyEvery = std::chrono::seconds(1);

double seconds_since_epoch() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Returns the number of I/O threads, with the main thread. They answer cached tiles, so one thread would be too few on
/// two cores.
std::size_t io_threads_for(std::size_t threads) { return std::min(threads, std::max<std::size_t>(2, 1 + threads / 4)); }

std::string text_of(const asio::ip::tcp::endpoint& endpoint) {
    return fmt::format("{}:{}", endpoint.address().to_string(), endpoint.port());
}

/// Returns null if the port does not use TLS.
Result<std::shared_ptr<sockets::PortTls>> tls_of(const sockets::TlsFiles& files) {
    if (!files.is_given()) return std::shared_ptr<sockets::PortTls>();
    return sockets::PortTls::open(files);
}

sessions::ReplayLimits replay_limits(std::size_t bytes) {
    const std::size_t chunks = bytes / 2 / mapping::kPageBytes; // a chunk is a page
    return {.chunks_max = chunks, .chunks_kept_max = chunks};
}

} // namespace

Server::Server(const ServerOptions& options, const ConnectionLimits& limits, std::unique_ptr<store::ScanLog> log)
    : options_(options), limits_(limits), log_(std::move(log)), metrics_(kVersion), audit_(metrics_.registry()),
      pools_(options.threads, log_->shared() != nullptr),
      sessions_(*log_, {.compute = pools_.sessions,
                        .now = seconds_since_epoch,
                        .blocking_executor = pools_.checkpoints,
                        .reading = pools_.loading,
                        .pages_max = options.map_memory_bytes / mapping::kPageBytes,
                        .idle_after = options.idle_after}),
      check_(*log_, sessions_), replay_jobs_(*log_, pools_.replay, replay_limits(options.replay_memory_bytes)),
      locator_(*log_), requests_(pools_.planning, pools_.locating, {goals_, locator_, sessions_}), hangup_(io_, SIGHUP),
      stop_timeout_(io_), integration_timeout_(io_), tidying_(asio::make_strand(io_)) {}

Server::~Server() {
    // No task may run while the members are destroyed, in reverse order.
    io_.stop();
    end_pools();
}

void Server::end_pools() {
    check_.stop();
    replay_jobs_.stop(); // their results are no longer needed
    pools_.join();
}

Result<std::unique_ptr<Server>> Server::open(const ServerOptions& options, const ConnectionLimits& limits,
                                             const store::OpenStore& open_log) {
    store::StoreOptions store;
    store.on_damage = [](const Error& damage) { spdlog::error("{}", damage.message); };
    store.on_log_line = [](std::string_view line) { spdlog::debug("RocksDB: {}", line); };
    store.disk_reserve_bytes = options.disk_reserve_bytes;
    store.allow_unreplicated = options.allow_unreplicated;
    store.bytes_max = options.store_bytes_max;
    store.node = node_name(options);
    const auto check = std::make_shared<sessions::BackgroundCheck*>(nullptr); // created after the log
    store.on_unreadable = [check](store::SessionId session, const Error& why) {
        if (*check != nullptr) (*check)->note(session, why);
    };
    auto log = open_log(options.store, store);
    if (!log) return log.error();
    if (const auto torn = (*log)->stats().torn_bytes_dropped; torn > 0)
        spdlog::warn(
            "the write-ahead log ended with {} bytes of an incomplete write, which were dropped: a crash interrupted "
            "it before it was acknowledged; without a crash, the disk lost data",
            torn);
    auto web = http::load_web_files(options.web);
    if (!web) return web.error();
    if (!web->contains("index.html")) {
        spdlog::warn("there is no viewer in {}: build it with ./scanloom build, or give its directory with --web; "
                     "everything else is served",
                     options.web.string());
    }
    auth::TokenSet tokens;
    if (!options.tokens.empty()) { // before anything is created
        auto read = auth::read_tokens(options.tokens);
        if (!read) return prefixed("--tokens ", read.error());
        tokens = std::move(*read);
    }
    std::unique_ptr<Server> server(new Server(options, limits, std::move(*log)));
    if (!options.tokens.empty()) server->authenticator_.replace(std::move(tokens));
    *check = &server->check_;
    if (!options.backups.empty()) {
        auto backups = store::Backups::open(options.backups, options.backups_kept, *server->log_,
                                            [](const std::string& what) { spdlog::warn("{}", what); });
        if (!backups) return prefixed("--backups: ", backups.error());
        server->backups_ = std::move(*backups);
    }
    if (auto listening = server->listen(std::move(*web)); !listening) return listening.error();
    return server;
}

Result<> Server::listen(http::WebFiles web) {
    auto robot_tls = tls_of(options_.robot_tls);
    if (!robot_tls) return prefixed("--robot-tls-cert: ", robot_tls.error());
    auto http_tls = tls_of(options_.http_tls);
    if (!http_tls) return prefixed("--http-tls-cert: ", http_tls.error());
    robot_tls_ = std::move(*robot_tls);
    http_tls_ = std::move(*http_tls);
    ingest::IngestConfig robots;
    robots.links_max = limits_.robots;
    robots.greeting_max = limits_.greeting;
    robots.tls = robot_tls_;
    try {
        ingest_ = std::make_unique<ingest::IngestServer>(
            io_, options_.listen,
            ingest::LinkServices{sessions_, pools_.changes, metrics_.ingest(), requests_, authenticator_, audit_},
            robots);
    } catch (const boost::system::system_error& failure) {
        return Error{Errc::kUnreachable, fmt::format("cannot listen for robots on {}: {}; choose another --listen",
                                                     text_of(options_.listen), failure.code().message())};
    }
    const auto address = options_.listen.address();
    http::ServerConfig config;
    config.endpoint = options_.http;
    config.host_names = options_.http_hosts;
    config.viewer_origins = options_.viewer_origins;
    config.proxies = options_.http_proxies;
    config.tls = http_tls_;
    config.connections_max = limits_.http;
    auto nodes = node_links(*log_);
    if (!nodes) return nodes.error();
    if (log_->shared() != nullptr) logins_.share(auth::hash_of("logins " + log_->shared()->secret()));
    http_work_.emplace(http::Executors{.metrics = pools_.metrics,
                                       .queries = pools_.queries,
                                       .whole_maps = pools_.whole_maps,
                                       .log_reading = pools_.log_reading,
                                       .log_export = pools_.log_export,
                                       .planning = pools_.planning,
                                       .store = pools_.changes,
                                       .live = pools_.live},
                       config);
    services_.reset(new http::Services{.sessions = sessions_,
                                       .weaves = replay_jobs_,
                                       .goals = goals_,
                                       .locator = locator_,
                                       .log = *log_,
                                       .check = check_,
                                       .metrics = metrics_,
                                       .authorizer = {authenticator_, audit_, logins_},
                                       .work_classes = *http_work_,
                                       .web = std::move(web),
                                       .robots = {address.is_unspecified() ? "" : address.to_string(), ingest_->port()},
                                       .nodes = std::move(*nodes),
                                       .drain = [this] { drain(); },
                                       .backups = backups_.get(),
                                       .tile_bytes_max = options_.tile_cache_bytes});
    api_.emplace(*services_);
    auto http = http::Server::listen(io_, *api_, config, metrics_.http());
    if (!http) return http.error();
    http_ = std::move(*http);
    return {};
}

Result<> Server::run() {
    wait_for_signal();
    wait_for_hangup();
    http_->start();
    std::vector<std::jthread> threads;
    do { // one at least, for health checks during recovery
        threads.emplace_back([this] { sockets::run_to_completion(io_); });
    } while (threads.size() + 1 < io_threads_for(options_.threads));
    if (auto recovered = sessions_.recover(); !recovered) {
        io_.stop();
        return recovered.error();
    }
    enter_addresses(node_info(options_, ingest_->port(), http_->port()).robots);
    if (!sessions_.is_draining()) {
        services_->recovered = true;
        ingest_->start();
        asio::post(tidying_.get_executor(), [this] { run_maintenance(); });
        if (!sessions_.is_shared()) check_.start(); // each of the servers would read the whole database
        announce();
    }
    sockets::run_to_completion(io_); // until drain() has finished
    threads.clear();
    end_pools();
    spdlog::info("stopped");
    if (const auto failure = log_->stats().last_error) return Error{Errc::kStoreFailed, *failure};
    return {};
}

/// Enters the addresses of this server for those with which it shares the log.
/// @param robots  empty: it accepts no robots
void Server::enter_addresses(const std::string& robots) {
    auto info = node_info(options_, ingest_->port(), http_->port());
    info.robots = robots;
    enter(*log_, info);
}

void Server::announce() const {
    boost::json::object ready{{"event", "ready"}, {"robot_port", ingest_->port()}, {"http_port", http_->port()}};
    std::cout << boost::json::serialize(ready) << std::endl;
    notify_service_manager("READY=1");
    spdlog::info("robots: {}:{}, browsers: {}://{}:{}/, store: {}", options_.listen.address().to_string(),
                 ingest_->port(), http_tls_ ? "https" : "http", options_.http.address().to_string(), http_->port(),
                 store::shown(options_.store));
    if (const auto others = others_in(sessions_.nodes()); !others.empty()) spdlog::info("other servers: {}", others);
    if (const auto warning = log_->stats().warning) spdlog::warn("{}", *warning);
}

void Server::wait_for_signal() {
    signals_.emplace(io_, SIGTERM, SIGINT);
    signals_->async_wait([this](const boost::system::error_code& error, int) {
        if (error) return;
        signals_->async_wait([this](const boost::system::error_code& cancelled, int) {
            if (!cancelled) sessions_.finish_early(); // second signal
        });
        drain();
    });
}

/// Does periodic maintenance until the server drains.
void Server::run_maintenance() {
    if (sessions_.is_draining()) return;
    asio::post(pools_.loading, [this] { // not on pools_.changes: its tasks may wait for work started here
        log_store_failure();
        if (log_->reopen()) spdlog::info("the store {} has been opened again", store::shown(options_.store));
        sessions_.tidy();
        audit_.log_due();
        asio::post(tidying_.get_executor(), [this] { maintain_later(); });
    });
}

/// Begins the next maintenance when the last one has ended, so that none queue up while the store does not answer.
void Server::maintain_later() {
    if (sessions_.is_draining()) return;
    tidying_.expires_after(kTidyEvery);
    tidying_.async_wait([this](const boost::system::error_code& error) {
        if (!error) run_maintenance();
    });
}

/// Logs each failure of the store once. Sessions notice a failure only when a robot sends scans.
void Server::log_store_failure() {
    const auto failure = log_->stats().last_error;
    const bool was_known = store_has_failed_.exchange(failure.has_value());
    if (failure && !was_known) spdlog::error("{}", *failure);
}

void Server::wait_for_hangup() {
    hangup_.async_wait([this](const boost::system::error_code& error, int) {
        if (error) return;
        const bool has_tokens = !options_.tokens.empty();
        if (has_tokens) read_tokens_again();
        read_certificates_again();
        if (!has_tokens && !robot_tls_ && !http_tls_) {
            spdlog::info("SIGHUP: there are neither tokens nor certificates to read again");
        }
        wait_for_hangup();
    });
}

/// Reads the tokens again. If the file is invalid, the previous tokens stay in force, so that admitted clients stay
/// connected.
void Server::read_tokens_again() {
    auto tokens = auth::read_tokens(options_.tokens);
    if (!tokens) {
        spdlog::error("--tokens {}; the previous tokens stay in force", tokens.error().message);
        return;
    }
    spdlog::info("{} tokens are in force, read again from {}", tokens->tokens().size(), options_.tokens.string());
    authenticator_.replace(std::move(*tokens));
}

/// Reads the certificates again, for new connections. Open connections keep the settings they started with.
void Server::read_certificates_again() {
    for (const auto& [flag, tls] : {std::pair("--robot-tls-cert", robot_tls_), {"--http-tls-cert", http_tls_}}) {
        if (!tls) continue;
        if (auto read = tls->read_again(); !read) {
            spdlog::error("{}: {}; the previous certificate stays in force", flag, read.error().message);
        } else {
            spdlog::info("{}: read again from {}", flag, tls->files().certificate.string());
        }
    }
}

/// Stops accepting robots, gives every session limited time to make its submitted scans durable and acknowledge them,
/// then stops serving. When no work is left, the io_context ends and run() returns.
/// Does nothing if it was called before. Thread: any.
void Server::drain() {
    if (is_draining_.exchange(true)) return;
    spdlog::info("draining: acknowledging durable scans");
    notify_service_manager("STOPPING=1");
    ingest_->stop();
    check_.stop();
    replay_jobs_.stop();
    if (backups_) backups_->stop();
    asio::post(tidying_.get_executor(), [this] { tidying_.cancel(); });
    stop_timeout_.expires_after(kStopTimeout);
    stop_timeout_.async_wait([this](const boost::system::error_code& error) {
        if (!error) io_.stop();
    });
    integration_timeout_.expires_after(kIntegrationTimeout);
    integration_timeout_.async_wait([this](const boost::system::error_code& error) {
        if (!error) sessions_.finish_early();
    });
    asio::post(pools_.changes, [this, busy = asio::make_work_guard(io_)] {
        enter_addresses({}); // other servers that stop send their robots elsewhere
        sessions_.drain();
        asio::post(io_, [this] { integration_timeout_.cancel(); });
        http_->stop([this] {
            stop_timeout_.cancel();
            signals_->cancel();
            hangup_.cancel();
        });
    });
}

} // namespace scanloom::app
