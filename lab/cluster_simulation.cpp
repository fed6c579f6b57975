#include "lab/cluster_simulation.hpp"

#include "lab/cluster_ownership.hpp"
#include "lab/cluster_robots.hpp"
#include "lab/cluster_sessions.hpp"

#include <algorithm>
#include <queue>
#include <string>
#include <tuple>

namespace scanloom::lab::cluster {
namespace {

/// Of events at the same moment, those of an earlier kind come first, then those of smaller numbers.
enum class Kind : std::uint8_t { kHandover, kNodeStarts, kNodeEnds, kSessionEnds, kRobotSteps, kSample };

struct Event {
    Time time{0};
    Kind kind = Kind::kRobotSteps;
    Step step = Step::kAsk;
    std::uint32_t number = 0; ///< of a handover, outage, group, robot or sample
    std::uint32_t ticket = 0; ///< of a robot: its newest event has its newest ticket

    friend bool operator>(const Event& one, const Event& other) {
        return std::tie(one.time, one.kind, one.number, one.ticket) >
               std::tie(other.time, other.kind, other.number, other.ticket);
    }
};

/// Returns when the balance is noted.
std::vector<Balance> samples_of(const Plan& plan) {
    constexpr int kParts = 12;
    const Time end = of_hours(plan.duration_hours);
    std::vector<Balance> samples{{.when = "all robots have started", .time = kMeasureFrom}};
    for (int part = 1; part <= kParts; ++part) samples.push_back({.time = part * end / kParts});
    if (plan.upgrade_at_hours > 0.0) {
        samples.push_back({.when = "before the upgrade", .time = of_hours(plan.upgrade_at_hours) - Time(1)});
        samples.push_back({.when = "after the upgrade", .time = end_of_upgrade(plan)});
    }
    std::erase_if(samples, [&](const Balance& sample) { return sample.time < kMeasureFrom || sample.time > end; });
    std::ranges::stable_sort(samples, {}, &Balance::time);
    return samples;
}

double robots_of_cores(const Plan& plan) { return plan.node_cores * 1e6 / (plan.rate_hz * plan.node_us); }

class Simulation {
public:
    Simulation(const Plan& plan, const std::vector<Outage>& outages)
        : plan_(plan), outages_(outages), draws_(plan.seed), groups_(groups_of(plan, draws_)),
          ownership_(plan, draws_, groups_.size()), nodes_(plan.nodes, robots_of_cores(plan), kMeasureFrom),
          sessions_of_group_(groups_.size(), 0), group_of_robot_(plan.robots),
          robots_(plan.robots, Robot(0, 0, Time(0))), tickets_(plan.robots, 0), samples_(samples_of(plan)) {
        for (std::uint32_t group = 0; group < groups_.size(); ++group) {
            const auto [begin, end] = groups_[group];
            std::fill(group_of_robot_.begin() + begin, group_of_robot_.begin() + end, group);
        }
    }

    Outcome run() {
        for (std::uint32_t group = 0; group < groups_.size(); ++group) start_session(group);
        for (std::uint32_t n = 0; n < outages_.size(); ++n) {
            events_.push({.time = outages_[n].down, .kind = Kind::kNodeEnds, .number = n});
            events_.push({.time = outages_[n].up, .kind = Kind::kNodeStarts, .number = n});
        }
        for (std::uint32_t n = 0; n < samples_.size(); ++n) {
            events_.push({.time = samples_[n].time, .kind = Kind::kSample, .number = n});
        }
        const Time end = of_hours(plan_.duration_hours);
        while (!events_.empty() && events_.top().time <= end) {
            const Event event = events_.top();
            events_.pop();
            now_ = event.time;
            perform(event);
        }
        return outcome_at(end);
    }

private:
    void perform(const Event& event) {
        switch (event.kind) {
        case Kind::kHandover: return hand_over(handovers_[event.number]);
        case Kind::kNodeStarts: return ownership_.start(outages_[event.number].node);
        case Kind::kNodeEnds: return end_node(outages_[event.number]);
        case Kind::kSessionEnds: return end_session(event.number);
        case Kind::kRobotSteps:
            if (event.ticket == tickets_[event.number]) step(event.number, event.step);
            return;
        case Kind::kSample: return note_balance(samples_[event.number]);
        }
    }

