#include "tests/fault/disk_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/loop_disk.hpp"
#include "tests/fault/readiness.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <random>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kReserveMib = 32; // space that the server keeps free
constexpr std::uint64_t kFillingsPerDisk = 5;
constexpr std::uint64_t kScansPerFilling = 100; // per robot
constexpr std::uint64_t kFilledMib = 8;         // by scans
constexpr unsigned kDiskRobots = 4;
constexpr std::uint64_t kEndless = std::uint64_t{1} << 40; // scans: more than any disk can hold

/// A foreign file that uses disk space while this object exists.
class Ballast {
public:
    explicit Ballast(fs::path path) : path_(std::move(path)), file_(::open(path_.c_str(), O_WRONLY | O_CREAT, 0600)) {}
    ~Ballast() {
        ::close(file_);
        ::unlink(path_.c_str());
    }
    Ballast(const Ballast&) = delete;
    Ballast& operator=(const Ballast&) = delete;

    /// Leaves `left` bytes free, if more are free.
    void grow(std::uint64_t left) {
        const auto free = fs::space(path_.parent_path()).available;
        if (free <= left) return;
        const int failed = ::posix_fallocate(file_, static_cast<off_t>(bytes_), static_cast<off_t>(free - left));
        if (failed == 0) bytes_ += free - left; // otherwise the server took the space first
    }

private:
    fs::path path_;
    int file_;
    std::uint64_t bytes_ = 0;
};

/// Which of the messages appears depends on the free space: less than the reserve, or too little for a write.
bool tells_of_a_full_disk(const std::string& answer) {
    return answer.find("MiB left") != answer.npos || answer.find("MiB are free") != answer.npos ||
           answer.find("No space left on device") != answer.npos;
}

/// The store frees some of its own space at times. So the ballast grows until the server reports a full disk.
void fill_up(const ServerProcess& server, Ballast& ballast, std::uint64_t left, Outcome& outcome) {
    const auto found = wait_for_readiness(server, 503, [&] { ballast.grow(left); });
    if (found.status != 503) {
        outcome.failures.emplace_back("/readyz stays 200 on a full disk");
    } else if (!tells_of_a_full_disk(found.answer)) {
        outcome.failures.push_back("on a full disk /readyz has the wrong reason: " + found.answer);
    }
}

/// Fills the rest of the disk with an endless stream of scans, then deletes their session.
void fill_through_the_server(const ServerProcess& server, const fs::path& store, std::uint64_t seed, Outcome& outcome) {
    Ballast ballast(store / "ballast");
    ballast.grow((kReserveMib + kFilledMib) << 20);
    {
        Fleet filler({{.session = "filler", .name = "r", .seed = static_cast<unsigned>(seed), .scans = kEndless}},
                     server.robot_port());
        filler.release_all();
        const auto found = wait_for_readiness(server, 503);
        if (found.status != 503)
            outcome.failures.emplace_back("/readyz stays 200 though scans fill the disk");
        else if (!tells_of_a_full_disk(found.answer))
            outcome.failures.push_back("on a disk filled by scans /readyz has the wrong reason: " + found.answer);
        check_that_maps_are_served(server, "on a disk filled by scans", outcome);
    }
    const auto deleted = test::http_request(server.http_port(), "DELETE", "/api/v1/sessions/filler").status;
    if (deleted != 204) outcome.failures.push_back(fmt::format("on a full disk DELETE answers {}", deleted));
    if (wait_for_readiness(server, 200).status != 200)
        outcome.failures.emplace_back("after the session that filled the disk was deleted, /readyz stays 503");
}

Result<Outcome> fill_one_disk(const Run& run, std::uint64_t seed, std::uint64_t fillings) {
    const TemporaryDirectory place;
    const auto store = place.path() / "store";
    auto disk = LoopDisk::make(place.path() / "disk", store, kDiskBytes);
    if (!disk) return disk.error();
    std::mt19937_64 random(seed);
    ServerProcess server(run.server, place.path(), {"--disk-reserve", std::to_string(kReserveMib)});
    Fleet fleet(half_sharing(kDiskRobots, seed, fillings * kScansPerFilling), server.robot_port());
    server.start_and_wait();
    fleet.release(1);
    (void)fleet.wait_for_acknowledged(kDiskRobots); // sessions cannot be created on a full disk
    Outcome outcome;
    for (std::uint64_t filling = 1; filling <= fillings && !fleet.has_given_up(); ++filling) {
        fleet.release(filling * kScansPerFilling - kScansPerFilling / 2);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (kDiskRobots * kScansPerFilling / 2));
        {
            Ballast ballast(store / "ballast");
            const auto left = random() % (kReserveMib << 17); // the superuser has some more space
            ballast.grow(left);
            fleet.release(filling * kScansPerFilling);
            fill_up(server, ballast, left, outcome);
            check_that_maps_are_served(server, "on a full disk", outcome);
        }
        if (wait_for_readiness(server, 200).status != 200)
            outcome.failures.emplace_back("/readyz stays 503 after space was freed on the disk");
    }
    fill_through_the_server(server, store, seed, outcome);
    fleet.release_all();
    outcome.add(verify_server(server.http_port(), fleet.finish()));
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

} // namespace scanloom::fault
