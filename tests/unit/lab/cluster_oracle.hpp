#pragma once

#include "common/net/server_list.hpp"
#include "lab/cluster_nodes.hpp"
#include "lab/cluster_result.hpp"
#include "lab/cluster_sessions.hpp"
#include "lab/cluster_simulation.hpp"
#include "robot_client/uplink/backoff.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// A simulation of a small cluster that looks at everything in each millisecond, with the robots' own choice of
/// servers.
namespace scanloom::lab::cluster {

/// Returns all nodes in the order of a session: by decreasing hashes.
inline std::vector<std::size_t> sorted_nodes(const Draws& draws, std::uint64_t session, std::size_t nodes) {
    std::map<std::uint64_t, std::size_t, std::greater<>> by_hash;
    for (std::size_t node = 0; node < nodes; ++node) by_hash[draws.bits(Use::kRank, session, node)] = node;
    std::vector<std::size_t> sorted;
    for (const auto& [hash, node] : by_hash) sorted.push_back(node);
    return sorted;
}

/// The list of servers of a robot. Its own order depends on the addresses. So each address stands for the node that
/// has the same place in the given order.
class NodeList {
public:
    explicit NodeList(const std::vector<std::size_t>& order) : list_(addresses(order.size()), {}) {
        net::ServerList walk = list_;
        for (const std::size_t node : order) {
            nodes_[walk.current().text()] = node;
            addresses_[node] = walk.current().text();
            static_cast<void>(walk.choose_another(""));
        }
    }

    std::size_t current() const { return nodes_.at(list_.current().text()); }
    bool choose_another(std::optional<std::size_t> named) {
        return list_.choose_another(named ? addresses_.at(*named) : "");
    }
    void settle() { list_.settle(); }
    Time wait_max() const { return list_.wait_max(); }

private:
    static std::vector<net::Address> addresses(std::size_t count) {
        std::vector<net::Address> made;
        for (std::size_t port = 1; port <= count; ++port) made.push_back({"n", std::to_string(port)});
        return made;
    }

    net::ServerList list_;
    std::map<std::string, std::size_t> nodes_;
    std::map<std::size_t, std::string> addresses_;
};

class Oracle {
public:
    Oracle(const Plan& plan, const std::vector<Outage>& outages)
        : plan_(plan), outages_(outages), groups_(groups_of(plan, draws_)), nodes_(plan.nodes),
          sessions_(groups_.size()) {
        for (std::size_t group = 0; group < groups_.size(); ++group) {
            for (auto robot = groups_[group].robots_begin; robot < groups_[group].robots_end; ++robot) {
                robots_.push_back({.group = group, .servers = list_of(group)});
            }
        }
        for (std::size_t group = 0; group < groups_.size(); ++group) start(group);
    }

    void run() {
        for (; now_ < of_hours(plan_.duration_hours); now_ += Time(1)) {
            for (std::size_t group = 0; group < groups_.size(); ++group) {
                if (sessions_[group].closed == now_) give_up(group);
            }
            for (const Outage& outage : outages_) {
                if (outage.up == now_) nodes_[outage.node] = {.life = nodes_[outage.node].life + 1};
            }
            for (const Outage& outage : outages_) {
                if (outage.down == now_) end(outage);
            }
            for (std::size_t group = 0; group < groups_.size(); ++group) {
                if (sessions_[group].end == now_) start(group);
            }
            for (Robot& robot : robots_) {
                if (robot.due == now_) step(robot);
            }
            look();
        }
    }

