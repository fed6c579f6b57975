#include "tests/fault/beside.hpp"

#include "server/store/scan_log.hpp"
#include "tests/fault/paces.hpp"
#include "tests/fault/process_memory.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace scanloom::fault {
namespace {

using namespace std::chrono_literals;

constexpr Rounds kLongForm{.count = 3, .duration = 20s, .must_keep_up = true};

constexpr std::size_t kBytesOfGreed = std::size_t{4} << 20;  // twice a robot's credit
constexpr std::size_t kBytesOfEach = std::size_t{128} << 10; // twice what connections that read nothing took

// The server's deadlines for clients that never finish (RobotLink, http::Connection).
constexpr std::chrono::seconds kHelloDeadline{5};
constexpr std::chrono::seconds kHeaderDeadline{10};
constexpr std::chrono::seconds kBodyDeadline{30};

void check_memory(std::uint64_t before, std::uint64_t after, const Beside& beside, Outcome& outcome) {
    const std::uint64_t grown = after - std::min(before, after);
    const std::uint64_t most = beside.size * beside.bytes_of_each_max + beside.bytes_besides;
    auto& told = outcome.figures["memory_grown_kib"];
    told = std::max(told, grown >> 10);
    if (grown <= most) return;
    outcome.amiss.push_back(fmt::format("the server took {} MiB more for a crowd of {}, at most {} MiB are allowed",
                                        grown >> 20, beside.size, most >> 20));
}

void check_deadlines(const Crowd& crowd, const Beside& beside, Outcome& outcome) {
    const auto there = crowd.wait_until_hung_up_on(beside.deadline);
    outcome.figures["hung_up_on"] += crowd.hung_up_on();
    if (there == 0) return;
    outcome.amiss.push_back(
        fmt::format("{} of a crowd of {} were not hung up on, though their deadlines have passed", there, beside.size));
}

std::string upgrade_to_live(const std::string& session, std::uint16_t port) {
    return fmt::format("GET /api/v1/sessions/{}/live HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\n"
                       "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
                       session, port);
}

/// Robots that send as fast as the server permits, for some time. Does nothing if their number is 0.
class Greed {
public:
    Greed(const ServerProcess& server, const Beside& beside, std::uint64_t seed, std::chrono::seconds duration,
          const std::filesystem::path& place) {
        if (beside.greedy > 0) load_.emplace(server, PacedLoad::Robots{beside.greedy, 1, 0}, seed, duration, place);
    }

    /// Adds the number of scans they sent as the figure of that name.
    void finish(const char* figure, Outcome& outcome) {
        if (!load_) return;
        const auto report = load_->finish();
        outcome.figures[figure] += report.outcome.acknowledged;
        outcome.add(report.outcome);
    }

private:
    std::optional<PacedLoad> load_;
};

/// The loads of a round, each with its own seeds.
std::uint64_t seed_of(const Run& run, unsigned load) { return run.seed * 4 + load; }

std::optional<double> pace_alone(const ServerProcess& server, const Run& run, const Beside& beside,
                                 const std::filesystem::path& place, Outcome& outcome) {
    const auto report = PacedLoad(server, {}, seed_of(run, 3), beside.rounds.duration, place).finish();
    outcome.add(report.outcome);
    return report.p99_ms;
}

/// Measures the acknowledgement latency without the crowd. The greedy robots stream to another server meanwhile, so
/// that the load of the machine is equal.
std::optional<double> pace_in_peace(const ServerProcess& server, const Run& run, const Beside& beside,
                                    const std::filesystem::path& place, Outcome& outcome) {
    const TemporaryDirectory other_place;
    ServerProcess other(run.server, other_place.path());
    if (beside.greedy > 0) other.start_and_wait();
    PacedLoad load(server, {}, seed_of(run, 0), beside.rounds.duration, place);
    load.wait_until_it_streams();
    Greed greed(other, beside, seed_of(run, 2), beside.rounds.duration, other_place.path());
    const auto report = load.finish();
    outcome.add(report.outcome);
    greed.finish("scans_of_greed_elsewhere", outcome);
    return report.p99_ms;
}

void run_round(const Run& run, const Beside& beside, Paces& paces, Outcome& outcome) {
    const TemporaryDirectory place;
    ServerProcess server(run.server, place.path());
    server.start_and_wait();
    if (beside.is_tried_alone) paces.alone.push_back(pace_alone(server, run, beside, place.path(), outcome));
    paces.in_peace.push_back(pace_in_peace(server, run, beside, place.path(), outcome));
    const auto before = resident_bytes(server.id());
    PacedLoad load(server, {}, seed_of(run, 1), beside.rounds.duration, place.path());
    load.wait_until_it_streams();
    Greed greed(server, beside, seed_of(run, 2), beside.rounds.duration, place.path());
    Crowd crowd(beside.crowd ? beside.crowd(server, load) : std::vector<Manner>());
    crowd.wait_until_there();
    const auto disturbed = load.finish();
    outcome.add(disturbed.outcome);
    check_memory(before, resident_bytes(server.id()), beside, outcome);
    greed.finish("scans_of_greed", outcome);
    paces.beside.push_back(disturbed.p99_ms);
    check_deadlines(crowd, beside, outcome);
    if (const auto status = test::http_request(server.http_port(), "GET", "/readyz").status; status != 200)
        outcome.amiss.push_back(fmt::format("/readyz is answered with {} beside the crowd", status));
}

} // namespace

