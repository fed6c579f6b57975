#pragma once

#include "tests/fault/command.hpp"
#include "tests/support/child_process.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::fault {

/// A free port of this machine that stays reserved while no server listens on it. The system does not assign it to
/// outgoing connections, so that a robot that connects to its server there cannot connect to itself.
class ReservedPort {
public:
    ReservedPort();

    [[nodiscard]] std::uint16_t number() const { return socket_.local_endpoint().port(); }

private:
    boost::asio::io_context io_;
    boost::asio::ip::tcp::socket socket_{io_};
};

/// A server that is started, disturbed and restarted, always with the same ports and the same store.
class ServerProcess {
public:
    /// @param place  a directory: the server's standard error goes to `place`/log
    /// @param store  the value of --store; empty: `place`/store
    ServerProcess(Command command, std::filesystem::path place, std::vector<std::string> options = {},
                  std::string store = {});

    [[nodiscard]] std::uint16_t robot_port() const { return robot_port_.number(); }
    [[nodiscard]] std::uint16_t http_port() const { return http_port_.number(); }

    /// Starts the server without waiting. Pre: it does not run.
    void start();

    /// Waits until the server is ready. @return false if it has ended instead
    [[nodiscard]] bool becomes_ready() { return process_->read_line().has_value(); }

    /// Throws with the server's last log line if it ends before it is ready.
    void start_and_wait();

    /// Waits for `time`, or until the server is ready or ends, if that is earlier.
    void let_be(std::chrono::microseconds time) const { (void)process_->has_output_within(time); }

    [[nodiscard]] pid_t id() const { return process_->id(); }
    void signal(int number) const { process_->signal(number); }
    void kill_nine();

    /// Waits until the server ends. @return its exit code, or minus the signal that ended it
    [[nodiscard]] int wait() { return process_->wait(); }

    /// Requests a stop and waits for the end. @return as wait()
    [[nodiscard]] int stop();

    /// Returns the last line of the server's standard error.
    [[nodiscard]] std::string last_words() const;

private:
    Command command_;
    std::filesystem::path place_;
    std::vector<std::string> options_;
    std::string store_;
    ReservedPort robot_port_;
    ReservedPort http_port_;
    std::optional<test::ChildProcess> process_;
};

} // namespace scanloom::fault
