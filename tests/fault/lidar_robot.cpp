#include "tests/fault/lidar_robot.hpp"

#include "robot_client/spool/segment.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iterator>
#include <stdexcept>

namespace scanloom::fault {

namespace asio = boost::asio;
using asio::ip::tcp;
using testing_support::append;
using testing_support::Bytes;
using testing_support::bytes_of;

namespace {

constexpr int kPointsPerTurn = 450; // of Ld06Spinner
constexpr int kFirstPoint = 375;    // in the turn that is not observed from its start
constexpr int kRangeOfTurn0 = 1000; // mm, straight ahead

std::vector<Scan> scans_in(const std::filesystem::path& directory) {
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

} // namespace

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

int turn_of(const Scan& scan) { return static_cast<int>(*std::ranges::min_element(scan.ranges)) - kRangeOfTurn0; }

Lidar::Lidar() : acceptor_(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0)) {}

std::string Lidar::address() const { return fmt::format("tcp://127.0.0.1:{}", acceptor_.local_endpoint().port()); }

void Lidar::send(const Bytes& bytes) { asio::write(*socket_, asio::buffer(bytes)); }

test::ChildProcess start_lidar_robot(const std::filesystem::path& place, std::uint16_t port, const Lidar& lidar,
                                     const std::vector<std::string>& options, const Command& robot) {
    std::vector<std::string> words = robot.words;
    std::ranges::copy(std::vector<std::string>{"--server", fmt::format("127.0.0.1:{}", port), "--session", "s",
                                               "--robot", "r", "--cell-size", "0.1", "--spool",
                                               (place / "spool").string()},
                      std::back_inserter(words));
    std::ranges::copy(options, std::back_inserter(words));
    std::ranges::copy(std::vector<std::string>{"ld06", lidar.address(), "--pose", "1,2,0.3"},
                      std::back_inserter(words));
    return {robot.program.empty() ? test::program("scanloom-robot") : robot.program, words, place / "robot"};
}

std::vector<Scan> spooled(const std::filesystem::path& place) { return scans_in(place / "spool" / "s.r"); }

std::uint64_t scans_of(std::uint16_t http_port) {
    const auto answer = test::http_request(http_port, "GET", "/api/v1/sessions/s");
    return answer.status == 200 ? boost::json::parse(answer.body).at("scans").to_number<std::uint64_t>() : 0;
}

std::vector<int> turns_of(std::uint16_t http_port) {
    std::vector<int> turns;
    if (scans_of(http_port) == 0) return turns; // the session may not exist yet
    for (const auto& entry : ask_for(http_port, "s").log) {
        if (const auto* taken = std::get_if<ScanTaken>(&entry)) turns.push_back(turn_of(taken->scan));
    }
    return turns;
}

void wait_until(const std::string& what, const std::function<bool()>& has_come) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (!has_come()) {
        if (std::chrono::steady_clock::now() > until) throw std::runtime_error("timeout while waiting for " + what);
    }
}

void wait_for_scans(std::uint16_t http_port, std::uint64_t scans) {
    wait_until(std::to_string(scans) + " scans on the server", [&] { return scans_of(http_port) >= scans; });
}

std::string peaceful_digest(int turns_in_all) {
    const TemporaryDirectory place;
    const test::RunningServer server(place.path() / "store", place.path() / "log");
    Lidar lidar;
    auto robot = start_lidar_robot(place.path(), server.robot_port(), lidar);
    lidar.wait_for_robot();
    lidar.send(turns(1, turns_in_all));
    wait_for_scans(server.http_port(), static_cast<std::uint64_t>(turns_in_all));
    robot.signal(SIGTERM);
    if (const int code = robot.wait(); code != 0)
        throw std::runtime_error(fmt::format("the robot exited with {}", code));
    return server.get("/api/v1/sessions/s/digest").body;
}

} // namespace scanloom::fault
