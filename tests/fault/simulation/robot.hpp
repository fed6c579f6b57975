#pragma once

#include "common/link/client_protocol.hpp"
#include "robot_client/uplink/backoff.hpp"
#include "robot_client/uplink/send_buffer.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/simulation/network.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace scanloom::simulation {

/// A robot that streams a recording with the real protocol code over a simulated network. If its program ends before
/// all scans are acknowledged, it is started again.
class Robot {
public:
    /// Returns a connection to the server, or null if no server listens.
    using Connect = std::function<std::shared_ptr<Connection>()>;

    /// Returns the token for a program that starts.
    using Secret = std::function<std::string()>;
    /// Returns whether the server had a reason at some time since `since` to refuse this robot for good.
    using Explains = std::function<bool(const wire::Hello& hello, Errc code, Time since)>;

    Robot(World& world, fault::RobotPlan plan, Connect connect, Secret secret, Explains explains);
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    /// Kills the program.
    void crash();

    [[nodiscard]] bool is_done() const { return done_; }
    /// Returns the highest seq acknowledged as durable, and the newest of the errors that ended the program
    /// without an explanation.
    [[nodiscard]] const fault::RobotStanding& standing() const { return standing_; }

private:
    void start();
    void start_again();
    void connect();
    void hear(std::string_view bytes);
    void say();
    void feed();
    void lose(const wire::LinkError& why);
    void drop_connection();
    void watch();
    /// Calls `what` after `delay`, unless the program or its connection has ended before then.
    void while_running(Duration delay, void (Robot::*what)());
    void while_linked(Time time, void (Robot::*what)());

    World& world_;
    Connect connect_;
    Secret secret_;
    Explains explains_;
    fault::RobotStanding standing_;
    std::shared_ptr<const Sensor> laser_;
    std::uint64_t runs_ = 0;
    std::uint64_t links_ = 0;
    bool done_ = false;

    wire::Hello hello_;                            // of the current run
    std::optional<robot::SendBuffer> buffer_;      // of the current run
    std::optional<link::ClientProtocol> protocol_; // of the current run; nullopt: the program is not running
    std::optional<robot::Backoff> backoff_;
    std::uint64_t handed_over_ = 0;
    std::shared_ptr<Connection> connection_;
    Time connected_{};            // when connection_ was established
    Time watching_ = Time::max(); // the time of the next scheduled check
};

} // namespace scanloom::simulation
