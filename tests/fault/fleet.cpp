#include "tests/fault/fleet.hpp"

#include "robot_client/uplink/uplink.hpp"
#include "tests/support/random_scans.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

namespace scanloom::fault {

namespace asio = boost::asio;

namespace {

/// Coarse, so that a scan costs little: map quality is not tested here.
constexpr double kCellSize = 0.2;

/// A source that returns a robot's scans up to the released number.
class ReleasedFeed final : public robot::Feed {
public:
    ReleasedFeed(const RobotPlan& plan, std::function<void(std::uint64_t)> on_acknowledged)
        : plan_(plan), on_acknowledged_(std::move(on_acknowledged)) {}

    void release(std::uint64_t seq) {
        released_ = std::min(std::max(released_, seq), plan_.scans);
        if (intake_ != nullptr) intake_->wake();
    }

    /// No more scans will be released.
    void end() {
        last_ = released_;
        if (intake_ != nullptr) intake_->wake();
    }

    asio::awaitable<Result<>> run(robot::Intake& intake) override {
        intake_ = &intake;
        while (!intake.resumed_after()) co_await intake.wait_for_change();
        std::uint64_t handed_over = *intake.resumed_after();
        while (handed_over < last_ && !intake.is_stopped()) {
            if (handed_over == released_ || !intake.has_room()) {
                co_await intake.wait_for_change();
                continue;
            }
            intake.add({laser_, testing_support::random_scan(plan_.seed, ++handed_over)});
        }
        co_return Result<>{};
    }

    void acknowledged(std::uint64_t seq) override { on_acknowledged_(seq); }

private:
    const RobotPlan& plan_;
    std::function<void(std::uint64_t)> on_acknowledged_;
    std::shared_ptr<const Sensor> laser_ = std::make_shared<const Sensor>(testing_support::small_laser());
    std::uint64_t released_ = 0;
    std::uint64_t last_ = plan_.scans;
    robot::Intake* intake_ = nullptr;
};

robot::UplinkOptions options_of(const RobotPlan& plan, const std::vector<std::uint16_t>& ports,
                                const LinkTimeouts& timeouts) {
    robot::UplinkOptions options;
    for (std::size_t n = 0; n < ports.size(); ++n) {
        options.servers.push_back({"127.0.0.1", std::to_string(ports[(n + plan.seed) % ports.size()])});
    }
    options.connect_timeout = timeouts.welcome;
    options.give_up_after = options.give_up_after_end = timeouts.give_up_after;
    options.backoff_seed = plan.seed;
    options.backoff = {timeouts.backoff_first, timeouts.backoff_longest};
    options.protocol.welcome_timeout = timeouts.welcome;
    options.protocol.ping_after = timeouts.ping_after;
    options.protocol.silence_max = timeouts.silence_max;
    options.protocol.batch_bytes_max = 2048; // about ten scans: many frames, many acknowledgements
    options.protocol.hello.session = plan.session;
    options.protocol.hello.robot = plan.name;
    options.protocol.hello.source = "robot of seed " + std::to_string(plan.seed);
    options.protocol.hello.create = fleet_options();
    return options;
}

} // namespace

SessionOptions fleet_options() { return {.cell_size = kCellSize}; }

class Fleet::Robots {
public:
    Robots(std::vector<RobotPlan> plans, const std::vector<std::uint16_t>& ports, const LinkTimeouts& timeouts) {
        for (auto& plan : plans) members_.push_back(std::make_unique<Member>(std::move(plan), members_.size()));
        for (auto& member : members_) start(*member, ports, timeouts);
        thread_ = std::thread([this] { io_.run(); });
    }
    ~Robots() {
        io_.stop();
        thread_.join();
    }

    void release(std::uint64_t seq) {
        {
            const std::lock_guard lock(mutex_);
            to_acknowledge_ = 0;
            for (const auto& member : members_) to_acknowledge_ += std::min(seq, member->standing.plan.scans);
        }
        asio::post(io_, [this, seq] {
            for (auto& member : members_) member->feed->release(seq);
        });
    }

    void stream(unsigned rate) {
        const std::lock_guard lock(mutex_);
        to_acknowledge_ = std::numeric_limits<std::uint64_t>::max();
        interval_ = std::chrono::duration_cast<Clock::duration>(std::chrono::seconds(1)) / (rate * members_.size());
        begin_ = Clock::now();
        asio::co_spawn(io_, release_in_turn(), asio::detached);
    }

    void end() {
        asio::post(io_, [this] {
            is_ending_ = true;
            for (auto& member : members_) member->feed->end();
        });
    }

    std::vector<std::chrono::milliseconds> wait_for_all() {
        std::unique_lock lock(mutex_);
        const auto turns = (Clock::now() - begin_.value()) / interval_;
        const auto released = static_cast<std::uint64_t>(turns) / members_.size();
        changed_.wait(lock, [&] {
            return given_up_ || std::ranges::all_of(members_, [&](const auto& member) {
                       return member->standing.acknowledged >= released;
                   });
        });
        std::vector<std::chrono::milliseconds> longest;
        for (const auto& member : members_) {
            const auto delay = std::exchange(member->longest_delay, {});
            longest.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(delay));
        }
        if (given_up_) longest.clear();
        return longest;
    }

