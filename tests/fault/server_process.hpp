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

/// A free port of this machine that stays ours while nobody listens on it: no outgoing connection is given it, so that
/// no robot that looks for its server there meets itself.
class ReservedPort {
public:
    ReservedPort();

    [[nodiscard]] std::uint16_t number() const { return socket_.local_endpoint().port(); }

private:
    boost::asio::io_context io_;
    boost::asio::ip::tcp::socket socket_{io_};
};

/// A server that is started, disturbed and started again, always on the same ports and the same store.
class ServerProcess {
public:
    /// `place` is a directory: the store is `place`/store, what the server says on standard error `place`/log.
    ServerProcess(Command command, std::filesystem::path place, std::vector<std::string> options = {});

    [[nodiscard]] std::uint16_t robot_port() const { return robot_port_.number(); }
    [[nodiscard]] std::uint16_t http_port() const { return http_port_.number(); }

    /// Does not wait for anything. Pre: it does not run.
    void start();

    /// Waits until it is ready. @return false when it has ended instead
    [[nodiscard]] bool becomes_ready() { return process_->read_line().has_value(); }

    /// Throws, with what it said last, when it ends instead of becoming ready.
    void start_and_wait();

    /// Lets it be for a while, unless it becomes ready, or ends, before.
    void let_be(std::chrono::microseconds time) const { (void)process_->has_output_within(time); }

    [[nodiscard]] pid_t id() const { return process_->id(); }
    void signal(int number) const { process_->signal(number); }
    void kill_nine();

    /// Waits for its end. @return its exit code, or minus the signal that ended it
    [[nodiscard]] int wait() { return process_->wait(); }

    /// Asks it to stop, and waits for it as above.
    [[nodiscard]] int stop();

    /// The last line that it wrote on standard error.
    [[nodiscard]] std::string last_words() const;

private:
    Command command_;
    std::filesystem::path place_;
    std::vector<std::string> options_;
    ReservedPort robot_port_;
    ReservedPort http_port_;
    std::optional<test::ChildProcess> process_;
};

} // namespace scanloom::fault
