#include "tests/fault/crowd_rows.hpp"

#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"
#include "tests/fault/ack_latency.hpp"
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

// The server's deadlines for clients that never finish (link::ServerProtocol, http::Connection).
constexpr std::chrono::seconds kHelloDeadline{5};
constexpr std::chrono::seconds kHeaderDeadline{10};
constexpr std::chrono::seconds kBodyDeadline{30};

void check_memory(std::uint64_t before, std::uint64_t after, const CrowdTrial& trial, Outcome& outcome) {
    const std::uint64_t grown = after - std::min(before, after);
    const std::uint64_t most = trial.size * trial.bytes_of_each_max + trial.bytes_base;
    auto& grown_max = outcome.figures["memory_grown_kib"];
    grown_max = std::max(grown_max, grown >> 10);
    if (grown <= most) return;
    outcome.failures.push_back(fmt::format("the server used {} MiB more with {} clients, at most {} MiB are allowed",
                                           grown >> 20, trial.size, most >> 20));
}

void check_deadlines(const Crowd& crowd, const CrowdTrial& trial, Outcome& outcome) {
    const auto connected = crowd.wait_until_disconnected(trial.deadline);
    outcome.figures["disconnected"] += crowd.disconnected();
    if (connected == 0) return;
    outcome.failures.push_back(
        fmt::format("{} of {} clients were not disconnected after their deadlines", connected, trial.size));
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
    Greed(const ServerProcess& server, const CrowdTrial& trial, std::uint64_t seed, std::chrono::seconds duration,
          const std::filesystem::path& place) {
        if (trial.greedy > 0) load_.emplace(server, PacedLoad::Robots{trial.greedy, 1, 0}, seed, duration, place);
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

std::optional<double> idle_latency(const ServerProcess& server, const Run& run, const CrowdTrial& trial,
                                   const std::filesystem::path& place, Outcome& outcome) {
    const auto report = PacedLoad(server, {}, seed_of(run, 3), trial.rounds.duration, place).finish();
    outcome.add(report.outcome);
    return report.p99_ms;
}

/// Measures the acknowledgement latency without the crowd. The greedy robots stream to another server meanwhile, so
/// that the load of the machine is equal.
std::optional<double> baseline_latency(const ServerProcess& server, const Run& run, const CrowdTrial& trial,
                                       const std::filesystem::path& place, Outcome& outcome) {
    const TemporaryDirectory other_place;
    ServerProcess other(run.server, other_place.path());
    if (trial.greedy > 0) other.start_and_wait();
    PacedLoad load(server, {}, seed_of(run, 0), trial.rounds.duration, place);
    load.wait_until_it_streams();
    Greed greed(other, trial, seed_of(run, 2), trial.rounds.duration, other_place.path());
    const auto report = load.finish();
    outcome.add(report.outcome);
    greed.finish("scans_of_greed_elsewhere", outcome);
    return report.p99_ms;
}

void run_round(const Run& run, const CrowdTrial& trial, AckLatency& latency, Outcome& outcome) {
    const TemporaryDirectory place;
    ServerProcess server(run.server, place.path());
    server.start_and_wait();
    if (trial.is_tried_alone) latency.alone.push_back(idle_latency(server, run, trial, place.path(), outcome));
    latency.baseline.push_back(baseline_latency(server, run, trial, place.path(), outcome));
    const auto before = resident_bytes(server.id());
    PacedLoad load(server, {}, seed_of(run, 1), trial.rounds.duration, place.path());
    load.wait_until_it_streams();
    Greed greed(server, trial, seed_of(run, 2), trial.rounds.duration, place.path());
    Crowd crowd(trial.crowd ? trial.crowd(server, load) : std::vector<Behaviour>());
    crowd.wait_until_connected();
    const auto disturbed = load.finish();
    outcome.add(disturbed.outcome);
    check_memory(before, resident_bytes(server.id()), trial, outcome);
    greed.finish("scans_of_greed", outcome);
    latency.with_crowd.push_back(disturbed.p99_ms);
    check_deadlines(crowd, trial, outcome);
    if (const auto status = test::http_request(server.http_port(), "GET", "/readyz").status; status != 200)
        outcome.failures.push_back(fmt::format("/readyz answers {} with the crowd", status));
}

} // namespace

Outcome compare_with_baseline(const Run& run, const CrowdTrial& trial) {
    Outcome outcome;
    AckLatency latency;
    for (unsigned round = 0; round < trial.rounds.count; ++round) run_round(run, trial, latency, outcome);
    check_latency(latency, trial.rounds.must_keep_up, outcome);
    return outcome;
}

CrowdTrial viewers_trial(const Run& run) {
    CrowdTrial trial{
        .size = run.count, .bytes_of_each_max = kBytesOfEach, .rounds = run.is_long ? kLongForm : Rounds{}};
    trial.crowd = [count = run.count](const ServerProcess& server, const PacedLoad& load) {
        std::vector<Behaviour> viewers;
        for (unsigned n = 0; n < count; ++n) {
            const auto session = load.session(n % PacedLoad::kSessions);
            viewers.push_back({server.http_port(), upgrade_to_live(session, server.http_port()), "", 0ms, false});
        }
        return viewers;
    };
    return trial;
}

CrowdTrial greed_trial(const Run& run) {
    CrowdTrial trial{.size = run.count,
                     .bytes_of_each_max = kBytesOfGreed,
                     .rounds = run.is_long ? kLongForm : Rounds{},
                     .is_tried_alone = run.is_long,
                     .greedy = static_cast<unsigned>(run.count)};
    trial.bytes_base += store::StoreOptions{}.memory_bytes; // size of its write buffers and cache
    return trial;
}

CrowdTrial flood_trial(const Run& run) {
    CrowdTrial trial{.size = run.count,
                     .bytes_of_each_max = kBytesOfEach,
                     .rounds = run.is_long ? kLongForm : Rounds{},
                     .deadline = run.is_long ? kBodyDeadline : kHeaderDeadline};
    trial.crowd = [count = run.count](const ServerProcess& server, const PacedLoad& load) {
        const auto robots = server.robot_port();
        const auto http = server.http_port();
        const std::string noise(1024, '\xa5');
        const auto map =
            fmt::format("GET /api/v1/sessions/{}/map.png HTTP/1.1\r\nHost: localhost\r\n\r\n", load.session(0));
        const std::string header = "GET / HTTP/1.1\r\nHost: localhost\r\n";
        const std::string body = "POST /api/v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999\r\n\r\n";
        const std::vector<Behaviour> behaviours{
            {robots, "", "", 0ms, true, kHelloDeadline},                           // sends nothing
            {robots, std::string("\0\0\1", 3), "\1", 500ms, true, kHelloDeadline}, // a hello that never ends
            {robots, noise, noise, 50ms, true, kHelloDeadline},       // invalid bytes with too large a length
            {http, header, "X: y\r\n", 500ms, true, kHeaderDeadline}, // a header that never ends
            {http, body, "{", 500ms, true, kBodyDeadline},            // a body that never ends
            {http, map, map, 100ms, false}, // sends more and more requests and reads no answer
        };
        std::vector<Behaviour> crowd;
        for (unsigned n = 0; n < count; ++n) crowd.push_back(behaviours[n % behaviours.size()]);
        return crowd;
    };
    return trial;
}

Outcome run_viewers_row(const Run& run) { return compare_with_baseline(run, viewers_trial(run)); }
Outcome run_flood_row(const Run& run) { return compare_with_baseline(run, flood_trial(run)); }
Outcome run_greed_row(const Run& run) { return compare_with_baseline(run, greed_trial(run)); }

} // namespace scanloom::fault
