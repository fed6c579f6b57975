#pragma once

#include "common/scan/scan.hpp"
#include "tests/fault/command.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/ld06_bytes.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// scanloom-robot with a lidar whose every scan is known, and a spool.
namespace scanloom::fault {

/// What a lidar sends from within the turn before `first` until it has begun the one after `last`. Each turn sees the
/// room a millimetre larger, so that none can stand for another.
[[nodiscard]] testing_support::Bytes turns(int first, int last);

/// See turns().
[[nodiscard]] int turn_of(const Scan& scan);

/// Where the robot reads its lidar from.
class Lidar {
public:
    Lidar();

    [[nodiscard]] std::string address() const;
    void wait_for_robot() { socket_ = acceptor_.accept(); }
    void send(const testing_support::Bytes& bytes);

private:
    boost::asio::io_context io_{1};
    boost::asio::ip::tcp::acceptor acceptor_;
    std::optional<boost::asio::ip::tcp::socket> socket_;
};

/// Robot "r" of session "s", which reads its lidar, keeps its spool in `place`/spool, and has its server at `port`.
[[nodiscard]] test::ChildProcess start_lidar_robot(const std::filesystem::path& place, std::uint16_t port,
                                                   const Lidar& lidar, const std::vector<std::string>& options = {},
                                                   const Command& robot = {});

/// The scans that wait in that spool.
[[nodiscard]] std::vector<Scan> spooled(const std::filesystem::path& place);

/// Scans that the server holds of session "s".
[[nodiscard]] std::uint64_t scans_of(std::uint16_t http_port);

/// The turns that the server holds of session "s", in its log's order.
[[nodiscard]] std::vector<int> turns_of(std::uint16_t http_port);

/// Asks until it is so. What is lost never comes: that is told, long after any machine would have brought it.
void wait_until(const std::string& what, const std::function<bool()>& has_come);
void wait_for_scans(std::uint16_t http_port, std::uint64_t scans);

/// The digest of session "s" after a lidar's turns 1 to `turns_in_all` came in one go, and nothing went wrong.
[[nodiscard]] std::string peaceful_digest(int turns_in_all);

} // namespace scanloom::fault