    std::map<Cause, std::vector<Time>> waits;
    std::size_t created = 0;
    std::size_t taken_over = 0;
    std::size_t moved = 0;
    std::int64_t fullest_ever = 0;
    double fullest_sum = 0.0; ///< of all milliseconds
    Time overload{0};

private:
    enum class Next { kAsk, kWelcome, kFail };
    struct Robot {
        std::size_t group;
        NodeList servers;
        robot::Backoff backoff{1};
        Next next = Next::kAsk;
        Time due{-1};
        Time since{0};
        Cause cause = Cause::kStart;
        bool is_linked = false;
    };
    struct Node {
        bool runs = true;
        std::uint32_t life = 0;
        End how = End::kStopped;
        Time dead{0};
        std::vector<Time> loads = {}; ///< ends of all loads
    };
    struct Session {
        std::optional<std::size_t> owner = {}; ///< none: it does not exist, or it is given up
        bool is_given_up = false;
        std::uint32_t life = 0;
        Time loaded{0};
        Time end{-1};
        std::uint32_t before = 0;             ///< sessions of this group
        Time closing{-1};                     ///< when its owner begins to close it
        Time closed{-1};                      ///< when its owner gives it up
        std::optional<std::size_t> next = {}; ///< where its robots are sent then
    };

    NodeList list_of(std::size_t group) const {
        return NodeList(sorted_nodes(draws_, name_of(draws_, group, sessions_[group].before), plan_.nodes));
    }

    void start(std::size_t group) {
        Session& session = sessions_[group];
        if (session.end == now_) session = {.before = session.before + 1};
        session.end = plan_.session_life_hours > 0.0 ? now_ + life_of(plan_, draws_, group, session.before) : Time(-1);
        for (auto number = groups_[group].robots_begin; number < groups_[group].robots_end; ++number) {
            const double part = draws_.unit(Use::kRobotStart, number, session.before);
            const Time due = now_ + Time(1 + static_cast<std::int64_t>(part * 1000.0));
            const auto seed = static_cast<std::uint32_t>(draws_.bits(Use::kBackoff, number, session.before));
            robots_[number] = {
                .group = group, .servers = list_of(group), .backoff = robot::Backoff(seed), .due = due, .since = due};
        }
    }

    bool serves(std::size_t node, const Session& session) const {
        const Node& owner = nodes_[node];
        return session.owner == node && (owner.runs || owner.how == End::kStopped) && owner.life == session.life;
    }

