#pragma once

#include "robot_client/foxglove/foxglove_source.hpp"
#include "tests/support/fake_bridge.hpp"
#include "tests/support/ros_bytes.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using testing_support::FakeBridge;

/// A robot with a bridge, and the source that reads it, in one thread.
class FoxgloveFixture : public testing::Test {
protected:
    static constexpr RosTime kStart = 1'600'000'000'000'000'000; // years ago, as in a simulation
    static constexpr RosTime kScanPeriod = 100'000'000;

    /// The topics of a robot.
    struct Robot {
        std::uint64_t scan = 0;
        std::uint64_t tf = 0;
        std::uint64_t tf_static = 0;
        MessageEncoding encoding = MessageEncoding::kRos1;
    };

    ~FoxgloveFixture() override {
        source_.reset();
        bridge_.reset();
        io_.restart();
        io_.poll();
    }

    void start_bridge(FakeBridge::Options options = {}) {
        bridge_ = std::make_unique<FakeBridge>(io_, std::move(options));
        port_ = bridge_->port();
    }

    Robot advertise_robot(MessageEncoding encoding = MessageEncoding::kRos1) {
        const bool is_ros1 = encoding == MessageEncoding::kRos1;
        const std::string name = is_ros1 ? "ros1" : "cdr";
        const std::string middle = is_ros1 ? "/" : "/msg/";
        return {bridge_->advertise("/scan", name, "sensor_msgs" + middle + "LaserScan"),
                bridge_->advertise("/tf", name, "tf2_msgs" + middle + "TFMessage"),
                bridge_->advertise("/tf_static", name, "tf2_msgs" + middle + "TFMessage"), encoding};
    }

    FoxgloveSourceOptions options() {
        FoxgloveSourceOptions options;
        options.link.bridge = parse_url(fmt::format("ws://127.0.0.1:{}", port_), kWebSocketUrl).value();
        options.link.backoff = {1ms, 1ms};
        options.link.note = [this](const std::string& text) { notes_.push_back(text); };
        options.link.steady_after = 0ms;
        options.scans.survey = 0ms;
        options.scans.survey_max = 0ms;
        options.publish.transform_period = 1ms;
        options.publish.map_period = 1ms;
        return options;
    }

    void make_source(FoxgloveSourceOptions options) { source_ = std::make_unique<FoxgloveSource>(std::move(options)); }
    void make_source() { make_source(options()); }

    /// Runs the thread until the condition holds.
    void run_until(const std::function<bool()>& holds) {
        constexpr auto kPatience = 60s;                     // so that a failure does not stop the run of the tests
        const auto is_over = std::make_shared<bool>(false); // the handler runs later if the timer is cancelled
        asio::steady_timer patience(io_, kPatience);
        patience.async_wait([is_over](boost::system::error_code failed) { *is_over = !failed; });
        io_.restart();
        while (!holds() && !*is_over && io_.run_one() > 0) {
        }
        ASSERT_TRUE(holds());
    }

    /// Waits for prepare() and sends a scan as soon as the source has subscribed to it.
    Result<Poses> prepare(const Robot& robot) {
        return prepare([&] {
            if (!bridge_->is_subscribed(robot.scan) || !bridge_->is_subscribed(robot.tf_static)) return;
            bridge_->on_change = [] {};
            send_static(robot);
            send_pose(robot, 0);
            send_scan(robot, 0);
            send_pose(robot, 1);
        });
    }

    Result<Poses> prepare(const std::function<void()>& on_change = [] {}) {
        if (bridge_) bridge_->on_change = on_change;
        std::optional<Result<Poses>> poses;
        asio::co_spawn(io_, source_->prepare(), [&](std::exception_ptr failed, Result<Poses> result) {
            if (failed) std::rethrow_exception(failed);
            poses = std::move(result);
        });
        run_until([&] { return poses.has_value(); });
        return poses.value_or(Error{Errc::kInternal, "prepare() did not complete"});
    }

    using Next = Result<std::optional<Observation>>;

    /// Begins a next(), whose result next_of() waits for.
    void begin_next() {
        next_.reset();
        asio::co_spawn(io_, source_->next(), [this](std::exception_ptr failed, Next result) {
            if (failed) std::rethrow_exception(failed);
            next_ = std::move(result);
        });
    }

    Next next_of() {
        begin_next();
        run_until([this] { return next_.has_value(); });
        return next_.value_or(Error{Errc::kInternal, "next() did not complete"});
    }

    /// Expects that next() returns a scan. @return the x of its odometry
    double next_x() {
        const auto next = next_of();
        if (next && *next) return (*next)->scan.odometry.value_or(Pose2{}).x;
        ADD_FAILURE() << (next ? "the source has ended" : next.error().message);
        return 0.0;
    }

    static RosTime stamp(int tenth) { return kStart + tenth * kScanPeriod; }

    void send_static(const Robot& robot) {
        const auto mount = testing_support::flat(0, "base", "laser", 0.25);
        bridge_->send(robot.tf_static, stamp(0), testing_support::transform_bytes({mount}, robot.encoding));
    }

    /// Sends the pose x = the count at a tenth of a second.
    void send_pose(const Robot& robot, int tenth, const std::string& parent = "odom") {
        const auto pose = testing_support::flat(stamp(tenth), parent, "base", tenth);
        bridge_->send(robot.tf, stamp(tenth), testing_support::transform_bytes({pose}, robot.encoding));
    }

    /// Sends a scan half a tenth of a second after the pose.
    void send_scan(const Robot& robot, int tenth) {
        const RosLaserScan scan{{stamp(tenth) + kScanPeriod / 2, "laser"},
                                -1.0F,
                                1.0F,
                                0.5F,
                                0.0F,
                                0.1F,
                                0.1F,
                                10.0F,
                                std::vector<float>(5, 2.0F)};
        bridge_->send(robot.scan, stamp(tenth), testing_support::laser_bytes(scan, robot.encoding));
    }

    /// Waits until the source has subscribed to the topics of the robot.
    void wait_for_subscriptions(const Robot& robot) {
        run_until([&] { return bridge_->is_subscribed(robot.scan) && bridge_->is_subscribed(robot.tf); });
    }

    [[nodiscard]] bool has_note(const std::string& part) const {
        return std::ranges::any_of(notes_, [&](const auto& note) { return note.find(part) != std::string::npos; });
    }

    asio::io_context io_{1};
    std::unique_ptr<FakeBridge> bridge_;
    std::uint16_t port_ = 0;
    std::unique_ptr<FoxgloveSource> source_;
    std::vector<std::string> notes_;
    std::optional<Next> next_;
};

} // namespace scanloom::robot
