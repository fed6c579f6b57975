#pragma once

#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/robot_socket.hpp"
#include "tests/support/running_ingest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace scanloom::ingest {

using testing_support::frame_of;
using testing_support::random_scan;
using testing_support::random_scans;
using testing_support::RobotSocket;
using testing_support::small_laser;

inline wire::Hello hello(const std::string& robot, const std::string& session = "lab") {
    wire::Hello hello;
    hello.robot = robot;
    hello.session = session;
    hello.create = SessionOptions{};
    hello.client = "ingest test";
    return hello;
}

/// Connects a robot and waits for its welcome.
inline std::unique_ptr<RobotSocket> welcomed(std::uint16_t port, const wire::Hello& hello) {
    auto robot = std::make_unique<RobotSocket>(port);
    robot->send(hello);
    robot->receive_kind<wire::Welcome>();
    return robot;
}

/// Sends the scans first..last of the seed's stream, in batches of ten, and waits until they are durable.
inline void stream(RobotSocket& robot, unsigned seed, std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t seq = first; seq <= last; seq += 10) {
        robot.send(wire::ScanBatch{random_scans(seed, seq, std::min<std::uint64_t>(10, last + 1 - seq))});
    }
    robot.wait_for_ack(last);
}

/// Waits for the error that ends the link, and for the end of the connection after it.
inline wire::LinkError farewell_to(RobotSocket& robot) {
    for (;;) {
        const auto message = robot.receive();
        if (!message) throw std::runtime_error("the server closed the link without an error");
        if (const auto* error = std::get_if<wire::LinkError>(&*message)) {
            EXPECT_FALSE(robot.receive().has_value()) << "the error is the last frame";
            return *error;
        }
    }
}

inline void expect_refused(RobotSocket& robot, Errc code, bool retryable, const std::string& beginning) {
    const auto refused = farewell_to(robot);
    EXPECT_EQ(refused.error.code, code) << refused.error.message;
    EXPECT_EQ(refused.retryable, retryable) << refused.error.message;
    EXPECT_THAT(refused.error.message, testing::StartsWith(beginning));
}

class IngestTest : public testing::Test {
protected:
    /// Otherwise the server would wait for completions that a failed test still holds.
    void TearDown() override { log_.release_completions(); }

    RunningIngest& start(const IngestConfig& config = {}) {
        running_ = std::make_unique<RunningIngest>(log_, config);
        return *running_;
    }
    [[nodiscard]] std::uint16_t port() const { return running_->port(); }

    store::MemoryScanLog log_;
    std::unique_ptr<RunningIngest> running_;
};

} // namespace scanloom::ingest
