#include "robot_client/spool/segment.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/tcp_proxy.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/json/parse.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

/// A live sensor's scans while the network is away and the robot's program is killed.
namespace scanloom::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing_support::append;
using testing_support::Bytes;
using testing_support::bytes_of;

constexpr int kPointsPerTurn = 450; // of Ld06Spinner
constexpr int kFirstPoint = 375;    // of that turn which is not seen from its beginning
constexpr int kRangeOfTurn0 = 1000; // mm, straight ahead

/// What a lidar sends from within the turn before `first` until it has begun the one after `last`. Each turn sees the
/// room a millimetre larger, so that none can stand for another.
Bytes turns(int first, int last) {
    testing_support::Ld06Spinner spinner(kFirstPoint * 36'000 / kPointsPerTurn);
    const int end = (last - first + 2) * kPointsPerTurn + 24;
    Bytes bytes;
    for (int point = kFirstPoint; point < end;) {
        robot::Ld06Packet packet = spinner.next();
        for (auto& reading : packet.points) {
            const int turn = first - 1 + point++ / kPointsPerTurn;
            reading.distance = static_cast<std::uint16_t>(reading.distance + turn);
        }
        append(bytes, bytes_of(packet));
    }
    return bytes;
}

/// Where the robot reads its lidar from.
class Lidar {
public:
    Lidar() : acceptor_(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)) {}

    [[nodiscard]] std::string address() const {
        return "tcp://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
    }
    void wait_for_robot() { socket_ = acceptor_.accept(); }
    void send(const Bytes& bytes) { asio::write(*socket_, asio::buffer(bytes)); }

private:
    asio::io_context io_{1};
    tcp::acceptor acceptor_;
    std::optional<tcp::socket> socket_;
};

std::uint64_t scans_of(const RunningServer& server) {
    const auto answer = server.get("/api/v1/sessions/s");
    return answer.status == 200 ? boost::json::parse(answer.body).at("scans").to_number<std::uint64_t>() : 0;
}

/// What is lost never comes: that is told, long after any machine would have brought it.
void wait_until(const std::string& what, const std::function<bool()>& has_come) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (!has_come()) {
        if (std::chrono::steady_clock::now() > until) throw std::runtime_error("waited in vain for " + what);
    }
}

void wait_for_scans(const RunningServer& server, std::uint64_t scans) {
    wait_until(std::to_string(scans) + " scans on the server", [&] { return scans_of(server) >= scans; });
}

std::vector<Scan> scans_in_spool(const std::filesystem::path& directory) {
    std::vector<std::filesystem::path> files;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(directory, missing)) {
        if (entry.path().extension() == ".spool") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    std::vector<Scan> scans;
    for (const auto& file : files) {
        auto reader = robot::SegmentReader::open(file);
        while (reader) {
            const auto record = reader->next();
            if (!record || !*record) break;
            const auto* batch = std::get_if<wire::ScanBatch>(&(*record)->message);
            if (batch != nullptr) std::ranges::copy(batch->scans, std::back_inserter(scans));
        }
    }
    return scans;
}

/// See turns().
int turn_of(const Scan& scan) { return static_cast<int>(*std::ranges::min_element(scan.ranges)) - kRangeOfTurn0; }

class OutageTest : public testing::Test {
protected:
    /// A robot whose server is at `port`.
    std::unique_ptr<ChildProcess> start_robot(std::uint16_t port, const Lidar& lidar,
                                              const std::vector<std::string>& options = {}) {
        std::vector<std::string> arguments{
            "--server", "127.0.0.1:" + std::to_string(port), "--session", "s", "--robot", "r", "--cell-size", "0.1",
            "--spool",  (place_.path() / "spool").string()};
        std::ranges::copy(options, std::back_inserter(arguments));
        std::ranges::copy(std::vector<std::string>{"ld06", lidar.address(), "--pose", "1,2,0.3"},
                          std::back_inserter(arguments));
        return std::make_unique<ChildProcess>(program("scanloom-robot"), arguments, place_.path() / "robot");
    }

    [[nodiscard]] std::vector<Scan> spooled() const { return scans_in_spool(place_.path() / "spool" / "s.r"); }

