#include "tests/fault/simulation/story.hpp"

#include "tests/fault/simulation/promises.hpp"
#include "tests/fault/simulation/robot.hpp"
#include "tests/fault/simulation/server.hpp"
#include "tests/fault/simulation/tokens.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/log_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace scanloom::simulation {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTroubled = 15s;
constexpr Duration kTimeToRecover = 10min;

/// All faults of a story, drawn at its start.
struct Plot {
    DiskTrouble disk;
    NetworkTrouble network;
    ServerOptions server;
    std::vector<fault::RobotPlan> robots;
    std::uint64_t server_crashes = 0;
    std::uint64_t server_stops = 0;
    std::uint64_t robot_crashes = 0;
    std::uint64_t token_edits = 0;
};

/// Returns 0 in half of the stories.
double some(World& world, double most) {
    return world.chance(0.5) ? 0.0 : most * static_cast<double>(world.draw(101)) / 100.0;
}

/// Partitions may be shorter or longer than all timeouts.
NetworkTrouble network_of(World& world) {
    NetworkTrouble network{.cut = some(world, 0.7),
                           .silent = some(world, 0.3),
                           .deaf = some(world, 0.3),
                           .stall = some(world, 0.5),
                           .refuse = some(world, 0.5),
                           .forge = some(world, 0.3)};
    for (auto more = world.draw(3); more > 0; --more) {
        const Time from = world.now() + world.between(0s, kTroubled);
        network.partitions.push_back({from, from + world.between(100ms, 20s)});
    }
    return network;
}

Plot plot_of(World& world, const Story& story) {
    Plot plot;
    plot.disk = {some(world, 0.05), some(world, 0.1), some(world, 0.1), story.hasty_disk, story.forgetful_disk};
    plot.network = network_of(world);
    plot.server.credit_bytes = world.chance(0.5) ? 4'000 + world.draw(8'000) : plot.server.credit_bytes;
    plot.server.idle_after = world.chance(0.5) ? Duration(3s) : plot.server.idle_after;
    if (world.chance(0.3)) plot.server.pages_max = 14 + world.draw(6); // one session takes 6, and a scan may touch 4
    plot.server.idle_deadline = 10s;
    if (world.chance(0.3)) {
        plot.server.links_max = 1 + world.draw(2);
        plot.server.greeting_max = 1 + world.draw(2);
    }
    plot.server_crashes = world.draw(4);
    plot.server_stops = world.draw(3);
    plot.robot_crashes = world.draw(4);
    plot.token_edits = world.draw(6);
    const auto robots = 1 + world.draw(3);
    for (std::uint64_t n = 0; n < robots; ++n) {
        plot.robots.push_back({fmt::format("session-{}", world.draw(2)), fmt::format("robot-{}", n),
                               static_cast<unsigned>(story.seed * 3 + n), 10 + world.draw(60)});
    }
    return plot;
}

class Stage {
public:
    explicit Stage(const Story& story)
        : world_(story.seed, story.listener), plot_(plot_of(world_, story)), tokens_(world_, plot_.robots.size()),
          disk_(world_, plot_.disk) {}

    Ending play() {
        start_server();
        for (const auto& plan : plot_.robots) {
            const auto explains = [this](const wire::Hello& hello, Errc code, Time since) {
                if (!tokens_.explains(hello, code, since)) return false;
                ++ending_.outcome.figures[fmt::format("ended_{}", name_of(code))];
                return true;
            };
            const auto secret = [this, n = robots_.size()] { return tokens_.secret_of(n); };
            robots_.push_back(std::make_unique<Robot>(
                world_, plan, [this] { return connect(); }, secret, explains));
        }
        plan_crashes();
        plan_edits();
        calm_ = world_.now() + kTroubled;
        world_.at(calm_, [this] {
            disk_.calm();
            plot_.network = {};
            tokens_.calm();
            if (server_) server_->read_tokens();
        });
        const Time end = calm_ + kTimeToRecover;
        while (!(world_.now() >= calm_ && all_done())) {
            if (!world_.step(end)) break;
        }
        return judge();
    }

private:
    void start_server() {
        server_.emplace(world_, disk_, plot_.server, tokens_,
                        [this](const std::string& robot, std::uint64_t seq) { promises_.say(robot, seq); });
    }

    std::shared_ptr<Connection> connect() {
        if (!server_) return nullptr;
        auto connection = Connection::make(world_, plot_.network);
        if (connection) server_->accept(connection);
        return connection;
    }

