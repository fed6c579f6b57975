#include "robot_client/foxglove/foxglove_source.hpp"

#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/ros/recording_plan.hpp"
#include "robot_client/sources/messages.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <set>
#include <utility>
#include <variant>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace asio::experimental::awaitable_operators;

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::size_t kStatusesNoted = 20;
constexpr std::size_t kStatusShown = 200; // characters

} // namespace

/// State shared by the reading coroutines and next().
class FoxgloveSource::State final : public BridgeListener, public std::enable_shared_from_this<FoxgloveSource::State> {
public:
    explicit State(FoxgloveSourceOptions options)
        : options_(std::move(options)), scans_(options_.scans),
          session_([this](const RecordedTopic& topic) { return scans_.needs(topic); }),
          publisher_(options_.publish, session_, to_send_, options_.link.note) {}

    [[nodiscard]] asio::awaitable<Result<Poses>> prepare();
    [[nodiscard]] asio::awaitable<Result<std::optional<Observation>>> next();
    void stop();
    [[nodiscard]] std::string remarks() const;
    void expect_poses(Poses poses) { scans_.expect_poses(poses); }
    void correct(const std::optional<Pose2>& T_map_odom) { publisher_.correct(T_map_odom); }
    [[nodiscard]] const LiveScans& scans() const { return scans_; }
    [[nodiscard]] std::uint64_t refused() const;

    // BridgeListener
    void on_open() override { session_.begin(); }
    void on_text(std::string_view text) override { take(session_.take_text(text)); }
    void on_binary(std::string_view bytes) override { take(session_.take_binary(bytes)); }
    void on_lost() override;
    [[nodiscard]] bool is_connected() const override { return session_.is_connected(); }
    [[nodiscard]] std::optional<foxglove::OutgoingFrame> next_frame() override { return session_.next_frame(); }

private:
    [[nodiscard]] static asio::awaitable<void> read(std::shared_ptr<State> self);
    [[nodiscard]] static asio::awaitable<void> publish(std::shared_ptr<State> self);
    void spawn(const asio::any_io_executor& executor, asio::awaitable<void> task);
    void take(foxglove::Event event);
    void take(foxglove::Connected connected);
    void take(foxglove::TopicsChanged changed);
    void take(const foxglove::Delivered& message);
    void take(const foxglove::Status& status);
    void take(const foxglove::ServerTime& time);
    static void take(std::monostate) {}
    void note_waiting();
    [[nodiscard]] std::optional<SteadyClock::time_point> silent_at() const;
    void pass_on_notes();
    [[nodiscard]] Result<std::optional<Poses>> choose(SteadyClock::time_point now);

    void note(const std::string& text) const { options_.link.note(text); }

    FoxgloveSourceOptions options_;
    LiveScans scans_;
    foxglove::BridgeSession session_;
    std::uint64_t connections_ = 0;
    std::uint64_t statuses_ = 0; // warnings and errors of the bridge
    std::set<std::string> noted_statuses_;
    std::set<std::string> late_lasers_;
    std::optional<SteadyClock::time_point> newest_scan_; // or the newest connection; nullopt: not connected
    bool is_silence_noted_ = false;
    std::optional<Error> ended_; // why the bridge gives no more messages
    bool is_prepared_ = false;   // prepare() was called
    bool is_stopped_ = false;
    WakeSignal wake_;    // of next() and prepare()
    WakeSignal stop_;    // of the other coroutines
    WakeSignal to_send_; // of the writing one
    RobotPublisher publisher_;
};

// Reading -------------------------------------------------------------------------------------------------------------

void FoxgloveSource::State::spawn(const asio::any_io_executor& executor, asio::awaitable<void> task) {
    asio::co_spawn(executor, std::move(task), [](const std::exception_ptr& failed) {
        if (failed) std::rethrow_exception(failed);
    });
}

asio::awaitable<void> FoxgloveSource::State::read(std::shared_ptr<State> self) {
    auto reading = read_bridge(self->options_.link, *self, self->to_send_);
    const auto first = co_await (std::move(reading) || self->stop_.wait());
    if (const auto* error = std::get_if<0>(&first)) self->ended_ = *error;
    self->wake_.notify();
}

