#pragma once

#include "robot_client/lidars/ld06_driver.hpp"
#include "robot_client/lidars/lidar_clock.hpp"
#include "robot_client/lidars/lidar_live.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/pseudo_terminal.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <unistd.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Fixtures for lidars that are read live.
namespace scanloom::robot {

namespace asio = boost::asio;
using testing_support::Bytes;
using testing_support::Ld06Spinner;

/// The sensor's end of a pseudo-terminal.
class PseudoTerminal : public testing_support::PseudoTerminal {
public:
    void send(const Bytes& bytes) const {
        ASSERT_EQ(::write(descriptor_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    }
};

using Next = Result<std::optional<Observation>>;

class Ld06Lives : public testing::Test {
protected:
    LidarLiveOptions options(LidarEndpoint endpoint, LidarPoses poses = Pose2{1.0, 2.0, 0.5}) {
        LidarLiveOptions live;
        live.device.endpoint = std::move(endpoint);
        live.device.serial.baud = 230'400;
        live.driver = std::make_unique<Ld06Driver>("an LD06", ld06_sensor({}), LidarScanOptions{});
        live.device.note = [this](const std::string& text) {
            notes_.push_back(text);
            if (on_note_) on_note_();
        };
        live.poses = std::move(poses);
        return live;
    }

    /// Runs the io_context until next() completes; `meanwhile` runs once after next() has started to wait.
    Next next_of(
        LiveSource& source, const std::function<void()>& meanwhile = [] {}) {
        std::optional<Next> result;
        asio::co_spawn(io_, source.next(), [&](std::exception_ptr failed, Next next) {
            if (failed) std::rethrow_exception(failed);
            result = std::move(next);
        });
        io_.restart();
        while (!result && io_.poll_one() > 0) { // a sensor that never waits keeps it busy
        }
        meanwhile();
        while (!result && io_.run_one() > 0) {
        }
        return result ? *result : Next(Error{Errc::kInternal, "next() did not complete"});
    }

    /// Expects that next() returns a scan.
    Scan scan_of(
        LiveSource& source, const std::function<void()>& meanwhile = [] {}) {
        const auto next = next_of(source, meanwhile);
        if (next && *next) return (*next)->scan;
        ADD_FAILURE() << (next ? "the source has ended" : next.error().message);
        return {};
    }

    /// Returns bytes of the end of one turn and of the complete next turn.
    static Bytes one_turn() { return Ld06Spinner(35'000).next_bytes(40); }

    asio::io_context io_{1};
    std::vector<std::string> notes_;
    std::function<void()> on_note_;
};

} // namespace scanloom::robot
