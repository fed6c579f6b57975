#pragma once

#include "server/auth/authenticator.hpp"
#include "server/ingest/connection_limits.hpp"
#include "server/sessions/session_registry.hpp"
#include "server/store/scan_log.hpp"
#include "tests/fault/simulation/disk.hpp"
#include "tests/fault/simulation/machine.hpp"
#include "tests/fault/simulation/network.hpp"
#include "tests/fault/simulation/tokens.hpp"

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
    std::size_t links_max = 10'000;
    std::size_t greeting_max = 256;
};

/// One run of a server: the real registry, sessions, authenticator, limits and link protocol between a simulated
/// network and a simulated disk.
class Server {
public:
    /// Called when an acknowledgement is sent: the scans of `robot` up to `seq` are durable.
    using Promise = std::function<void(const std::string& robot, std::uint64_t seq)>;

    /// Reads the tokens and recovers the sessions on the disk.
    Server(World& world, Disk& disk, const ServerOptions& options, Tokens& tokens, Promise promise);

    /// Kills the server, unless it was stopped. Work still pending has no effect visible to others.
    ~Server();

    void accept(std::shared_ptr<Connection> connection);

    /// Reads the tokens again, as on SIGHUP.
    void read_tokens();

    /// Drains, as on SIGTERM.
    void stop();

    [[nodiscard]] sessions::SessionRegistry& sessions() { return *sessions_; }

private:
    class Link;

    void tidy();
    [[nodiscard]] std::size_t connected_with(const std::string& secret) const;
    void check_links();

    World& world_;
    Disk& disk_;
    const ServerOptions options_;
    Tokens& tokens_;
    const Promise promise_;
    auth::Authenticator authenticator_;
    ingest::ConnectionLimits limits_;
    std::unique_ptr<Machine> machine_;
    std::unique_ptr<store::ScanLog> log_;
    std::optional<sessions::SessionRegistry> sessions_;
    boost::asio::any_io_executor blocking_executor_; // creates sessions, one at a time
    std::vector<std::shared_ptr<Link>> links_;
    std::shared_ptr<Server*> self_ = std::make_shared<Server*>(this); // for events that may run after the destructor
};

} // namespace scanloom::simulation
