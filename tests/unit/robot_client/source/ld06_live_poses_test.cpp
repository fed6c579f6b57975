#include "tests/unit/robot_client/source/ld06_live_fixture.hpp"

#include <boost/asio/steady_timer.hpp>
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
    void SetUp() override {
        ASSERT_EQ(::pipe2(pipe_, O_CLOEXEC), 0);
        auto live = options(SerialDevice{sensor_.device()}, PoseTimeline());
        live.pose_descriptor = pipe_[0];
        source_ = std::make_unique<Ld06Live>(std::move(live));
    }
    void TearDown() override { end_poses(); }

    void write_pose(double t, double x) const { write(fmt::format("{:.6f} {} 0 0\n", t, x)); }
    void write(const std::string& text) const {
        ASSERT_EQ(::write(pipe_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
    }
    void end_poses() {
        if (pipe_[1] >= 0) ::close(std::exchange(pipe_[1], -1));
    }

    PseudoTerminal sensor_;
    int pipe_[2]{-1, -1};
    std::unique_ptr<Ld06Live> source_;
};

TEST_F(Ld06LivePoses, AScanTakesThePoseBetweenThoseAroundIt) {
    const double now = unix_now();
    const Scan scan = scan_of(*source_, [&] {
        sensor_.send(one_turn());
        write_pose(now - 100.0, 0.0);
        write("what is this\n# a comment\n");
        write_pose(now + 100.0, 200.0);
    });
    EXPECT_NEAR(scan.pose.x, 100.0 + scan.stamp - now, 1e-3);
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("line 2 of the poses is skipped")));
}

TEST_F(Ld06LivePoses, AScanWaitsForThePoseBehindIt) {
    const double now = unix_now();
    asio::steady_timer timer(io_);
    const Scan scan = scan_of(*source_, [&] {
        write_pose(now - 100.0, 0.0);
        sensor_.send(one_turn());
        timer.expires_after(std::chrono::milliseconds(50));
        timer.async_wait([&](auto) { write_pose(now + 100.0, 200.0); });
    });
    EXPECT_NEAR(scan.pose.x, 100.0 + scan.stamp - now, 1e-3);
}

TEST_F(Ld06LivePoses, WhereNoneComesAScanTakesTheNewest) {
    const Scan scan = scan_of(*source_, [&] {
        write_pose(unix_now() - 0.2, 7.0);
        sensor_.send(one_turn());
    });
    EXPECT_EQ(scan.pose.x, 7.0);
}

TEST_F(Ld06LivePoses, WithoutANewPoseAScanIsPassedOver) {
    const double now = unix_now();
    asio::steady_timer timer(io_);
    const auto next = next_of(*source_, [&] {
        write_pose(now - 100.0, 7.0);
        sensor_.send(one_turn());
        timer.expires_after(kPoseWait + std::chrono::milliseconds(100));
        timer.async_wait([&](auto) { source_->stop(); });
    });
    EXPECT_FALSE(next.value());
    EXPECT_EQ(source_->remarks(), "0 damaged packets, 1 turn, 1 scan without a pose passed over");
}

TEST_F(Ld06LivePoses, AreNotWaitedForWhenTheyHaveEnded) {
    on_note_ = [&] { sensor_.send(one_turn()); };
    asio::steady_timer timer(io_);
    const auto next = next_of(*source_, [&] {
        end_poses();
        timer.expires_after(std::chrono::milliseconds(100)); // less than a scan would wait
        timer.async_wait([&](auto) { source_->stop(); });
    });
    EXPECT_FALSE(next.value());
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("the poses have ended; scans behind the last of them have none")));
    EXPECT_THAT(source_->remarks(), HasSubstr("1 scan without a pose"));
}

TEST_F(Ld06LivePoses, ALineWithoutAnEndIsNotReadOn) {
    on_note_ = [&] { source_->stop(); };
    EXPECT_FALSE(next_of(*source_, [&] { write(std::string(5000, '1')); }).value());
    EXPECT_THAT(notes_, ElementsAre(HasSubstr("line 1 of the poses is longer than 4096 bytes")));
}

} // namespace
} // namespace scanloom::robot