    void plan_crashes() {
        const auto sometime = [this] { return world_.now() + world_.between(0s, kTroubled); };
        for (std::uint64_t n = 0; n < plot_.server_crashes; ++n) world_.at(sometime(), [this] { end_server(false); });
        for (std::uint64_t n = 0; n < plot_.server_stops; ++n) world_.at(sometime(), [this] { end_server(true); });
        for (std::uint64_t n = 0; n < plot_.robot_crashes; ++n) {
            world_.at(sometime(), [this] { robots_[world_.draw(robots_.size())]->crash(); });
        }
    }

    /// The operator edits the tokens while the server runs, or while it does not.
    void plan_edits() {
        for (auto n = tokens_.is_open() ? 0 : plot_.token_edits; n > 0; --n) {
            world_.after(world_.between(0s, kTroubled), [this] {
                tokens_.edit();
                if (server_) server_->read_tokens();
            });
        }
    }

    void end_server(bool in_order) {
        if (!server_) return;
        if (in_order) server_->stop();
        server_.reset();
        ++ends_;
        check_promises();
        world_.after(world_.between(10ms, 5s), [this] { start_server(); });
    }

    /// Runs while only the disk exists.
    void check_promises() {
        ending_.outcome.add(promises_.check(disk_.durable(), plot_.robots));
        ending_.broken += promises_.count_broken(disk_.durable(), disk_.take_dropped());
        tokens_.check_sessions(disk_.durable());
    }

    [[nodiscard]] bool all_done() const {
        return std::ranges::all_of(robots_, [](const auto& robot) { return robot->is_done(); });
    }

    Ending judge() {
        auto& outcome = ending_.outcome;
        std::map<std::string, std::vector<fault::RobotStanding>> sessions;
        for (const auto& robot : robots_) {
            const auto& standing = robot->standing();
            sessions[standing.plan.session].push_back(standing);
            if (!robot->is_done()) {
                outcome.failures.push_back(fmt::format("robot '{}' has {} of {} scans acknowledged, and nothing moves",
                                                       standing.plan.name, standing.acknowledged, standing.plan.scans));
            }
            if (standing.outcome) continue;
            const Error& error = standing.outcome.error();
            ++outcome.figures[fmt::format("ended_{}", name_of(error.code))];
            if (!is_forged_ || error.code == Errc::kConflict) {
                outcome.failures.push_back(fmt::format("robot '{}' gave up: {}", standing.plan.name, error.message));
            }
        }
        outcome.figures["server_ends"] = ends_;
        outcome.add(tokens_.take_outcome());
        for (const auto& [name, members] : sessions) {
            const auto held = hold(name);
            if (held) outcome.add(fault::verify(*held, members, fault::fleet_options()));
            if (!held) outcome.failures.push_back(fmt::format("session '{}': {}", name, held.error().message));
        }
        ending_.broken += promises_.count_broken(disk_.durable(), disk_.take_dropped());
        ending_.fingerprint = world_.fingerprint();
        return std::move(ending_);
    }

    /// Also works if the server must be started first or its store be reopened.
    Result<std::shared_ptr<sessions::Session>> wake(const std::string& name) {
        const Time end = world_.now() + kTimeToRecover;
        for (;;) {
            while (!server_) world_.step(Time::max());
            std::optional<Result<std::shared_ptr<sessions::Session>>> woken;
            server_->sessions().load(
                name, [&](Result<std::shared_ptr<sessions::Session>> session) { woken = std::move(session); });
            while (!woken) world_.step(Time::max());
            if (*woken || world_.now() > end) return *woken;
            const Time later = world_.now() + 1s;
            while (world_.step(later)) {
            }
        }
    }

    /// Returns the server's data at the end.
    Result<fault::Held> hold(const std::string& name) {
        const auto woken = wake(name);
        if (!woken) return woken.error();
        const auto entries = store::entries_after(disk_.durable(), (*woken)->info().id, 0);
        return fault::held(*(*woken)->snapshot(), entries.value());
    }

    World world_;
    Plot plot_;
    Tokens tokens_;
    const bool is_forged_ = plot_.network.forge > 0.0; // allows errors of robots, but no lost scans
    Disk disk_;
    Promises promises_;
    Ending ending_;
    std::optional<Server> server_;
    std::vector<std::unique_ptr<Robot>> robots_;
    Time calm_{};
    std::uint64_t ends_ = 0;
};

} // namespace

Ending tell(const Story& story) { return Stage(story).play(); }

} // namespace scanloom::simulation
