#pragma once

#include "common/error/error.hpp"
#include "common/net/tls.hpp"
#include "server/auth/token.hpp"
#include "server/guidance/goal_assignments.hpp"
#include "server/guidance/locator.hpp"
#include "server/http/authorizer.hpp"
#include "server/http/request.hpp"
#include "server/http/response_limit.hpp"
#include "server/http/target.hpp"
#include "server/http/web_files.hpp"
#include "server/http/work_classes.hpp"
#include "server/live/landmark_hub.hpp"
#include "server/live/shared_parts.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sessions/background_check.hpp"
#include "server/sessions/capture_layers.hpp"
#include "server/sessions/replay_jobs.hpp"
#include "server/sessions/session_registry.hpp"
#include "server/store/backups.hpp"
#include "server/store/scan_log.hpp"
#include "server/tiles/tile_maker.hpp"

#include <boost/asio/awaitable.hpp>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace scanloom::http {

/// Where robots connect.
struct RobotPort {
    std::string host; ///< an address; empty: any address of this machine
    std::uint16_t port = 0;
};

/// What servers that share a database need to pass requests on to each other.
struct NodeLinks {
    std::string secret;    ///< that all of them have; empty: this server shares its store with no other
    net::TlsContext tls{}; ///< for servers with TLS
};

/// What handlers use, and what is kept from one request to the next.
/// Threads: any thread may use each part.
struct Services {
    sessions::SessionRegistry& sessions;
    sessions::ReplayJobs& weaves; ///< replay jobs
    guidance::GoalAssignments& goals;
    guidance::Locator& locator;
    store::ScanLog& log;
    const sessions::BackgroundCheck& check;
    const metrics::Metrics& metrics;
    Authorizer authorizer;
    const WorkClasses& work_classes;
    WebFiles web = {};                                        ///< of the viewer
    RobotPort robots = {};                                    ///< for /readyz
    NodeLinks nodes = {};                                     ///< to servers that share the database
    std::function<void()> drain = [] {};                      ///< makes the server stop, as SIGTERM does
    store::Backups* backups = nullptr;                        ///< null: this server keeps no backups
    std::size_t tile_bytes_max = tiles::TileMaker::kBytesMax; ///< of cached tiles
    std::chrono::milliseconds replay_timeout{20'000};         ///< longest time that a request waits for a replay job

    std::atomic<bool> recovered = false; ///< before, requests for sessions receive kOverloaded
    tiles::TileMaker tiles{tile_bytes_max};
    sessions::LandmarkLayers landmarks{log};
    live::LandmarkHub watched_landmarks{landmarks};
    live::PartsHub watched_parts;
    ResponseLimit responses;
};

/// A routed request whose client has the permission for it.
struct Context {
    Services& services;
    const Request& request;
    const Arguments& arguments; ///< of the path
    const Query& query;
    auth::TokenRef token; ///< of the client; null only if the operation needs no token

    std::shared_ptr<sessions::Session> session = nullptr; ///< that in the path; null without Sessions::kLoaded

    WorkClass work = WorkClass::kIo; ///< decides where the handler runs now

    /// Continues on the executor of `next`; for WorkClass::kIo on that of the connection.
    [[nodiscard]] boost::asio::awaitable<void> run_on(WorkClass next);
};

} // namespace scanloom::http
