#include "tests/support/postgres_server.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/serialize.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>

/// Several servers that share a database, as users run them.
namespace scanloom::test {
namespace {

using testing::HasSubstr;

class NodesTest : public testing::Test {
protected:
    [[nodiscard]] std::unique_ptr<RunningServer> start(const std::string& node) const {
        return std::make_unique<RunningServer>(
            database_, place_.path() / node, 0, 0,
            std::vector<std::string>{"--allow-unreplicated", "--node", node, "--log-level", "warn"});
    }

    /// @param scans  of the whole simulation; those that the servers have already are not sent again
    void simulate(const std::string& servers, const std::string& scans) const {
        ChildProcess robot(program("scanloom-robot"),
                           {"--server", servers, "--session", "one", "--robot", "r", "--give-up-after", "20",
                            "simulate", "--world", "office", "--seed", "5", "--speed", "0", "--scans", scans},
                           place_.path() / "robot");
        static_cast<void>(robot.read_line());
        ASSERT_EQ(robot.wait(), 0);
    }

    static void end(RunningServer& server, int signal) {
        server.process().signal(signal);
        static_cast<void>(server.process().wait());
    }

    static std::string digest(const RunningServer& server) {
        return boost::json::serialize(server.get_json("/api/v1/sessions/one/digest").at("layers"));
    }

    TemporaryDirectory place_;
    PostgresServer postgres_;
    const std::string database_ = postgres_.new_database();
};

TEST_F(NodesTest, ASessionGoesOnAnotherServerWhenItsOwnHasEnded) {
    auto a = start("a");
    const auto b = start("b");
    simulate(a->robot_address(), "300");
    const auto before = digest(*a);
    const auto refused = b->get("/api/v1/sessions/one/digest");
    EXPECT_EQ(refused.status, 503U);
    EXPECT_THAT(refused.body, HasSubstr("belongs to node a at http://127.0.0.1:" + std::to_string(a->http_port())));
    auto node = [&] { return b->get_json("/api/v1/nodes").at("nodes").at(0); };
    EXPECT_EQ(node().at("name"), "a");
    while (node().at("sessions") != 1) { // it knows it a second later
    }
    EXPECT_EQ(b->get_json("/api/v1/sessions").at("sessions").at(0).at("node"), "a");
    end(*a, SIGTERM);
    EXPECT_EQ(digest(*b), before);

    end(*b, SIGKILL);
    const auto again = start("b"); // at once, because it has the name of the dead one
    EXPECT_EQ(digest(*again), before);
}

TEST_F(NodesTest, RobotsFindTheServerThatHasTheirSession) {
    const auto a = start("a");
    auto b = start("b");
    simulate(a->robot_address(), "200");
    simulate(b->robot_address(), "300"); // b names a
    const auto whole = digest(*a);
    end(*a, SIGKILL);
    const auto c = start("a");
    end(*c, SIGTERM);
    simulate(a->robot_address() + "," + c->robot_address() + "," + b->robot_address(), "300");
    EXPECT_EQ(digest(*b), whole) << "all scans are there once";
}

} // namespace
} // namespace scanloom::test