    void wait_for_turn_in_spool(int turn) const {
        wait_until("turn " + std::to_string(turn) + " in the spool", [&] {
            const auto scans = spooled();
            return !scans.empty() && turn_of(scans.back()) == turn;
        });
    }

    /// Everything in one go.
    std::string undisturbed_digest(int turns_in_all) {
        TemporaryDirectory place;
        RunningServer server(place.path() / "store", place.path() / "log");
        Lidar lidar;
        ChildProcess robot(program("scanloom-robot"),
                           {"--server", server.robot_address(), "--session", "s", "--robot", "r", "--cell-size", "0.1",
                            "ld06", lidar.address(), "--pose", "1,2,0.3"},
                           place.path() / "robot");
        lidar.wait_for_robot();
        lidar.send(turns(1, turns_in_all));
        wait_for_scans(server, static_cast<std::uint64_t>(turns_in_all));
        robot.signal(SIGTERM);
        EXPECT_EQ(robot.wait(), 0);
        return server.get("/api/v1/sessions/s/digest").body;
    }

    TemporaryDirectory place_;
};

TEST_F(OutageTest, NothingIsLostWhileTheNetworkIsAwayAndTheProgramIsKilledMeanwhile) {
    RunningServer server(place_.path() / "store", place_.path() / "log");
    TcpProxy link(server.robot_port());
    Lidar lidar;
    auto robot = start_robot(link.port(), lidar);
    lidar.wait_for_robot();
    const Bytes bytes = turns(1, 40);
    const auto quarter = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 4);
    lidar.send({bytes.begin(), quarter});
    wait_for_scans(server, 9);

    link.cut();
    lidar.send({quarter, bytes.end()});
    wait_until("40 scans in the spool", [&] { return spooled().size() >= 40; });
    robot->signal(SIGKILL);
    EXPECT_EQ(robot->wait(), -SIGKILL);

    robot = start_robot(link.port(), lidar);
    lidar.wait_for_robot();
    lidar.send(turns(41, 60));
    wait_until("60 scans in the spool", [&] { return spooled().size() >= 60; });
    EXPECT_LE(scans_of(server), 10U) << "the network is away"; // the tenth was in the quarter, too
    link.restore();
    wait_for_scans(server, 60);
    robot->signal(SIGTERM);
    EXPECT_EQ(robot->wait(), 0);
    EXPECT_EQ(scans_of(server), 60U);
    EXPECT_EQ(server.get("/api/v1/sessions/s/digest").body, undisturbed_digest(60));
    EXPECT_EQ(spooled().size(), 0U) << "what is stored needs no room";
}

/// Killed again and again while it sends what waits, at another moment each time; the spool has several files.
TEST_F(OutageTest, NothingIsLostOrDoubledWhereverTheProgramIsKilled) {
    constexpr int kTurnsPerRound = 30;
    RunningServer server(place_.path() / "store", place_.path() / "log");
    TcpProxy link(server.robot_port());
    std::mt19937 random(7);
    int taken = 0;
    for (int round = 0; round < 8; ++round) {
        link.cut();
        const std::uint64_t stored = scans_of(server);
        Lidar lidar;
        const std::string compression = round % 2 == 0 ? "none" : "zstd";
        auto robot = start_robot(link.port(), lidar, {"--spool-size", "1", "--compression", compression});
        lidar.wait_for_robot();
        lidar.send(turns(taken + 1, taken + kTurnsPerRound));
        taken += kTurnsPerRound;
        wait_for_turn_in_spool(taken);
        link.restore();
        wait_for_scans(server, stored + random() % (static_cast<std::uint64_t>(taken) - stored));
        robot->signal(SIGKILL);
        EXPECT_EQ(robot->wait(), -SIGKILL);
    }
    Lidar lidar;
    auto robot = start_robot(link.port(), lidar, {"--spool-size", "1"});
    lidar.wait_for_robot();
    lidar.send(turns(taken + 1, taken + 1)); // the server may hold all others by now
    taken += 1;
    wait_for_scans(server, static_cast<std::uint64_t>(taken));
    robot->signal(SIGTERM);
    EXPECT_EQ(robot->wait(), 0);
    EXPECT_EQ(scans_of(server), static_cast<std::uint64_t>(taken));
    EXPECT_EQ(server.get("/api/v1/sessions/s/digest").body, undisturbed_digest(taken));
}

} // namespace
} // namespace scanloom::test
