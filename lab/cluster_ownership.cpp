#include "lab/cluster_ownership.hpp"

#include "lab/cluster_simulation.hpp"

#include <algorithm>
#include <limits>

namespace scanloom::lab::cluster {
namespace {

constexpr std::size_t kLoadedAtOnce = 4;     // sessions, as server/app/thread_pools
constexpr std::size_t kHandedOverAtOnce = 4; // as server/sessions/session_registry

/// Returns from when on others may take the sessions of a node that has failed. It has renewed its row some time
/// before.
Time dead_from(const Draws& draws, std::size_t node, std::uint32_t life, Time failed) {
    const double since_renewal = draws.unit(Use::kRenewal, node, life) * in_seconds(kRenewEvery);
    return failed + kDeadAfter - of_seconds(since_renewal);
}

} // namespace

Ownership::Ownership(const Plan& plan, const Draws& draws, std::size_t sessions)
    : draws_(draws), load_(static_cast<std::int64_t>(plan.load_ms)), close_ms_(plan.close_ms), nodes_(plan.nodes),
      sessions_(sessions) {
    for (Node& node : nodes_) node.loader_free.assign(kLoadedAtOnce, Time(0));
}

Ownership::Reply Ownership::ask(std::size_t session, std::size_t node, Time now) {
    Session& asked = sessions_[session];
    const Change change = change_if_asked(asked, now);
    if (change == Change::kNone) {
        if (asked.owner != node) return {.sent_to = asked.owner};
        return {.welcome = std::max(now + kAnswer, asked.loaded)};
    }
    const Time loaded = change == Change::kCreated ? now : loaded_by(nodes_[node], now);
    asked = {true, static_cast<std::uint32_t>(node), nodes_[node].life, loaded};
    return {.welcome = std::max(now + kAnswer, loaded), .change = change};
}

Ownership::Change Ownership::change_if_asked(const Session& session, Time now) const {
    if (!session.exists) return Change::kCreated;
    if (!session.owner) return Change::kMoved;
    const Node& owner = nodes_[*session.owner];
    const bool is_of_earlier_life = session.life != owner.life;
    return is_of_earlier_life || (!owner.runs && now >= owner.dead) ? Change::kTakenOver : Change::kNone;
}

Time Ownership::loaded_by(Node& node, Time now) const {
    Time& free = *std::ranges::min_element(node.loader_free);
    free = std::max(free, now) + load_;
    return free;
}

void Ownership::fail(std::size_t node, End how, Time now) {
    Node& failed = nodes_[node];
    failed.runs = false;
    failed.how = how;
    failed.dead = dead_from(draws_, node, failed.life, now);
}

std::vector<Handover> Ownership::stop(std::size_t node, Time now, Time up) {
    constexpr std::size_t kNotUsed = std::numeric_limits<std::size_t>::max();
    nodes_[node].runs = false;
    nodes_[node].how = End::kStopped;
    nodes_[node].dead = Time::max();
    std::vector<std::size_t> counts; // of sessions on each node
    for (const Node& other : nodes_) counts.push_back(other.runs ? 0 : kNotUsed);
    std::vector<Handover> handovers;
    for (std::size_t session = 0; session < sessions_.size(); ++session) {
        const auto server = server_of(session);
        if (server && counts[*server] != kNotUsed) ++counts[*server];
        if (server != node) continue;
        const auto earlier = static_cast<double>(handovers.size() / kHandedOverAtOnce);
        const Time begin = std::min(now + Time(static_cast<std::int64_t>(earlier * close_ms_)), up - Time(1));
        const Time end = std::clamp(begin + Time(static_cast<std::int64_t>(close_ms_)), begin + Time(1), up);
        handovers.push_back({.session = session, .from = node, .begin = begin, .end = end});
    }
    for (Handover& handover : handovers) {
        const auto fewest = std::ranges::min_element(counts);
        if (*fewest == kNotUsed) break;
        ++*fewest;
        handover.to = static_cast<std::size_t>(fewest - counts.begin());
    }
    return handovers;
}

void Ownership::start(std::size_t node) {
    Node& started = nodes_[node];
    started.runs = true;
    ++started.life;
    std::ranges::fill(started.loader_free, Time(0));
}

std::optional<std::size_t> Ownership::server_of(std::size_t session) const {
    const Session& asked = sessions_[session];
    if (!asked.owner) return std::nullopt;
    const Node& owner = nodes_[*asked.owner];
    if (asked.life != owner.life || (!owner.runs && owner.how != End::kStopped)) return std::nullopt;
    return asked.owner;
}

} // namespace scanloom::lab::cluster
