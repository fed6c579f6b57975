#include "tests/unit/robot_client/lidars/ld06_live_fixture.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Ld06LivePoses : public Ld06Lives {
protected:
    void SetUp() override { ASSERT_EQ(::pipe2(pipe_, O_CLOEXEC), 0); }
    void TearDown() override { end_poses(); }

    /// The limits are either unlimited or zero, so that the tests do not depend on the machine's speed.
    void start(std::chrono::milliseconds wait = kUnlimited, std::chrono::milliseconds age_max = kUnlimited) {
        auto live = options(SerialDevice{sensor_.device()}, PoseTimeline());
        live.pose_descriptor = pipe_[0];
        live.pose_wait = wait;
        live.pose_age_max = age_max;
        live.pose_ahead_max = ahead_max_;
        source_ = std::make_unique<LidarLive>(std::move(live));
    }
    void stop_when_passed_over(int scans) {
        const auto passed_over = fmt::format("{} scan{} skipped without a pose", scans, scans == 1 ? "" : "s");
        if (source_->remarks().find(passed_over) != std::string::npos) return source_->stop();
        asio::post(io_, [this, scans] { stop_when_passed_over(scans); });
    }

    void write_pose(double t, double x) const { write(fmt::format("{:.6f} {} 0 0\n", t, x)); }
    void write(const std::string& text) const {
        ASSERT_EQ(::write(pipe_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    }
    void end_poses() {
        if (pipe_[1] >= 0) ::close(std::exchange(pipe_[1], -1));
    }

    static constexpr std::chrono::hours kUnlimited{1};
    static constexpr std::chrono::milliseconds kNone{0};

    std::chrono::milliseconds ahead_max_ = kUnlimited;
    PseudoTerminal sensor_;
    int pipe_[2]{-1, -1};
    std::unique_ptr<LidarLive> source_;
};

TEST_F(Ld06LivePoses, ScanPoseIsInterpolated) {
    start();
    const double now = unix_now();
    const Scan scan = scan_of(*source_, [&] {
        sensor_.send(one_turn());
        write_pose(now - 100.0, 0.0);
        write("what is this\n# a comment\n");
        write_pose(now + 100.0, 200.0);
    });
    EXPECT_NEAR(scan.pose->x, 100.0 + scan.stamp - now, 1e-3);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("line 2 of the poses is skipped")));
}

TEST_F(Ld06LivePoses, ScanWaitsForTheNextPose) {
    start();
    const double now = unix_now();
    const std::function<void()> write_once_it_waits = [&] {
        if (source_->remarks().find("1 turn") != std::string::npos) return write_pose(now + 100.0, 200.0);
        asio::post(io_, write_once_it_waits);
    };
    const Scan scan = scan_of(*source_, [&] {
        write_pose(now - 100.0, 0.0);
        sensor_.send(one_turn());
        write_once_it_waits();
    });
    EXPECT_NEAR(scan.pose->x, 100.0 + scan.stamp - now, 1e-3);
}

TEST_F(Ld06LivePoses, ScanUsesTheNewestPoseAfterTheWait) {
    start(std::chrono::milliseconds(1), kUnlimited);
    on_note_ = [&] { sensor_.send(one_turn()); }; // the pose before the note has been read
    const Scan scan = scan_of(*source_, [&] {
        write_pose(unix_now() - 100.0, 7.0);
        write("what is this\n");
    });
    EXPECT_EQ(scan.pose->x, 7.0);
}

TEST_F(Ld06LivePoses, ScanIsDroppedIfTheNewestPoseIsTooOld) {
    start(kNone, std::chrono::seconds(50));
    const auto next = next_of(*source_, [&] {
        write_pose(unix_now() - 100.0, 7.0);
        sensor_.send(one_turn());
        stop_when_passed_over(1);
    });
    EXPECT_THAT(next.error().message, HasSubstr("none of 1 scans"));
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("for a device t is Unix time")));
    EXPECT_EQ(source_->remarks(), "0 damaged packets, 1 turn, 1 scan skipped without a pose");
}

TEST_F(Ld06LivePoses, PosesOfAnotherClockAreReportedOnceAndEndWithAnError) {
    start(kNone, kNone);
    const auto next = next_of(*source_, [&] {
        write_pose(12.0, 0.0);
        write_pose(13.0, 0.0);
        sensor_.send(Ld06Spinner(35'000).next_bytes(80));
        stop_when_passed_over(2);
    });
    ASSERT_FALSE(next);
    EXPECT_THAT(next.error().message,
                HasSubstr("none of 2 scans is within the time range of the poses; for a device the t"));
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("the poses are at t = 13, and the scans at t = 1")));
}

TEST_F(Ld06LivePoses, SomeMatchingPosesAreNoError) {
    start(kUnlimited);
    const double now = unix_now();
    static_cast<void>(scan_of(*source_, [&] {
        write_pose(now - 100.0, 0.0);
        write_pose(now + 100.0, 0.0);
        sensor_.send(one_turn());
    }));
    const auto next = next_of(*source_, [&] { source_->stop(); });
    ASSERT_TRUE(next) << next.error().message;
    EXPECT_FALSE(*next);
    EXPECT_TRUE(notes_.empty());
}

TEST_F(Ld06LivePoses, PoseFarAheadOfTheClockIsIgnoredAndReported) {
    ahead_max_ = std::chrono::seconds(50);
    start(kNone);
    on_note_ = [&] { sensor_.send(one_turn()); };
    const Scan scan = scan_of(*source_, [&] {
        write_pose(unix_now() - 100.0, 7.0);
        write_pose(unix_now() + 100.0, 50.0);
        write_pose(unix_now() + 101.0, 50.0);
    });
    EXPECT_EQ(scan.pose->x, 7.0);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("the clocks must agree")));
}

TEST_F(Ld06LivePoses, DoesNotWaitAfterTheEndOfThePoses) {
    start();
    on_note_ = [&] { sensor_.send(one_turn()); };
    const auto next = next_of(*source_, [&] {
        end_poses();
        stop_when_passed_over(1);
    });
    EXPECT_FALSE(next);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("the poses have ended; scans after the last pose are skipped")));
}

TEST_F(Ld06LivePoses, TooLongPoseLineEndsReading) {
    start();
    on_note_ = [&] { source_->stop(); };
    EXPECT_FALSE(next_of(*source_, [&] { write(std::string(5000, '1')); }).value());
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("line 1 of the poses is longer than 4096 bytes")));
}

} // namespace
} // namespace scanloom::robot
