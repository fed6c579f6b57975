#include "tests/fault/beside.hpp"

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

constexpr unsigned kRounds = 3;

constexpr std::size_t kBytesOfGreed = std::size_t{4} << 20;   // twice a robot's credit
constexpr std::size_t kBytesOfStore = std::size_t{140} << 20; // its buffers and cache, which so much fills
constexpr std::size_t kBytesOfEach = std::size_t{128} << 10;  // twice what those took who read nothing

// Of the server, for those who never finish (RobotLink, http::Connection).
constexpr std::chrono::seconds kHelloDeadline{5};
constexpr std::chrono::seconds kHeaderDeadline{10};
constexpr std::chrono::seconds kBodyDeadline{30};

/// Milliseconds, p99 of acknowledgements, a figure of each round.
struct Paces {
    std::vector<double> in_peace;
    std::vector<double> beside;
};

double median(std::vector<double> figures) {
    std::ranges::sort(figures);
    return figures[figures.size() / 2];
}

void check_memory(std::uint64_t before, std::uint64_t after, const Beside& beside, Outcome& outcome) {
    const std::uint64_t grown = after - std::min(before, after);
    const std::uint64_t most = beside.size * beside.bytes_of_each_max + beside.bytes_besides;
    auto& told = outcome.figures["memory_grown_kib"];
    told = std::max(told, grown >> 10);
    if (grown <= most) return;
    outcome.amiss.push_back(fmt::format("the server took {} MiB more for a crowd of {}, at most {} MiB are allowed",
                                        grown >> 20, beside.size, most >> 20));
}

void check_paces(const Paces& paces, const Beside& beside, Outcome& outcome) {
    const double in_peace_ms = median(paces.in_peace);
    const double beside_ms = median(paces.beside);
    outcome.figures["p99_in_peace_us"] = static_cast<std::uint64_t>(in_peace_ms * 1e3);
    outcome.figures["p99_beside_us"] = static_cast<std::uint64_t>(beside_ms * 1e3);
    if (!beside.must_keep_up || beside_ms <= 2.0 * in_peace_ms) return;
    outcome.amiss.push_back(fmt::format("acknowledgements took {:.1f} ms (p99) beside the crowd, {:.1f} ms in peace",
                                        beside_ms, in_peace_ms));
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

/// Robots that send as fast as they are let, for a while. Nothing where there are to be none.
class Greed {
public:
    Greed(const ServerProcess& server, const Beside& beside, std::uint64_t seed, std::chrono::seconds duration,
          const std::filesystem::path& place) {
        if (beside.greedy > 0) load_.emplace(server, PacedLoad::Robots{beside.greedy, 1, 0}, seed, duration, place);
    }

    void finish(Outcome& outcome) {
        if (!load_) return;
        const auto report = load_->finish();
        outcome.figures["scans_of_greed"] += report.outcome.acknowledged;
        outcome.add(report.outcome);
    }

private:
    std::optional<PacedLoad> load_;
};

/// How long acknowledgements take in peace; the greed goes to another server meanwhile, so that the machine has as much
/// to do.
double pace_in_peace(const ServerProcess& server, const Run& run, const Beside& beside, std::chrono::seconds duration,
                     const std::filesystem::path& place, Outcome& outcome) {
    const TemporaryDirectory other_place;
    ServerProcess other(run.server, other_place.path());
    if (beside.greedy > 0) other.start_and_wait();
    PacedLoad load(server, {}, run.seed * 3, duration, place);
    load.wait_until_it_streams();
    Greed greed(other, beside, run.seed * 3 + 2, duration, other_place.path());
    const auto report = load.finish();
    outcome.add(report.outcome);
    greed.finish(outcome);
    return report.p99_ms;
}

void run_round(const Run& run, const Beside& beside, Paces& paces, Outcome& outcome) {
    const auto duration = beside.must_keep_up ? 20s : 3s;
    const TemporaryDirectory place;
    ServerProcess server(run.server, place.path());
    server.start_and_wait();
    paces.in_peace.push_back(pace_in_peace(server, run, beside, duration, place.path(), outcome));
    const auto before = resident_bytes(server.id());
    PacedLoad load(server, {}, run.seed * 3 + 1, duration, place.path());
    load.wait_until_it_streams();
    Greed greed(server, beside, run.seed * 3 + 2, duration, place.path());
    Crowd crowd(beside.crowd ? beside.crowd(server, load) : std::vector<Manner>());
    crowd.wait_until_there();
    const auto disturbed = load.finish();
    outcome.add(disturbed.outcome);
    check_memory(before, resident_bytes(server.id()), beside, outcome);
    greed.finish(outcome);
    paces.beside.push_back(disturbed.p99_ms);
    check_deadlines(crowd, beside, outcome);
    if (const auto status = test::http_request(server.http_port(), "GET", "/readyz").status; status != 200)
        outcome.amiss.push_back(fmt::format("/readyz is answered with {} beside the crowd", status));
}

} // namespace

