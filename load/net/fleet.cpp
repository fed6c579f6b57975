#include "load/net/fleet.hpp"

#include "common/net/await_tuple.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <utility>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr Micros kTick = 250;               ///< shortest wait for the schedule: thousands of waits per second cost CPU
constexpr std::uint64_t kScansAtOnce = 128; ///< handed out before acks are read again
constexpr Micros kLookAfterPeriod = kSecond;

} // namespace

Shard::Shard(std::uint32_t number, const FleetPlan& plan, const std::vector<RobotPlan>& all, const RunClock& clock,
             const Workload& workload, const RobotLinkOptions& link)
    : number_(number), plan_(plan), clock_(clock), workload_(workload) {
    for (std::size_t i = number; i < all.size(); i += plan.threads) {
        robots_.push_back(
            std::make_unique<Robot>(all[i], Robot::Shared{io_, clock_, workload_, link, figures_, troubles_}));
    }
    thread_ = std::thread([this] { io_.run(); });
}

Shard::~Shard() { stop(); }

void Shard::connect() {
    asio::co_spawn(io_, connect_all(), asio::detached);
    asio::co_spawn(io_, look_after_all(), asio::detached);
}

void Shard::begin(Micros start) {
    asio::co_spawn(io_, workload_.schedule ? follow_schedule(start) : send_without_pause(start), asio::detached);
    asio::co_spawn(io_, strike_at_random(), asio::detached);
}

void Shard::end() {
    asio::post(io_, [this] { end_all(); });
}

void Shard::stop() {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] {
        ended_ = true;
        for (auto& robot : robots_) robot->stop();
        asio::post(io_, [this] { io_.stop(); }); // once the robots have noticed
    });
    thread_.join();
}

template <class Function>
auto Shard::on_thread(Function function) {
    if (!thread_.joinable()) return function();
    std::promise<decltype(function())> result;
    asio::post(io_, [&] { result.set_value(function()); });
    return result.get_future().get();
}

std::unique_ptr<Shard::Look> Shard::look() {
    return on_thread([this] { return std::make_unique<Look>(Look{figures_, troubles_}); });
}

Shard::Progress Shard::progress() {
    return on_thread([this] { return Progress{static_cast<const FleetCounts&>(figures_), troubles_.newest}; });
}

void Shard::Progress::add(const Progress& other) {
    FleetCounts::add(other);
    if (trouble.empty()) trouble = other.trouble;
}

asio::awaitable<void> Shard::connect_all() {
    asio::steady_timer timer(io_);
    const Micros begun = clock_.now();
    for (std::size_t i = 0; i < robots_.size() && !ended_; ++i) {
        const auto before = static_cast<double>(i * plan_.threads + number_);
        const auto wait = static_cast<Micros>(before / plan_.connections_per_second * static_cast<double>(kSecond));
        timer.expires_at(clock_.at(begun + wait));
        co_await timer.async_wait(kAwaitTuple);
        robots_[i]->start();
    }
}

asio::awaitable<void> Shard::follow_schedule(Micros start) {
    asio::steady_timer timer(io_);
    for (auto& robot : robots_) robot->begin(start);
    const std::uint64_t places = plan_.scans * plan_.robots;
    while (place_ < places && !ended_) {
        if (hand_out_due(start)) {
            const Micros next = start + workload_.schedule->due(std::min(place_, places - 1));
            timer.expires_at(clock_.at(std::max(next, clock_.now() + kTick)));
            co_await timer.async_wait(kAwaitTuple);
        } else {
            co_await asio::post(io_, asio::use_awaitable);
        }
    }
    end_all();
}

/// @return whether no more scans are due now
bool Shard::hand_out_due(Micros start) {
    const Schedule& schedule = *workload_.schedule;
    const std::uint64_t places = plan_.scans * plan_.robots;
    for (std::uint64_t handed = 0; place_ < places; ++place_) {
        const std::uint32_t robot = schedule.robot_at(place_);
        if (robot % plan_.threads != number_) continue; // belongs to another thread
        const Micros late = clock_.now() - start - schedule.due(place_);
        if (late < 0) return true;
        if (handed++ == kScansAtOnce) return false;
        ++figures_.scans_due;
        figures_.own_delay.record(late);
        robots_[robot / plan_.threads]->due(schedule.seq_at(place_));
    }
    return true;
}

asio::awaitable<void> Shard::send_without_pause(Micros start) {
    asio::steady_timer timer(io_);
    timer.expires_at(clock_.at(start));
    co_await timer.async_wait(kAwaitTuple);
    for (auto& robot : robots_) robot->due(MeasuredClient::kEndless);
    timer.expires_at(clock_.at(start + plan_.duration));
    co_await timer.async_wait(kAwaitTuple);
    end_all();
}

asio::awaitable<void> Shard::strike_at_random() {
    if (robots_.empty()) co_return;
    FaultSchedule faults(plan_.faults, static_cast<std::uint32_t>(robots_.size()), plan_.seed + number_);
    if (faults.is_empty()) co_return;
    asio::steady_timer timer(io_);
    Micros next = clock_.now();
    while (!ended_) {
        const auto event = faults.next();
        next += event.after;
        timer.expires_at(clock_.at(next));
        co_await timer.async_wait(kAwaitTuple);
        if (ended_) co_return;
        if (robots_[event.robot]->strike(event.fault)) ++figures_.faults[static_cast<std::size_t>(event.fault)];
    }
}

asio::awaitable<void> Shard::look_after_all() {
    asio::steady_timer timer(io_);
    for (;;) {
        timer.expires_after(std::chrono::microseconds(kLookAfterPeriod));
        co_await timer.async_wait(kAwaitTuple);
        const Micros now = clock_.now();
        for (auto& robot : robots_) robot->look_after(now);
    }
}

void Shard::end_all() {
    if (std::exchange(ended_, true)) return;
    for (auto& robot : robots_) robot->end();
    if (!workload_.schedule) figures_.scans_due = figures_.scans_sent;
}

// All robots ----------------------------------------------------------------------------------------------------------

std::vector<RobotPlan> spread_over(const std::vector<std::string>& sessions, std::uint32_t robots,
                                   std::size_t workload_scans) {
    std::vector<RobotPlan> plans;
    plans.reserve(robots);
    const std::size_t most = (robots + sessions.size() - 1) / sessions.size(); // robots of a session
    for (std::uint32_t i = 0; i < robots; ++i) {
        const std::size_t within = i / sessions.size();
        plans.push_back({i, sessions[i % sessions.size()], fmt::format("r{}", within), within * workload_scans / most});
    }
    return plans;
}

Fleet::Fleet(const FleetPlan& plan, const std::vector<RobotPlan>& robots, const RunClock& clock,
             const Workload& workload, const RobotLinkOptions& link) {
    for (std::uint32_t i = 0; i < plan.threads; ++i) {
        shards_.push_back(std::make_unique<Shard>(i, plan, robots, clock, workload, link));
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
