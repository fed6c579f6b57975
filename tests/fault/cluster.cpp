#include "tests/fault/cluster.hpp"

#include "tests/fault/readiness.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;
using test::PostgresServer;

constexpr std::chrono::seconds kDead{7};                              // a node counts as dead after 5 s
constexpr std::chrono::seconds kPaused{16};                           // three times that
constexpr std::uint64_t kDatabaseDiskBytes = std::uint64_t{12} << 30; // of a sparse file

/// Returns the path of the socket in a directory, as PostgreSQL and its clients form it.
fs::path socket_in(const fs::path& directory) { return directory / ".s.PGSQL.5432"; }

/// Starts a server as a service manager does: again if it ends because the database does not answer in time.
void start(ServerProcess& server) {
    constexpr int kTries = 10;
    for (int tries = 1;; ++tries) {
        try {
            return server.start_and_wait();
        } catch (const std::runtime_error&) {
            if (tries == kTries || server.last_words().find("does not answer within") == std::string::npos) throw;
        }
    }
}

} // namespace

std::span<const Cluster::Fault> Cluster::faults() {
    static constexpr Fault kFaults[] = {
        {"killed", &Cluster::kill_node},
        {"stopped", &Cluster::stop_node},
        {"cut_off_from_database", &Cluster::cut_off_from_database},
        {"database_failed_over", &Cluster::fail_over},
        {"paused", &Cluster::pause_node},
        {"database_killed", &Cluster::kill_database},
        {"cut_off_to_database", &Cluster::cut_off_to_database},
        {"power_cut", &Cluster::cut_power, true},
        {"dead", &Cluster::let_node_die},
        {"database_paused_and_failed_over", &Cluster::pause_and_fail_over},
    };
    return kFaults;
}

Cluster::Cluster(const Command& server, std::uint64_t seed) : random_(seed) {
    fs::permissions(place_.path(), fs::perms::others_exec, fs::perm_options::add); // PostgreSQL has a user of its own
    auto disk = LoopDisk::make(place_.path() / "image", place_.path() / "disk", kDatabaseDiskBytes);
    if (disk) disk_ = std::move(*disk);
    fs::create_directories(place_.path() / "disk");
    databases_[0] = std::make_unique<PostgresServer>(place_.path() / "disk" / "0");
    databases_[1] = std::make_unique<PostgresServer>(primary(), place_.path() / "disk" / "1");
    static_cast<void>(primary().new_database());
    for (unsigned n = 0; n < kNodes; ++n) {
        const auto place = place_.path() / fmt::format("node{}", n);
        std::array<std::unique_ptr<DatabaseLink>, 2> links;
        for (std::size_t to = 0; to < links.size(); ++to) {
            const auto near = place / std::to_string(to);
            fs::create_directories(near);
            links[to] = std::make_unique<DatabaseLink>(socket_in(near), socket_in(databases_[to]->socket()));
        }
        const auto store = fmt::format("postgresql://scanloom@/db1?host={0}/0,{0}/1", place.native());
        const std::vector<std::string> options{"--node", fmt::format("node{}", n)};
        nodes_.push_back(
            std::unique_ptr<Node>(new Node{std::move(links), ServerProcess(server, place, options, store)}));
        start(nodes_.back()->server);
    }
}

std::vector<std::uint16_t> Cluster::robot_ports() const {
    std::vector<std::uint16_t> ports;
    for (const auto& node : nodes_) ports.push_back(node->server.robot_port());
    return ports;
}

bool Cluster::cause(const Fault& fault) {
    if (fault.needs_disk && disk_ == nullptr) return false;
    (this->*fault.cause)();
    return true;
}

/// Returns the node with the most sessions.
Cluster::Node& Cluster::busiest_node() {
    const auto names = test::connect(fmt::format("postgresql://scanloom@/db1?host={}", primary().socket()))
                           .run("SELECT n.name FROM scanloom.node n LEFT JOIN scanloom.session s ON s.owner = n.id"
                                " GROUP BY n.name ORDER BY count(s.id) DESC")
                           .value();
    const std::string name(names.bytes(0, 0));
    return *nodes_.at(static_cast<std::size_t>(name.back() - '0'));
}

void Cluster::kill_node() {
    Node& node = busiest_node();
    node.server.kill_nine();
    start(node.server);
}

void Cluster::stop_node() {
    Node& node = busiest_node();
    stop(node);
    start(node.server);
}

/// Stops a server that has recovered from the fault before: one whose store has failed does not exit with 0.
void Cluster::stop(Node& node) {
    static_cast<void>(wait_for_readiness(node.server, 200));
    const int code = node.server.stop();
    if (code != 0) failures_.push_back(fmt::format("a server exited with {} after a stop request", code));
}

void Cluster::restart_servers() {
    for (const auto& node : nodes_) stop(*node);
    for (const auto& node : nodes_) start(node->server);
}

void Cluster::pause_node() {
    Node& node = busiest_node();
    node.server.signal(SIGSTOP);
    node.server.let_be(kPaused);
    node.server.signal(SIGCONT);
}

/// Dies without a word, and is not back before others have its sessions.
void Cluster::let_node_die() {
    Node& node = busiest_node();
    node.server.signal(SIGSTOP);
    node.server.let_be(kDead);
    node.server.kill_nine();
    start(node.server);
}

void Cluster::cut_off_to_database() { cut_off(DatabaseLink::Direction::kToDatabase); }

void Cluster::cut_off_from_database() { cut_off(DatabaseLink::Direction::kFromDatabase); }

/// Cuts one node off for a moment, after which it keeps its sessions, and then until others have them.
void Cluster::cut_off(DatabaseLink::Direction direction) {
    Node& node = busiest_node();
    const auto cut_for = [&](std::chrono::milliseconds time) {
        for (const auto& link : node.links) link->cut(direction);
        node.server.let_be(time);
        for (const auto& link : node.links) link->restore();
    };
    cut_for(std::chrono::milliseconds(500));
    node.server.let_be(std::chrono::seconds(2)); // it opens the database again
    cut_for(kDead);
}

void Cluster::kill_database() {
    primary().kill();
    primary().start();
}

void Cluster::fail_over() {
    primary().kill();
    standby().promote();
    exchange_databases();
}

/// The earlier primary goes on for a moment after its standby was promoted, as when a manager of the cluster notices
/// too late.
void Cluster::pause_and_fail_over() {
    primary().pause();
    standby().promote();
    primary().resume();
    nodes_[0]->server.let_be(std::chrono::milliseconds(random_() % 2000));
    primary().kill();
    exchange_databases();
}

/// Pre: the primary was killed, and its standby is promoted.
void Cluster::exchange_databases() {
    primary_ = 1 - primary_;
    standby().stand_by(primary());
}

/// All machines lose power.
void Cluster::cut_power() {
    // As in the row `power`: what is in progress must not be reported as done.
    for (const auto& database : databases_) database->pause();
    for (const auto& node : nodes_) node->server.signal(SIGSTOP);
    disk_->cut_power();
    for (const auto& database : databases_) database->kill();
    for (const auto& node : nodes_) node->server.kill_nine();
    disk_->mount_again();
    for (const auto& database : databases_) database->start();
    for (const auto& node : nodes_) start(node->server);
}

} // namespace scanloom::fault