Outcome compare_with_peace(const Run& run, const Beside& beside) {
    Outcome outcome;
    Paces paces;
    for (unsigned round = 0; round < (beside.must_keep_up ? kRounds : 1); ++round) {
        run_round(run, beside, paces, outcome);
    }
    check_paces(paces, beside, outcome);
    return outcome;
}

Outcome run_viewers_row(const Run& run) {
    Beside beside{.size = run.count, .bytes_of_each_max = kBytesOfEach, .must_keep_up = run.count >= kViewersLong};
    beside.crowd = [&](const ServerProcess& server, const PacedLoad& load) {
        std::vector<Manner> viewers;
        for (unsigned n = 0; n < run.count; ++n) {
            const auto session = load.session(n % PacedLoad::kSessions);
            viewers.push_back({server.http_port(), upgrade_to_live(session, server.http_port()), "", 0ms, false});
        }
        return viewers;
    };
    return compare_with_peace(run, beside);
}

Outcome run_greed_row(const Run& run) {
    return compare_with_peace(run, {.size = run.count,
                                    .bytes_of_each_max = kBytesOfGreed,
                                    .bytes_besides = kBytesOfStore,
                                    .must_keep_up = run.count >= kGreedLong,
                                    .greedy = static_cast<unsigned>(run.count)});
}

Outcome run_flood_row(const Run& run) {
    const bool is_long = run.count >= kFloodLong;
    Beside beside{.size = run.count,
                  .bytes_of_each_max = kBytesOfEach,
                  .must_keep_up = is_long,
                  .deadline = is_long ? kBodyDeadline : kHeaderDeadline};
    beside.crowd = [&](const ServerProcess& server, const PacedLoad& load) {
        const auto robots = server.robot_port();
        const auto http = server.http_port();
        const std::string noise(1024, '\xa5');
        const auto map =
            fmt::format("GET /api/v1/sessions/{}/map.png HTTP/1.1\r\nHost: localhost\r\n\r\n", load.session(0));
        const std::string header = "GET / HTTP/1.1\r\nHost: localhost\r\n";
        const std::string body = "POST /api/v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9999\r\n\r\n";
        const std::vector<Manner> manners{
            {robots, "", "", 0ms, true, kHelloDeadline},                           // says nothing
            {robots, std::string("\0\0\1", 3), "\1", 500ms, true, kHelloDeadline}, // a hello that takes for ever
            {robots, noise, noise, 50ms, true, kHelloDeadline},       // nonsense, of a length that is too large
            {http, header, "X: y\r\n", 500ms, true, kHeaderDeadline}, // a header that takes for ever
            {http, body, "{", 500ms, true, kBodyDeadline},            // likewise
            {http, map, map, 100ms, false},                           // asks for more and more, and reads none of it
        };
        std::vector<Manner> crowd;
        for (unsigned n = 0; n < run.count; ++n) crowd.push_back(manners[n % manners.size()]);
        return crowd;
    };
    return compare_with_peace(run, beside);
}

} // namespace scanloom::fault