Outcome compare_with_peace(const Run& run, const Beside& beside) {
    Outcome outcome;
    Paces paces;
    for (unsigned round = 0; round < beside.rounds.count; ++round) run_round(run, beside, paces, outcome);
    check_paces(paces, beside.rounds.must_keep_up, outcome);
    return outcome;
}

Beside beside_viewers(const Run& run) {
    Beside beside{.size = run.count, .bytes_of_each_max = kBytesOfEach, .rounds = run.is_long ? kLongForm : Rounds{}};
    beside.crowd = [count = run.count](const ServerProcess& server, const PacedLoad& load) {
        std::vector<Manner> viewers;
        for (unsigned n = 0; n < count; ++n) {
            const auto session = load.session(n % PacedLoad::kSessions);
            viewers.push_back({server.http_port(), upgrade_to_live(session, server.http_port()), "", 0ms, false});
        }
        return viewers;
    };
    return beside;
}

Beside beside_greed(const Run& run) {
    Beside beside{.size = run.count,
                  .bytes_of_each_max = kBytesOfGreed,
                  .rounds = run.is_long ? kLongForm : Rounds{},
                  .is_tried_alone = run.is_long,
                  .greedy = static_cast<unsigned>(run.count)};
    beside.bytes_besides += store::StoreOptions{}.memory_bytes; // size of its write buffers and cache
    return beside;
}

Beside beside_flood(const Run& run) {
    Beside beside{.size = run.count,
                  .bytes_of_each_max = kBytesOfEach,
                  .rounds = run.is_long ? kLongForm : Rounds{},
                  .deadline = run.is_long ? kBodyDeadline : kHeaderDeadline};
    beside.crowd = [count = run.count](const ServerProcess& server, const PacedLoad& load) {
        const auto robots = server.robot_port();
        const auto http = server.http_port();
        const std::string noise(1024, '\xa5');
        const auto map =
            fmt::format("GET /api/v1/sessions/{}/map.png HTTP/1.1\r\nHost: localhost\r\n\r\n", load.session(0));
        const std::string header = "GET / HTTP/1.1\r\nHost: localhost\r\n";
        const std::string body = "POST /api/v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999\r\n\r\n";
        const std::vector<Manner> manners{
            {robots, "", "", 0ms, true, kHelloDeadline},                           // sends nothing
            {robots, std::string("\0\0\1", 3), "\1", 500ms, true, kHelloDeadline}, // a hello that never ends
            {robots, noise, noise, 50ms, true, kHelloDeadline},       // invalid bytes with too large a length
            {http, header, "X: y\r\n", 500ms, true, kHeaderDeadline}, // a header that never ends
            {http, body, "{", 500ms, true, kBodyDeadline},            // a body that never ends
            {http, map, map, 100ms, false}, // sends more and more requests and reads no answer
        };
        std::vector<Manner> crowd;
        for (unsigned n = 0; n < count; ++n) crowd.push_back(manners[n % manners.size()]);
        return crowd;
    };
    return beside;
}

Outcome run_viewers_row(const Run& run) { return compare_with_peace(run, beside_viewers(run)); }
Outcome run_flood_row(const Run& run) { return compare_with_peace(run, beside_flood(run)); }
Outcome run_greed_row(const Run& run) { return compare_with_peace(run, beside_greed(run)); }

} // namespace scanloom::fault