asio::awaitable<void> FoxgloveSource::State::publish(std::shared_ptr<State> self) {
    auto publishing = self->publisher_.run(self->scans_.choice().frames.fixed);
    static_cast<void>(co_await (std::move(publishing) || self->stop_.wait()));
}

void FoxgloveSource::State::on_lost() {
    session_.begin();
    scans_.interrupt();
    newest_scan_.reset();
}

void FoxgloveSource::State::take(foxglove::Event event) {
    std::visit([this](auto&& one) { this->take(std::forward<decltype(one)>(one)); }, std::move(event));
    pass_on_notes();
    to_send_.notify();
}

void FoxgloveSource::State::take(foxglove::Connected) {
    ++connections_;
    newest_scan_ = SteadyClock::now();
    scans_.resume(*newest_scan_);
    publisher_.on_connected();
    wake_.notify();
}

void FoxgloveSource::State::take(foxglove::TopicsChanged) {
    for (const auto& topic : session_.topics()) {
        if (!scans_.is_late_laser(topic) || !late_lasers_.insert(topic.name).second) continue;
        note(fmt::format("{}: this laser appeared after the survey of the robot, and is not used; start this program "
                         "again to use it",
                         shown_word(topic.name)));
    }
}

void FoxgloveSource::State::take(const foxglove::Delivered& message) {
    const auto now = SteadyClock::now();
    const auto stamp = scans_.add(message.topic, message.log_time, message.payload, now);
    if (stamp) {
        publisher_.add_stamp(*stamp);
        newest_scan_ = now;
        if (std::exchange(is_silence_noted_, false)) note("scans come again");
    }
    wake_.notify();
}

void FoxgloveSource::State::take(const foxglove::ServerTime& time) {
    publisher_.add_stamp(recorded_time(time.nanoseconds));
}

void FoxgloveSource::State::take(const foxglove::Status& status) {
    if (status.level == foxglove::Status::Level::kInfo) return;
    ++statuses_;
    if (noted_statuses_.size() == kStatusesNoted || !noted_statuses_.insert(status.message).second) return;
    note(fmt::format("the bridge reports: {}", shown_word(status.message, kStatusShown)));
}

void FoxgloveSource::State::pass_on_notes() {
    for (const auto& text : scans_.take_notes()) note(text);
}

// The survey ----------------------------------------------------------------------------------------------------------

asio::awaitable<Result<Poses>> FoxgloveSource::State::prepare() {
    const auto self = shared_from_this();
    is_prepared_ = true;
    spawn(co_await asio::this_coro::executor, read(self));
    std::optional<SteadyClock::time_point> note_at;
    while (!is_stopped_) {
        if (ended_) co_return *ended_;
        const auto now = SteadyClock::now();
        const auto end = session_.is_connected() ? scans_.survey_end() : std::nullopt;
        if (end && now >= *end) {
            const auto poses = choose(now);
            if (!poses) co_return poses.error();
            if (!*poses) continue;
            spawn(co_await asio::this_coro::executor, publish(self));
            co_return **poses;
        }
        if (!note_at && session_.is_connected()) note_at = now + options_.waiting_noted_after;
        if (note_at && now >= *note_at && !end) {
            note_waiting();
            note_at = SteadyClock::time_point::max();
        }
        co_await wake_.wait(end.value_or(note_at.value_or(SteadyClock::time_point::max())));
    }
    co_return Error{Errc::kShuttingDown, "stopped before the robot was surveyed"};
}

/// Reports what is missing for the survey.
void FoxgloveSource::State::note_waiting() {
    std::vector<std::string> offered;
    for (const auto& topic : session_.topics()) {
        if (is_laser(topic)) offered.push_back(shown_word(topic.name));
    }
    const auto missing = scans_.missing_topics();
    note(fmt::format("{}: waiting for scans{}{}; topics of lasers that the bridge offers: {}",
                     options_.link.bridge.text, missing.empty() ? "" : " of ", fmt::join(missing, ", "),
                     offered.empty() ? "none" : fmt::to_string(fmt::join(offered, ", "))));
}

