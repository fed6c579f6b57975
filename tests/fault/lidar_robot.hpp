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

/// A scanloom-robot with a spool and a lidar whose scans are all known.
namespace scanloom::fault {

/// Returns the bytes that a lidar sends from within the turn before `first` until the start of the turn after `last`.
/// In each turn the room is one millimetre larger, so that each turn is distinguishable.
[[nodiscard]] testing_support::Bytes turns(int first, int last);

/// Returns the turn of a scan, see turns().
[[nodiscard]] int turn_of(const Scan& scan);

/// The source from which the robot reads its lidar.
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

/// Starts robot "r" of session "s", which reads its lidar, keeps its spool in `place`/spool, and connects to its server
/// at `port`.
[[nodiscard]] test::ChildProcess start_lidar_robot(const std::filesystem::path& place, std::uint16_t port,
                                                   const Lidar& lidar, const std::vector<std::string>& options = {},
                                                   const Command& robot = {});

/// Returns the scans in that spool.
[[nodiscard]] std::vector<Scan> spooled(const std::filesystem::path& place);

/// Returns the number of scans of session "s" on the server.
[[nodiscard]] std::uint64_t scans_of(std::uint16_t http_port);

/// Returns the turns of session "s" on the server, in the order of its log.
[[nodiscard]] std::vector<int> turns_of(std::uint16_t http_port);

/// Polls until `has_come` returns true. Throws after a time that suffices on any machine, as lost data never arrives.
void wait_until(const std::string& what, const std::function<bool()>& has_come);
void wait_for_scans(std::uint16_t http_port, std::uint64_t scans);

/// Returns the digest of session "s" after an undisturbed run over the lidar's turns 1 to `turns_in_all`.
[[nodiscard]] std::string peaceful_digest(int turns_in_all);

} // namespace scanloom::fault