    // Sessions

    [[nodiscard]] Order order_of(std::uint32_t group) const {
        return {draws_, name_of(draws_, group, sessions_of_group_[group]), plan_.nodes};
    }

    void start_session(std::uint32_t group) {
        const std::uint32_t session = sessions_of_group_[group];
        const std::uint32_t first = order_of(group).first();
        for (std::uint32_t robot = groups_[group].robots_begin; robot < groups_[group].robots_end; ++robot) {
            const Time start =
                Time(1) + of_seconds(draws_.unit(Use::kRobotStart, robot, session) * in_seconds(kStartSpread));
            const auto backoff_seed = static_cast<std::uint32_t>(draws_.bits(Use::kBackoff, robot, session));
            robots_[robot] = Robot(first, backoff_seed, now_ + start);
            schedule(robot, Step::kAsk, start);
        }
        if (plan_.session_life_hours <= 0.0) return;
        events_.push(
            {.time = now_ + life_of(plan_, draws_, group, session), .kind = Kind::kSessionEnds, .number = group});
    }

    void end_session(std::uint32_t group) {
        if (const auto node = ownership_.server_of(group)) nodes_.add(*node, -robots_in(group), now_);
        ownership_.end_session(group);
        ++sessions_of_group_[group];
        start_session(group);
    }

    [[nodiscard]] std::int64_t robots_in(std::uint32_t group) const { return groups_[group].size(); }

    // Nodes

    void end_node(const Outage& outage) {
        ++outcome_.ends[static_cast<std::size_t>(outage.end)];
        if (outage.end == End::kStopped) return stop_node(outage);
        for (std::uint32_t group = 0; group < groups_.size(); ++group) {
            if (ownership_.server_of(group) != outage.node) continue;
            nodes_.add(outage.node, -robots_in(group), now_);
            for (std::uint32_t robot = groups_[group].robots_begin; robot < groups_[group].robots_end; ++robot) {
                if (robots_[robot].is_linked()) lose_node(robot, outage.end);
            }
        }
        ownership_.fail(outage.node, outage.end, now_);
    }

    void lose_node(std::uint32_t robot, End how) {
        robots_[robot].lose(how == End::kSilent ? Cause::kSilent : Cause::kKilled, now_);
        if (how == End::kSilent) return schedule(robot, Step::kFail, kUnconfirmedMax);
        fail(robot);
    }

    void stop_node(const Outage& outage) {
        for (const Handover& handover : ownership_.stop(outage.node, now_, outage.up)) {
            const auto number = static_cast<std::uint32_t>(handovers_.size());
            events_.push({.time = handover.end, .kind = Kind::kHandover, .number = number});
            handovers_.push_back(handover);
        }
    }

    void hand_over(const Handover& handover) {
        const auto group = static_cast<std::uint32_t>(handover.session);
        if (ownership_.server_of(group) != handover.from) return; // the session has ended
        ownership_.give_up(group);
        nodes_.add(handover.from, -robots_in(group), now_);
        for (std::uint32_t robot = groups_[group].robots_begin; robot < groups_[group].robots_end; ++robot) {
            if (!robots_[robot].is_linked()) continue;
            robots_[robot].lose(Cause::kStopped, handover.begin);
            handover.to ? send_on(robot, *handover.to) : fail(robot);
        }
    }

    // Robots

    /// Replaces the next step of a robot.
    void schedule(std::uint32_t robot, Step step, Time after) {
        events_.push({now_ + after, Kind::kRobotSteps, step, robot, ++tickets_[robot]});
    }

    void step(std::uint32_t robot, Step step) {
        switch (step) {
        case Step::kAsk: return ask(robot);
        case Step::kWelcome: return welcome(robot);
        case Step::kFail: return fail(robot);
        }
    }