    bool wait_for_acknowledged(std::uint64_t scans) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return acknowledged_ >= scans || given_up_ || acknowledged_ >= to_acknowledge_; });
        return acknowledged_ >= scans && !given_up_;
    }

    std::uint64_t acknowledged() const {
        const std::lock_guard lock(mutex_);
        return acknowledged_;
    }
    bool has_given_up() const {
        const std::lock_guard lock(mutex_);
        return given_up_;
    }

    std::vector<RobotStanding> finish() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return given_up_ || ended_ == members_.size(); });
        if (given_up_) stop_all();
        changed_.wait(lock, [&] { return ended_ == members_.size(); });
        std::vector<RobotStanding> standings;
        for (const auto& member : members_) standings.push_back(member->standing);
        return standings;
    }

private:
    using Clock = std::chrono::steady_clock;

    struct Member {
        Member(RobotPlan plan, std::size_t its_number) : number(its_number) { standing.plan = std::move(plan); }

        RobotStanding standing; // guarded by mutex_, except the plan, which never changes
        std::size_t number;
        Clock::duration longest_delay{}; // guarded by mutex_; of an acknowledgement, while scans are released in turn
        std::unique_ptr<ReleasedFeed> feed;
        std::unique_ptr<robot::Uplink> uplink;
    };

    void start(Member& member, const std::vector<std::uint16_t>& ports, const LinkTimeouts& timeouts) {
        member.feed = std::make_unique<ReleasedFeed>(
            member.standing.plan, [this, &member](std::uint64_t seq) { on_acknowledged(member, seq); });
        auto options = options_of(member.standing.plan, ports, timeouts);
        options.drain_max = std::chrono::milliseconds(0);
        member.uplink = std::make_unique<robot::Uplink>(io_, std::move(options), *member.feed);
        asio::co_spawn(io_, member.uplink->run(), [this, &member](std::exception_ptr failed, Result<> outcome) {
            on_ended(member, failed ? Error{Errc::kInternal, "an uplink threw"} : std::move(outcome));
        });
    }

    void on_acknowledged(Member& member, std::uint64_t seq) {
        const std::lock_guard lock(mutex_);
        if (begin_ && seq > member.standing.acknowledged) {
            const auto delay = Clock::now() - due(member.number, member.standing.acknowledged + 1);
            member.longest_delay = std::max(member.longest_delay, delay);
        }
        acknowledged_ += seq - member.standing.acknowledged;
        member.standing.acknowledged = seq;
        changed_.notify_all();
    }

    void on_ended(Member& member, Result<> outcome) {
        const std::lock_guard lock(mutex_);
        const bool is_first = !given_up_;
        given_up_ = given_up_ || !outcome;
        if (outcome || is_first) member.standing.outcome = std::move(outcome); // later errors result from the stop
        member.standing.reconnects = member.uplink->status().reconnects;
        ++ended_;
        changed_.notify_all();
    }

    /// Returns when a scan is released while they are released in turn.
    [[nodiscard]] Clock::time_point due(std::size_t member, std::uint64_t seq) const {
        return *begin_ + interval_ * static_cast<Clock::rep>((seq - 1) * members_.size() + member);
    }

    asio::awaitable<void> release_in_turn() {
        asio::steady_timer timer(io_);
        for (std::uint64_t seq = 1;; ++seq) {
            for (auto& member : members_) {
                timer.expires_at(due(member->number, seq));
                co_await timer.async_wait(asio::use_awaitable);
                if (is_ending_) co_return;
                member->feed->release(seq);
            }
        }
    }

    void stop_all() {
        asio::post(io_, [this] {
            for (auto& member : members_) member->uplink->stop();
        });
    }

    asio::io_context io_{1};
    asio::executor_work_guard<asio::io_context::executor_type> work_{io_.get_executor()};
    std::vector<std::unique_ptr<Member>> members_;
    mutable std::mutex mutex_; // guards the members below
    std::condition_variable changed_;
    std::uint64_t acknowledged_ = 0;
    std::uint64_t to_acknowledge_ = 0; // of all released scans
    std::size_t ended_ = 0;
    bool given_up_ = false;
    bool is_ending_ = false; // on the thread
    // Set before the first scan is released in turn.
    std::optional<Clock::time_point> begin_;
    Clock::duration interval_{}; // between two scans of all robots
    std::thread thread_;
};

std::vector<RobotPlan> half_sharing(unsigned robots, std::uint64_t seed, std::uint64_t scans) {
    std::vector<RobotPlan> made;
    for (unsigned n = 0; n < robots; ++n) {
        made.push_back({n % 2 == 0 ? "shared" : fmt::format("alone{}", n), fmt::format("robot{}", n),
                        static_cast<unsigned>(seed * robots + n), scans});
    }
    return made;
}

Fleet::Fleet(std::vector<RobotPlan> plans, const std::vector<std::uint16_t>& ports, const LinkTimeouts& timeouts)
    : robots_(std::make_unique<Robots>(std::move(plans), ports, timeouts)) {}
Fleet::~Fleet() = default;

void Fleet::release(std::uint64_t seq) { robots_->release(seq); }
void Fleet::release_all() { robots_->release(std::numeric_limits<std::uint64_t>::max()); }
void Fleet::stream(unsigned rate) { robots_->stream(rate); }
void Fleet::end() { robots_->end(); }
std::vector<std::chrono::milliseconds> Fleet::wait_for_all() { return robots_->wait_for_all(); }
bool Fleet::wait_for_acknowledged(std::uint64_t scans) { return robots_->wait_for_acknowledged(scans); }
std::uint64_t Fleet::acknowledged() const { return robots_->acknowledged(); }
bool Fleet::has_given_up() const { return robots_->has_given_up(); }
std::vector<RobotStanding> Fleet::finish() { return robots_->finish(); }

} // namespace scanloom::fault
