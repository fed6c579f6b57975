#include "tests/fault/simulation/network.hpp"

#include <gtest/gtest.h>

namespace scanloom::simulation {
namespace {

using namespace std::chrono_literals;

/// Both ends of a connection, and the data that each received.
class Ends {
public:
    Ends(World& world, const NetworkTrouble& trouble) : connection_(Connection::make(world, trouble)) {
        for (const Side side : {Side::kRobot, Side::kServer}) {
            connection_->listen(side, {[this, side](std::string_view bytes) { heard(side) += bytes; }, {}});
        }
    }

    void both_say(const std::string& what) {
        connection_->send(Side::kRobot, what);
        connection_->send(Side::kServer, what);
    }
    [[nodiscard]] std::string& heard(Side side) { return side == Side::kRobot ? at_robot_ : at_server_; }

private:
    std::shared_ptr<Connection> connection_;
    std::string at_robot_;
    std::string at_server_;
};

void run(World& world, Time until) {
    world.at(until, [] {}); // so that the clock reaches that time
    while (world.step(until)) {
    }
}

TEST(SimulatedNetwork, DataSentDuringAPartitionArrivesAfterIt) {
    World world(1);
    const Time from = world.now() + 1s;
    const Time until = from + 10s;
    Ends ends(world, {.partitions = {{from, until}}});
    ends.both_say("before");
    run(world, from);
    EXPECT_EQ(ends.heard(Side::kServer), "before");
    ends.both_say(", during");
    run(world, until - 1ns);
    EXPECT_EQ(ends.heard(Side::kServer), "before");
    EXPECT_EQ(ends.heard(Side::kRobot), "before");
    run(world, until);
    EXPECT_EQ(ends.heard(Side::kServer), "before, during");
    EXPECT_EQ(ends.heard(Side::kRobot), "before, during");
}

TEST(SimulatedNetwork, ConnectingAcrossALongPartitionFails) {
    World world(1);
    const Time until = world.now() + 10s;
    const NetworkTrouble trouble{.partitions = {{world.now(), until}}};
    EXPECT_EQ(Connection::make(world, trouble), nullptr);
    run(world, until);
    EXPECT_NE(Connection::make(world, trouble), nullptr);
}

TEST(SimulatedNetwork, DeafLinkCarriesTheOtherDirection) {
    World world(1);
    int deaf_robots = 0;
    int deaf_servers = 0;
    for (int n = 0; n < 50; ++n) {
        Ends ends(world, {.deaf = 1.0});
        run(world, world.now() + 4s); // it has happened by then
        ends.both_say("late");
        run(world, world.now() + 1s);
        const bool robot_is_deaf = ends.heard(Side::kRobot).empty();
        const bool server_is_deaf = ends.heard(Side::kServer).empty();
        EXPECT_NE(robot_is_deaf, server_is_deaf);
        deaf_robots += robot_is_deaf ? 1 : 0;
        deaf_servers += server_is_deaf ? 1 : 0;
    }
    EXPECT_GT(deaf_robots, 0);
    EXPECT_GT(deaf_servers, 0);
}

} // namespace
} // namespace scanloom::simulation
