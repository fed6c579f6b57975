#pragma once

#include "robot_client/uplink/recording_feed.hpp"
#include "robot_client/uplink/uplink.hpp"

#include "tests/integration/robot_client/fake_server.hpp"
#include "tests/support/recorded_source.hpp"

#include <boost/asio/co_spawn.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {

/// Returns scans whose poses and stamps identify them.
inline std::vector<Observation> numbered_scans(std::size_t scans) {
    const auto sensor = std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 90}, 0.0, 0.0, 10.0});
    std::vector<Observation> made(scans, Observation{sensor, {}});
    for (std::size_t i = 0; i < scans; ++i) {
        made[i].scan.stamp = static_cast<double>(i);
        made[i].scan.pose = {static_cast<double>(i + 1), 0.0, 0.0};
        made[i].scan.ranges.assign(90, 1000);
    }
    return made;
}

/// A robot and a server on one thread.
class UplinkTest : public testing::Test {
protected:
    static constexpr std::size_t kScans = 500;

    void serve(std::vector<LinkScript> scripts) { server_.emplace(io_, std::move(scripts)); }

    UplinkOptions options() {
        UplinkOptions made;
        made.servers = {{"127.0.0.1", std::to_string(server_->port())}};
        made.protocol.hello.robot = "r1";
        made.protocol.hello.session = "s1";
        made.give_up_after = std::chrono::seconds(20);
        made.on_trouble = [this](const Error& error) { troubles_.push_back(error.message); };
        return made;
    }

    /// Runs until the uplink has its outcome.
    Result<> run(const UplinkOptions& made, std::size_t scans = kScans) {
        if (!source_) source_.emplace(numbered_scans(scans));
        feed_.emplace(*source_, pace_);
        uplink_.emplace(io_, made, *feed_);
        Result<> outcome = Error{Errc::kTimeout, "it did not end"};
        boost::asio::co_spawn(io_, uplink_->run(), [&](std::exception_ptr failed, Result<> result) {
            EXPECT_FALSE(failed);
            outcome = std::move(result);
            io_.stop();
        });
        io_.run();
        return outcome;
    }

    /// Returns the message of a run that gives up after 0.3 s.
    std::string reason_to_give_up() {
        auto made = options();
        made.give_up_after = std::chrono::milliseconds(300);
        const auto outcome = run(made);
        return outcome ? "it ended without an error" : outcome.error().message;
    }

    void expect_all_stored_once(std::size_t scans = kScans, std::size_t from_earlier = 0) {
        EXPECT_THAT(server_->faults(), testing::IsEmpty());
        ASSERT_EQ(server_->stored().size(), scans);
        for (std::size_t i = from_earlier; i < scans; ++i) {
            EXPECT_EQ(server_->stored()[i].seq, i + 1);
            EXPECT_EQ(server_->stored()[i].pose->x, static_cast<double>(i + 1));
        }
    }

    boost::asio::io_context io_{1};
    std::optional<FakeServer> server_;
    std::optional<RecordedSource> source_;
    RecordingFeedOptions pace_;
    std::optional<RecordingFeed> feed_;
    std::optional<Uplink> uplink_;
    std::vector<std::string> troubles_;
};

} // namespace scanloom::robot
