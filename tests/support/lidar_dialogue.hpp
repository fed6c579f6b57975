#pragma once

#include "robot_client/lidars/lidar_driver.hpp"
#include "tests/support/lidar_emulators.hpp"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::testing_support {

/// A driver and an emulator that talk to each other without a line. Time passes only as the test says; a timeout is
/// over at once if the emulator has nothing to answer.
class LidarDialogue {
public:
    LidarDialogue(robot::LidarDriver& driver, LidarEmulator& emulator) : driver_(driver), emulator_(emulator) {}

    /// Opens the line and lets both talk until the driver asks nothing more.
    void open() {
        failure_.reset();
        take(driver_.on_open());
    }

    /// Passes one turn of the emulator to the driver, at this Unix time.
    void turn(double arrival) { send(emulator_.next_turn(), arrival); }

    /// Passes bytes to the driver.
    void send(const LidarEmulator::Bytes& bytes, double arrival) {
        arrival_ = arrival;
        take(driver_.on_bytes(bytes, arrival));
    }

    [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
    [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

private:
    void take(robot::LidarStep step) {
        for (bool is_timed = false;;) {
            notes_.insert(notes_.end(), step.notes.begin(), step.notes.end());
            if ((failure_ = step.failure)) return;
            if (step.timeout) is_timed = step.timeout->count() > 0;
            const auto answers = emulator_.receive(step.send);
            if (!answers.empty()) {
                step = driver_.on_bytes(answers, arrival_);
            } else if (std::exchange(is_timed, false)) {
                step = driver_.on_timeout();
            } else {
                return;
            }
        }
    }

    robot::LidarDriver& driver_;
    LidarEmulator& emulator_;
    double arrival_ = 1000.0;
    std::vector<std::string> notes_;
    std::optional<Error> failure_;
};

} // namespace scanloom::testing_support