    void fail(std::uint32_t robot) {
        schedule(robot, Step::kAsk, robots_[robot].fail(order_of(group_of_robot_[robot])));
    }

    void send_on(std::uint32_t robot, std::size_t node) {
        schedule(robot, Step::kAsk, robots_[robot].sent_to(node, order_of(group_of_robot_[robot])));
    }

    void ask(std::uint32_t robot) {
        const std::size_t node = robots_[robot].server();
        if (!ownership_.runs(node)) {
            if (ownership_.end_of(node) == End::kSilent) return schedule(robot, Step::kFail, kConnectMax);
            return fail(robot);
        }
        const std::uint32_t group = group_of_robot_[robot];
        const auto reply = ownership_.ask(group, node, now_);
        if (reply.sent_to) return send_on(robot, *reply.sent_to);
        note(reply.change, group, node);
        const Time wait = reply.welcome - now_;
        if (wait > kWelcomeTimeout) return schedule(robot, Step::kFail, kWelcomeTimeout);
        schedule(robot, Step::kWelcome, wait);
    }

    void note(Ownership::Change change, std::uint32_t group, std::size_t node) {
        if (change == Ownership::Change::kNone) return;
        nodes_.add(node, robots_in(group), now_);
        if (change == Ownership::Change::kTakenOver) ++outcome_.taken_over;
        if (change == Ownership::Change::kMoved) ++outcome_.moved;
        if (change != Ownership::Change::kCreated) return;
        ++outcome_.created;
    }

    void welcome(std::uint32_t robot) {
        Robot& welcomed = robots_[robot];
        if (ownership_.server_of(group_of_robot_[robot]) !=
            welcomed.server()) { // it has ended while it loaded the session
            return fail(robot);
        }
        welcomed.settle();
        waits_.add(welcomed.cause(), now_ - welcomed.since());
    }

    // Results

    void note_balance(Balance& sample) const {
        const double mean = static_cast<double>(plan_.robots) / static_cast<double>(plan_.nodes);
        sample.fullest = static_cast<double>(nodes_.fullest()) / mean;
        sample.emptiest = sample.fullest;
        for (std::size_t node = 0; node < plan_.nodes; ++node) {
            if (!ownership_.runs(node)) continue;
            ++sample.nodes_up;
            sample.emptiest = std::min(sample.emptiest, static_cast<double>(nodes_.robots()[node]) / mean);
        }
    }

    Outcome outcome_at(Time end) {
        nodes_.finish(end);
        outcome_.sessions = groups_.size();
        for (const Group& group : groups_) {
            outcome_.largest_session = std::max<std::size_t>(outcome_.largest_session, group.size());
        }
        for (const Cause cause : kCauses) outcome_.waits[static_cast<std::size_t>(cause)] = waits_.waits_of(cause);
        outcome_.waiting = static_cast<std::size_t>(
            std::ranges::count_if(robots_, [](const Robot& robot) { return !robot.is_linked(); }));
        outcome_.node_robots_max = nodes_.fullest_ever();
        outcome_.node_robots_mean = nodes_.fullest_mean();
        outcome_.overload = nodes_.overload();
        outcome_.balances = std::move(samples_);
        return std::move(outcome_);
    }

    const Plan& plan_;
    const std::vector<Outage>& outages_;
    Draws draws_;
    std::vector<Group> groups_;
    Ownership ownership_;
    Loads nodes_;
    std::vector<std::uint32_t> sessions_of_group_; // that have ended
    std::vector<std::uint32_t> group_of_robot_;
    std::vector<Robot> robots_;
    std::vector<std::uint32_t> tickets_; // of robots
    std::vector<Handover> handovers_;
    std::vector<Balance> samples_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    Time now_{0};
    WaitLog waits_;
    Outcome outcome_;
};

} // namespace

Outcome simulate(const Plan& plan, const std::vector<Outage>& outages) { return Simulation(plan, outages).run(); }

Outcome simulate(const Plan& plan) { return simulate(plan, outages_of(plan, Draws(plan.seed))); }

} // namespace scanloom::lab::cluster
