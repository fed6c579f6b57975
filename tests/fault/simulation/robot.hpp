#pragma once

#include "common/wire/frame_decoder.hpp"
#include "robot_client/uplink/backoff.hpp"
#include "robot_client/uplink/conversation.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/simulation/network.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace scanloom::simulation {

/// A robot that streams a recording: the real conversation, on a simulated network. When its program ends before all is
/// acknowledged, somebody starts it again.
class Robot {
public:
    /// A connection to the server; null: nobody listens.
    using Connect = std::function<std::shared_ptr<Connection>()>;

    Robot(World& world, fault::RobotPlan plan, Connect connect);
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    /// Its program is killed.
    void crash();

    [[nodiscard]] bool is_done() const { return done_; }
    /// The highest seq it was ever told is durable; of errors that ended its program, the newest.
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
    /// Calls it unless the program has ended, or its link, before then.
    void while_running(Duration delay, void (Robot::*what)());
    void while_linked(Time time, void (Robot::*what)());

    World& world_;
    Connect connect_;
    fault::RobotStanding standing_;
    std::shared_ptr<const Sensor> laser_;
    std::uint64_t runs_ = 0;
    std::uint64_t links_ = 0;
    bool done_ = false;

    std::optional<robot::Conversation> conversation_; // of this run; none: it is not running
    std::optional<robot::Backoff> backoff_;
    std::uint64_t handed_over_ = 0;
    std::shared_ptr<Connection> connection_;
    wire::FrameDecoder decoder_{wire::kFrameBytesMax};
    Time watching_ = Time::max(); // what is planned already
};

} // namespace scanloom::simulation
