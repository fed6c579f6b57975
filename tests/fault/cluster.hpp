#pragma once

#include "common/error/error.hpp"
#include "tests/fault/command.hpp"
#include "tests/fault/database_link.hpp"
#include "tests/fault/loop_disk.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {

/// Three servers, the database that they share, and its synchronous standby: each server reaches both over links of its
/// own. The database has a disk of its own if this process may create one.
class Cluster {
public:
    /// A kind of fault. Its function returns when everything runs again.
    struct Fault {
        std::string_view name;
        void (Cluster::*cause)();
        bool needs_disk = false;
    };

    /// Returns all kinds.
    [[nodiscard]] static std::span<const Fault> faults();

    /// Starts all. @param seed  of the random choices
    Cluster(const Command& server, std::uint64_t seed);

    [[nodiscard]] std::vector<std::uint16_t> robot_ports() const;

    /// Returns the port of a server that answers for all sessions.
    [[nodiscard]] std::uint16_t http_port() const { return nodes_[0]->server.http_port(); }

    /// Causes a fault. @return false: it needs a disk that can lose power
    [[nodiscard]] bool cause(const Fault& fault);

    /// Stops all servers and starts them again, so that what they show is what the database has: one that was cut off
    /// or paused may show maps of sessions that others have for about a second.
    void restart_servers();

    /// Returns what was wrong with the servers, one sentence each.
    [[nodiscard]] const std::vector<std::string>& failures() const noexcept { return failures_; }

private:
    static constexpr unsigned kNodes = 3;

    struct Node {
        std::array<std::unique_ptr<DatabaseLink>, 2> links; // to databases_
        ServerProcess server;
    };

    void kill_node();
    void stop_node();
    void stop(Node& node);
    void pause_node();
    void let_node_die();
    void cut_off_to_database();
    void cut_off_from_database();
    void cut_off(DatabaseLink::Direction direction);
    void kill_database();
    void fail_over();
    void pause_and_fail_over();
    void cut_power();

    [[nodiscard]] Node& busiest_node();
    [[nodiscard]] test::PostgresServer& primary() { return *databases_[primary_]; }
    [[nodiscard]] test::PostgresServer& standby() { return *databases_[1 - primary_]; }
    void exchange_databases();

    TemporaryDirectory place_;
    std::mt19937_64 random_;
    std::unique_ptr<LoopDisk> disk_; // null: there is none
    std::array<std::unique_ptr<test::PostgresServer>, 2> databases_;
    std::size_t primary_ = 0; // index in databases_
    std::vector<std::unique_ptr<Node>> nodes_;
    std::vector<std::string> failures_;
};

} // namespace scanloom::fault
