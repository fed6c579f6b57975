#include "tests/fault/link_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fault_proxy.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/running_ingest.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <future>
#include <map>
#include <mutex>
#include <random>
#include <string>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kScans = 120;
constexpr std::uint64_t kSpoiledLinksMax = 4;
constexpr std::size_t kAtOnce = 8; // most of them wait

/// Some stalls are longer than these timeouts.
constexpr LinkTimeouts kLinkTimeouts{.welcome = std::chrono::milliseconds(250),
                                     .ping_after = std::chrono::milliseconds(50),
                                     .silence_max = std::chrono::milliseconds(250),
                                     .give_up_after = std::chrono::milliseconds(30'000),
                                     .backoff_first = std::chrono::milliseconds(1),
                                     .backoff_longest = std::chrono::milliseconds(20)};

/// The faults of a robot's connections, chosen by the seed.
class Fates {
public:
    Fates(std::uint64_t seed, bool forges)
        : random_(seed), spoiled_(1 + random_() % kSpoiledLinksMax), forges_(forges) {}

    LinkFate fate_of(std::uint64_t connection) {
        const Harm there = connection < spoiled_ ? some_harm() : Harm::kNone;
        const Harm back = connection < spoiled_ ? some_harm() : Harm::kNone;
        return {SpoiledStream(there, random_(), forges_), SpoiledStream(back, random_(), forges_)};
    }

    /// Returns how often each fault was chosen, by name. Thread: not while connections are opened.
    [[nodiscard]] const std::map<std::string, std::uint64_t>& harms() const { return harms_; }

private:
    Harm some_harm() {
        const auto harm = static_cast<Harm>(random_() % kHarms);
        if (harm != Harm::kNone) ++harms_[std::string(name_of(harm))];
        return harm;
    }

    std::mt19937_64 random_;
    std::uint64_t spoiled_;
    bool forges_;
    std::map<std::string, std::uint64_t> harms_;
};

/// The server part in this process, for many robots at once.
class Server {
public:
    explicit Server(std::unique_ptr<store::ScanLog> log) : log_(std::move(log)), ingest_(*log_) {}

    [[nodiscard]] std::uint16_t port() const { return ingest_.port(); }

    /// Closes a session and returns its data; nullopt if it was never created.
    std::optional<Held> close(const std::string& name) {
        const auto session = ingest_.sessions().find(name);
        if (!session) return std::nullopt;
        std::promise<void> closed;
        session->close({Errc::kShuttingDown, "the case has ended"}, [&] { closed.set_value(); });
        closed.get_future().wait();
        auto there = held(*session->snapshot(), store::entries_after(*log_, session->info().id, 0).value());
        ingest_.sessions().remove(name).value();
        return there;
    }

private:
    std::unique_ptr<store::ScanLog> log_;
    ingest::RunningIngest ingest_;
};

/// Runs one robot from its first connection to its last.
RobotStanding stream(const RobotPlan& plan, std::uint16_t port, Fates& fates) {
    FaultProxy proxy(port, [&](std::uint64_t connection) { return fates.fate_of(connection); });
    Fleet fleet({plan}, proxy.port(), kLinkTimeouts);
    fleet.release_all();
    return fleet.finish().front();
}

/// The last connections were not spoiled, so a timeout is not an acceptable end.
std::optional<std::string> complaint(const RobotStanding& robot) {
    if (robot.outcome) {
        if (robot.acknowledged == robot.plan.scans) return std::nullopt;
        return fmt::format("the robot ended without error with {} of {} scans acknowledged", robot.acknowledged,
                           robot.plan.scans);
    }
    const Error& error = robot.outcome.error();
    if (error.code == Errc::kTimeout) return "the robot did not end in time: " + error.message;
    if (error.message.empty()) return "the robot ended with an error without a message";
    return std::nullopt;
}

Outcome spoil_links(Server& server, std::uint64_t seed, bool forges) {
    const RobotPlan plan{fmt::format("link-{}", seed), "robot", static_cast<unsigned>(seed), kScans};
    Fates fates(seed, forges);
    const RobotStanding robot = stream(plan, server.port(), fates);
    Outcome outcome;
    outcome.figures = fates.harms();
    outcome.figures["reconnects"] = robot.reconnects;
    if (!robot.outcome) ++outcome.figures[fmt::format("ended_{}", name_of(robot.outcome.error().code))];
    if (auto wrong = complaint(robot)) outcome.failures.push_back(std::move(*wrong));
    if (const auto held = server.close(plan.session)) {
        outcome.add(verify(*held, {&robot, 1}, fleet_options()));
    } else if (robot.acknowledged > 0) {
        outcome.lost = robot.acknowledged;
        outcome.failures.emplace_back("the session of acknowledged scans does not exist");
    }
    return outcome;
}

} // namespace

Outcome run_link_row(const Run& run) {
    return run_link_row(run, {[] { return std::make_unique<store::MemoryScanLog>(); }});
}

Outcome run_link_row(const Run& run, const LinkTrial& trial) {
    spdlog::set_level(spdlog::level::off); // errors of spoiled connections are expected
    Server server(trial.make_log());
    return run_cases(run, {.row = "link", .at_once = kAtOnce, .run = [&](std::uint64_t seed, std::uint64_t) {
                               return spoil_links(server, seed, trial.forges);
                           }});
}

} // namespace scanloom::fault