/// Returns nullopt if the survey goes on. Precondition: the bridge is connected.
Result<std::optional<Poses>> FoxgloveSource::State::choose(SteadyClock::time_point now) {
    const auto chosen = scans_.choose(now);
    if (!chosen) return prefixed(options_.link.bridge.text + ": ", chosen.error());
    if (!*chosen) return std::optional<Poses>{};
    pass_on_notes();
    const FrameChoice& frames = scans_.choice().frames;
    note(fmt::format("{}: {}", options_.link.bridge.text,
                     poses_text(frames.poses, frames.base, frames.fixed, scans_.odom_topic())));
    if (auto checked = publisher_.check(frames, scans_.ancestors(frames.fixed)); !checked) return checked.error();
    session_.update_subscriptions();
    to_send_.notify();
    return std::optional(frames.poses);
}

// Giving --------------------------------------------------------------------------------------------------------------

asio::awaitable<Result<std::optional<Observation>>> FoxgloveSource::State::next() {
    const auto self = shared_from_this();
    if (!is_prepared_) {
        const auto poses = co_await prepare();
        if (!poses && !is_stopped_) co_return poses.error();
    }
    for (;;) {
        const bool has_ended = is_stopped_ || ended_; // then no transform comes that a scan could wait for
        if (auto ready = scans_.take(has_ended ? SteadyClock::time_point::max() : SteadyClock::now())) {
            co_return std::move(ready);
        }
        if (is_stopped_) co_return std::optional<Observation>{};
        if (ended_) co_return *ended_;
        if (silent_at() && SteadyClock::now() >= *silent_at()) {
            note(fmt::format("no scan has come for {:g} s; is the laser running?",
                             seconds(options_.silent_noted_after)));
            is_silence_noted_ = true;
        }
        constexpr auto kNever = SteadyClock::time_point::max();
        co_await wake_.wait(std::min(scans_.next_deadline().value_or(kNever), silent_at().value_or(kNever)));
    }
}

/// Returns when to report that no scans come; nullopt: that is done, or the bridge is away.
std::optional<SteadyClock::time_point> FoxgloveSource::State::silent_at() const {
    if (is_silence_noted_ || !newest_scan_) return std::nullopt;
    return *newest_scan_ + options_.silent_noted_after;
}

void FoxgloveSource::State::stop() {
    is_stopped_ = true;
    stop_.notify();
    wake_.notify();
}

std::uint64_t FoxgloveSource::State::refused() const {
    std::uint64_t refused = 0;
    for (const auto& [reason, count] : session_.refused()) refused += count;
    return refused;
}

std::string FoxgloveSource::State::remarks() const {
    std::vector<std::string> parts;
    if (!scans_.skipped().empty()) parts.push_back("skipped: " + skipped_text(scans_.skipped()));
    if (scans_.gaps() > 0) {
        parts.push_back(
            fmt::format("about {} missing in {}", counted(scans_.missing(), "scan"), counted(scans_.gaps(), "gap")));
    }
    if (connections_ > 1) parts.push_back(fmt::format("connected to the bridge {} times", connections_));
    if (statuses_ > 0) parts.push_back(fmt::format("{} of the bridge", counted(statuses_, "warning")));
    if (!session_.refused().empty()) parts.push_back("refused frames: " + skipped_text(session_.refused()));
    return fmt::to_string(fmt::join(parts, ", "));
}

// ---------------------------------------------------------------------------------------------------------------------

FoxgloveSource::FoxgloveSource(FoxgloveSourceOptions options) : state_(std::make_shared<State>(std::move(options))) {}

FoxgloveSource::~FoxgloveSource() { state_->stop(); }

asio::awaitable<Result<Poses>> FoxgloveSource::prepare() { return state_->prepare(); }

asio::awaitable<Result<std::optional<Observation>>> FoxgloveSource::next() { return state_->next(); }

void FoxgloveSource::expect_poses(Poses poses) { state_->expect_poses(poses); }

void FoxgloveSource::stop() { state_->stop(); }

std::string FoxgloveSource::remarks() const { return state_->remarks(); }

void FoxgloveSource::correct(const std::optional<Pose2>& T_map_odom) { state_->correct(T_map_odom); }

const std::map<std::string, std::uint64_t>& FoxgloveSource::skipped() const { return state_->scans().skipped(); }

std::uint64_t FoxgloveSource::lost_parts() const { return state_->scans().gaps() + state_->refused(); }

} // namespace scanloom::robot
