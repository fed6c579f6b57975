#include "load/net/fleet.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::load {

std::vector<RobotPlan> spread_over(const std::vector<std::string>& sessions, std::uint32_t robots,
                                   std::size_t course_scans) {
    std::vector<RobotPlan> plans;
    plans.reserve(robots);
    const std::size_t most = (robots + sessions.size() - 1) / sessions.size(); // robots of a session
    for (std::uint32_t i = 0; i < robots; ++i) {
        const std::size_t within = i / sessions.size();
        plans.push_back({i, sessions[i % sessions.size()], fmt::format("r{}", within), within * course_scans / most});
    }
    return plans;
}

Fleet::Fleet(const FleetPlan& plan, const std::vector<RobotPlan>& robots, const RunClock& clock, const Course& course,
             const RobotLinkOptions& link) {
    for (std::uint32_t i = 0; i < plan.threads; ++i) {
        shards_.push_back(std::make_unique<Shard>(i, plan, robots, clock, course, link));
    }
}

void Fleet::connect() {
    for (auto& shard : shards_) shard->connect();
}

void Fleet::begin(Micros start) {
    for (auto& shard : shards_) shard->begin(start);
}

void Fleet::end() {
    for (auto& shard : shards_) shard->end();
}

void Fleet::stop() {
    for (auto& shard : shards_) shard->stop();
}

std::unique_ptr<Shard::Look> Fleet::look() {
    auto all = std::make_unique<Shard::Look>();
    for (auto& shard : shards_) {
        const auto part = shard->look();
        all->figures.add(part->figures);
        all->troubles.add(part->troubles);
    }
    return all;
}

Shard::Progress Fleet::progress() {
    Shard::Progress all;
    for (auto& shard : shards_) all.add(shard->progress());
    return all;
}

std::vector<std::uint64_t> Fleet::acknowledged() const {
    std::size_t count = 0;
    for (const auto& shard : shards_) count += shard->robots().size();
    std::vector<std::uint64_t> scans(count);
    for (const auto& shard : shards_) {
        for (const auto& robot : shard->robots()) scans[robot->client().plan().index] = robot->client().acknowledged();
    }
    return scans;
}

} // namespace scanloom::load