    void end(const Outage& outage) {
        if (outage.end == End::kStopped) return stop(outage);
        for (Robot& robot : robots_) {
            const Session& session = sessions_[robot.group];
            if (!serves(outage.node, session)) continue;
            if (!robot.is_linked) continue;
            robot.is_linked = false;
            robot.since = now_;
            robot.cause = outage.end == End::kKilled ? Cause::kKilled : Cause::kSilent;
            if (outage.end == End::kSilent)
                plan_step(robot, Next::kFail, Time(5'000));
            else
                fail(robot);
        }
        Node& node = nodes_[outage.node];
        const double renewed = draws_.unit(Use::kRenewal, outage.node, node.life);
        node.runs = false;
        node.how = outage.end;
        node.dead = now_ + Time(5000 - static_cast<std::int64_t>(renewed * 1000.0));
    }

    /// Gives each session to the thread that is free first, and to the running node that has the fewest sessions then.
    void stop(const Outage& outage) {
        const std::size_t node = outage.node;
        nodes_[node].runs = false;
        nodes_[node].how = End::kStopped;
        std::map<std::size_t, std::size_t> sent;
        std::vector<Time> threads(4, now_);
        for (Session& session : sessions_) {
            if (!serves(node, session)) continue;
            auto& thread = *std::ranges::min_element(threads);
            session.closing = thread;
            thread += Time(static_cast<std::int64_t>(plan_.close_ms));
            session.closed = std::max(thread, session.closing + Time(1));
            if (session.closed > outage.up) {
                session.closing = std::min(session.closing, outage.up - Time(1));
                session.closed = outage.up;
            }
            session.next.reset();
            std::size_t fewest = 0;
            for (std::size_t other = 0; other < plan_.nodes; ++other) {
                if (!nodes_[other].runs) continue;
                const auto has = static_cast<std::size_t>(
                    std::ranges::count_if(sessions_, [&](const Session& one) { return serves(other, one); }));
                if (session.next && has + sent[other] >= fewest) continue;
                fewest = has + sent[other];
                session.next = other;
            }
            if (session.next) ++sent[*session.next];
        }
    }

    void give_up(std::size_t group) {
        Session& session = sessions_[group];
        session.owner.reset();
        session.is_given_up = true;
        session.closed = Time(-1);
        for (Robot& robot : robots_) {
            if (robot.group != group || !robot.is_linked) continue;
            robot.is_linked = false;
            robot.since = session.closing;
            robot.cause = Cause::kStopped;
            fail(robot, session.next);
        }
    }

    void plan_step(Robot& robot, Next next, Time after) {
        robot.next = next;
        robot.due = now_ + after;
    }

    void fail(Robot& robot, std::optional<std::size_t> named = {}) {
        if (robot.servers.choose_another(named)) return plan_step(robot, Next::kAsk, Time(1));
        plan_step(robot, Next::kAsk, std::min(Time(robot.backoff.next()), robot.servers.wait_max()));
    }

    void step(Robot& robot) {
        const std::size_t asked = robot.servers.current();
        if (robot.next == Next::kFail) return fail(robot);
        if (robot.next == Next::kWelcome) return welcome(robot, asked);
        Node& node = nodes_[asked];
        if (!node.runs && node.how == End::kSilent) return plan_step(robot, Next::kFail, Time(3'000));
        if (!node.runs) return fail(robot);
        Session& session = sessions_[robot.group];
        if (session.owner && !serves(*session.owner, session)) {
            const Node& owner = nodes_[*session.owner];
            const bool is_free = owner.life != session.life || now_ >= owner.dead;
            if (is_free) take(session, asked, taken_over);
        } else if (!session.owner) {
            take(session, asked, session.is_given_up ? moved : created);
        }
        if (session.owner != asked) return fail(robot, session.owner);
        const Time wait = std::max(Time(1), session.loaded - now_);
        if (wait > Time(10'000)) return plan_step(robot, Next::kFail, Time(10'000));
        plan_step(robot, Next::kWelcome, wait);
    }

    void take(Session& session, std::size_t asked, std::size_t& counted) {
        ++counted;
        session.loaded = &counted == &created ? now_ : load(nodes_[asked]);
        session.owner = asked;
        session.is_given_up = false;
        session.life = nodes_[asked].life;
    }

    /// Each loader takes the next session when it has none: a load begins when fewer than all loaders are in use.
    Time load(Node& node) const {
        const std::size_t loaders = 4;
        Time begin = now_;
        const auto in_use = [&] {
            return static_cast<std::size_t>(std::ranges::count_if(node.loads, [&](Time end) { return end > begin; }));
        };
        while (in_use() >= loaders) begin += Time(1);
        node.loads.push_back(begin + Time(static_cast<std::int64_t>(plan_.load_ms)));
        return node.loads.back();
    }

    void welcome(Robot& robot, std::size_t asked) {
        if (!serves(asked, sessions_[robot.group])) return fail(robot);
        robot.servers.settle();
        robot.backoff.reset();
        robot.is_linked = true;
        robot.due = Time(-1);
        waits[robot.cause].push_back(now_ - robot.since);
    }

    void look() {
        if (now_ < kMeasureFrom) return;
        std::int64_t fullest = 0;
        for (std::size_t node = 0; node < plan_.nodes; ++node) {
            std::int64_t robots = 0;
            for (std::size_t group = 0; group < groups_.size(); ++group) {
                if (serves(node, sessions_[group])) robots += groups_[group].size();
            }
            fullest = std::max(fullest, robots);
            const double cores = static_cast<double>(robots) * plan_.rate_hz * plan_.node_us / 1e6;
            if (cores > plan_.node_cores) overload += Time(1);
        }
        fullest_ever = std::max(fullest_ever, fullest);
        fullest_sum += static_cast<double>(fullest);
    }

    Plan plan_;
    std::vector<Outage> outages_;
    Draws draws_{plan_.seed};
    std::vector<Group> groups_;
    std::vector<Node> nodes_;
    std::vector<Session> sessions_;
    std::vector<Robot> robots_;
    Time now_{0};
};

} // namespace scanloom::lab::cluster
