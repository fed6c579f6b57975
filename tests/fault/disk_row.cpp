#include "tests/fault/disk_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/loop_disk.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kDiskBytes = std::uint64_t{128} << 20;
constexpr std::uint64_t kReserveMib = 16; // that the server keeps free
constexpr std::uint64_t kFillingsPerDisk = 5;
constexpr std::uint64_t kScansPerFilling = 100; // of each robot
constexpr unsigned kRobots = 4;

/// Somebody else's file, that takes the disk's room for as long as this lives.
class Ballast {
public:
    explicit Ballast(fs::path path) : path_(std::move(path)), file_(::open(path_.c_str(), O_WRONLY | O_CREAT, 0600)) {}
    ~Ballast() {
        ::close(file_);
        ::unlink(path_.c_str());
    }
    Ballast(const Ballast&) = delete;
    Ballast& operator=(const Ballast&) = delete;

    /// Leaves so many bytes free, if there are more.
    void grow(std::uint64_t left) {
        const auto free = fs::space(path_.parent_path()).available;
        if (free <= left) return;
        const int failed = ::posix_fallocate(file_, static_cast<off_t>(bytes_), static_cast<off_t>(free - left));
        if (failed == 0) bytes_ += free - left; // else the server was quicker
    }

private:
    fs::path path_;
    int file_;
    std::uint64_t bytes_ = 0;
};

unsigned readiness(const ServerProcess& server) {
    return test::http_request(server.http_port(), "GET", "/readyz").status;
}

/// Waits until the server says that it is ready, or that it is not, doing something again and again.
/// @return false when it has not after a minute, as it never will.
bool wait_for_readiness(
    const ServerProcess& server, unsigned status, const std::function<void()>& doing = [] {}) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (readiness(server) != status) {
        if (std::chrono::steady_clock::now() > until) return false;
        doing();
        server.let_be(std::chrono::milliseconds(5));
    }
    return true;
}

void check_that_maps_are_served(const ServerProcess& server, Outcome& outcome) {
    const auto status = test::http_request(server.http_port(), "GET", "/api/v1/sessions/shared/digest").status;
    if (status != 200) outcome.amiss.push_back(fmt::format("on a full disk a digest is answered with {}", status));
}

Result<Outcome> fill_one_disk(const Run& run, std::uint64_t seed, std::uint64_t fillings) {
    const TemporaryDirectory place;
    const auto store = place.path() / "store";
    auto disk = LoopDisk::make(place.path() / "disk", store, kDiskBytes);
    if (!disk) return disk.error();
    std::mt19937_64 random(seed);
    ServerProcess server(run.server, place.path(), {"--disk-reserve", std::to_string(kReserveMib)});
    Fleet fleet(half_sharing(kRobots, seed, fillings * kScansPerFilling), server.robot_port());
    server.start_and_wait();
    fleet.release(1);
    (void)fleet.wait_for_acknowledged(kRobots); // on a full disk no session can be made
    Outcome outcome;
    for (std::uint64_t filling = 1; filling <= fillings && !fleet.has_given_up(); ++filling) {
        fleet.release(filling * kScansPerFilling - kScansPerFilling / 2);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (kRobots * kScansPerFilling / 2));
        {
            Ballast ballast(store / "ballast");
            const auto left = random() % (kReserveMib << 18); // the superuser has some more
            ballast.grow(left);
            fleet.release(filling * kScansPerFilling);
            // The store frees some of its own, now and then.
            if (!wait_for_readiness(server, 503, [&] { ballast.grow(left); }))
                outcome.amiss.emplace_back("a full disk keeps nobody from being ready");
            check_that_maps_are_served(server, outcome);
        }
        if (!wait_for_readiness(server, 200)) outcome.amiss.emplace_back("room on the disk makes nobody ready again");
    }
    fleet.release_all();
    outcome.add(verify_server(server.http_port(), fleet.finish()));
    return outcome;
}

/// `fiu-run` and what it needs, in front of the server.
ServerCommand with_failing_syncs(const ServerCommand& server) {
    const auto program = server.program.empty() ? test::program("scanloom-server") : server.program;
    std::vector<std::string> words{"-x", "-c", "enable_random name=posix/io/sync/*,probability=0.2", program.string()};
    words.insert(words.end(), server.words.begin(), server.words.end());
    return {"/usr/bin/fiu-run", std::move(words)};
}

std::uint64_t lines_ending_with(std::string_view text, const fs::path& log) {
    std::ifstream in(log);
    std::uint64_t count = 0;
    for (std::string line; std::getline(in, line);) count += line.ends_with(text) ? 1 : 0;
    return count;
}

Outcome fail_syncs(const Run& run, std::uint64_t seed, std::uint64_t scans) {
    const TemporaryDirectory place;
    ServerProcess server(with_failing_syncs(run.server), place.path(), {"--disk-reserve", "0"});
    Fleet fleet(half_sharing(kRobots, seed, scans / kRobots), server.robot_port());
    fleet.release_all();
    std::uint64_t starts = 0;
    do { // a new store syncs a dozen files, one of which may fail
        if (++starts > 1) (void)server.wait();
        server.start();
    } while (!server.becomes_ready() && starts < 100);
    auto robots = fleet.finish();
    (void)wait_for_readiness(server, 200);
    auto outcome = verify_server(server.http_port(), robots);
    for (const auto& robot : robots) outcome.figures["reconnects"] += robot.reconnects;
    outcome.figures["starts"] += starts;
    outcome.figures["opened_again"] += lines_ending_with("has been opened again", place.path() / "log");
    return outcome;
}

} // namespace

Outcome run_disk_row(const Run& run) {
    return run_cases(
        run, {.row = "disk", .of_count = kFillingsPerDisk, .run = [&](std::uint64_t seed, std::uint64_t fillings) {
                  auto outcome = fill_one_disk(run, seed, fillings);
                  return outcome ? std::move(*outcome) : Outcome{.skipped = outcome.error().message};
              }});
}

Outcome run_sync_row(const Run& run) {
    if (!fs::exists("/usr/bin/fiu-run")) return {.skipped = "fiu-run is not installed; fiu-utils has it"};
    return run_cases(run, {.row = "sync", .of_count = 1'000, .run = [&](std::uint64_t seed, std::uint64_t scans) {
                               return fail_syncs(run, seed, scans);
                           }});
}

} // namespace scanloom::fault
