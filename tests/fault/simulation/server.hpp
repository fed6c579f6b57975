#pragma once

#include "server/ingest/dialogue.hpp"
#include "server/metrics/metrics.hpp"
#include "server/session/session_registry.hpp"
#include "server/store/reopening_log.hpp"
#include "tests/fault/simulation/disk.hpp"
#include "tests/fault/simulation/machine.hpp"
#include "tests/fault/simulation/network.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::simulation {

struct ServerOptions {
    std::size_t credit_bytes = std::size_t{2} << 20;
    std::size_t pages_max = 1'000'000;
    Duration idle_after = std::chrono::seconds(600);
    Duration idle_deadline = std::chrono::seconds(60); ///< of links
};

/// One run of a server: the real registry, sessions and dialogues, between a simulated network and a simulated disk.
class Server {
public:
    /// Hears which robot is told that its scans up to which one are durable, when it is sent.
    using Promise = std::function<void(const std::string& robot, std::uint64_t seq)>;

    /// Recovers what is on the disk.
    Server(World& world, Disk& disk, const ServerOptions& options, Promise promise);

    /// Killed, unless it was stopped: what is still done changes nothing that others see.
    ~Server();

    void accept(std::shared_ptr<Connection> connection);

    /// Drains, as on SIGTERM.
    void stop();

    [[nodiscard]] session::SessionRegistry& sessions() { return *sessions_; }

private:
    class Link;

    void tidy();

    World& world_;
    Disk& disk_;
    const ServerOptions options_;
    const Promise promise_;
    metrics::Metrics metrics_{"simulation"};
    std::unique_ptr<Machine> machine_;
    std::unique_ptr<store::ReopeningLog> log_;
    std::optional<session::SessionRegistry> sessions_;
    std::vector<std::shared_ptr<Link>> links_;
    std::shared_ptr<Server*> self_ = std::make_shared<Server*>(this); // for events that may come too late
};

} // namespace scanloom::simulation
