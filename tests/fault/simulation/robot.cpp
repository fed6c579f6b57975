#include "tests/fault/simulation/robot.hpp"

#include "tests/support/random_scans.hpp"

#include <algorithm>
#include <span>

namespace scanloom::simulation {

using namespace std::chrono_literals;

Robot::Robot(World& world, fault::RobotPlan plan, Connect connect, Secret secret, Explains explains)
    : world_(world), connect_(std::move(connect)), secret_(std::move(secret)), explains_(std::move(explains)),
      laser_(std::make_shared<const Sensor>(testing_support::small_laser())) {
    standing_.plan = std::move(plan);
    start();
}

void Robot::start() {
    ++runs_;
    link::ClientProtocolOptions options;
    options.hello.robot = standing_.plan.name;
    options.hello.session = standing_.plan.session;
    options.hello.create = fault::fleet_options();
    options.hello.client = "simulation";
    options.hello.token = secret_();
    hello_ = options.hello;
    buffer_.emplace(2'000 + world_.draw(20'000));
    options.batch_bytes_max = 200 + world_.draw(4'000);
    options.compress = world_.chance(0.3);
    options.welcome_timeout = 2s;
    options.ping_after = 1s;
    options.silence_max = 4s;
    protocol_.emplace(std::move(options), *buffer_, world_.now());
    backoff_.emplace(static_cast<std::uint32_t>(world_.draw(1'000)), robot::BackoffWaits{20ms, 1'000ms});
    handed_over_ = 0;
    connect();
    feed();
}

void Robot::start_again() {
    ++runs_;
    ++links_;
    drop_connection();
    protocol_.reset();
    const auto run = runs_;
    world_.after(world_.between(10ms, 3s), [this, run] {
        if (run == runs_) start();
    });
}

void Robot::crash() {
    if (done_ || !protocol_) return;
    world_.note("robot crashes");
    if (connection_) connection_->vanish(Side::kRobot);
    connection_.reset();
    start_again();
}

void Robot::connect() {
    connection_ = connect_();
    connected_ = world_.now();
    ++links_;
    if (!connection_) return lose({{Errc::kUnreachable, "no server listens"}, true});
    connection_->listen(Side::kRobot, {[this](std::string_view bytes) { hear(bytes); },
                                       [this] {
                                           lose({{Errc::kUnreachable, "the connection was lost"}, true});
                                       }});
    protocol_->open("server", world_.now());
    say();
}

void Robot::hear(std::string_view bytes) {
    const auto link = links_;
    std::ranges::copy(std::as_bytes(std::span(bytes)), protocol_->prepare(bytes.size()).begin());
    const auto failure = protocol_->on_bytes(bytes.size(), world_.now());
    if (buffer_->acknowledged() > standing_.acknowledged) {
        standing_.acknowledged = buffer_->acknowledged();
        backoff_->reset();
        world_.note(standing_.plan.name, standing_.acknowledged);
    }
    if (failure) return lose(*failure);
    if (link == links_) say();
}

void Robot::say() {
    if (!connection_) return;
    for (std::string frame; protocol_->append_next_frame(frame, world_.now()); frame.clear())
        connection_->send(Side::kRobot, frame);
    if (protocol_->said_goodbye()) { // all scans are acknowledged
        done_ = true;
        drop_connection();
        protocol_.reset();
        return;
    }
    watch();
}

/// Sends the recording's next scan as soon as there is space for it.
void Robot::feed() {
    if (protocol_->resumed_after()) {
        handed_over_ = std::max(handed_over_, *protocol_->resumed_after());
        if (handed_over_ < standing_.plan.scans && buffer_->has_room()) {
            buffer_->push({laser_, testing_support::random_scan(standing_.plan.seed, ++handed_over_)});
            protocol_->on_scans_added(1, world_.now());
            if (handed_over_ == standing_.plan.scans) protocol_->end();
            say();
        } else if (handed_over_ >= standing_.plan.scans) {
            protocol_->end();
            return say();
        }
    }
    while_running(world_.between(1ms, 150ms), &Robot::feed);
}

void Robot::watch() {
    if (!connection_) return;
    if (const auto failure = protocol_->check(world_.now())) return lose(*failure);
    const Time due = protocol_->deadline(world_.now());
    if (due >= watching_ && watching_ > world_.now()) return; // an earlier check is already scheduled
    watching_ = due;
    while_linked(due, &Robot::say);
}

void Robot::lose(const wire::LinkError& why) {
    world_.note(why.error.message);
    drop_connection();
    protocol_->close();
    if (why.retryable) return while_running(backoff_->next(), &Robot::connect);
    if (!explains_(hello_, why.error.code, connected_)) standing_.outcome = why.error;
    start_again();
}

void Robot::drop_connection() {
    if (connection_) connection_->close(Side::kRobot);
    connection_.reset();
    watching_ = Time::max();
    ++links_;
}

void Robot::while_running(Duration delay, void (Robot::*what)()) {
    world_.after(delay, [this, what, run = runs_] {
        if (run == runs_ && protocol_) (this->*what)();
    });
}

void Robot::while_linked(Time time, void (Robot::*what)()) {
    world_.at(time, [this, what, link = links_] {
        if (link == links_ && connection_) (this->*what)();
    });
}

} // namespace scanloom::simulation
