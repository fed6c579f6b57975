#include "tests/support/running_server.hpp"
#include "tests/support/store_files.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

/// A server that detects, while it runs, that an unused session in its store is damaged.
namespace scanloom::test {
namespace {

using testing::HasSubstr;

class BackgroundCheckTest : public testing::Test {
protected:
    [[nodiscard]] std::filesystem::path store() const { return place_.path() / "store"; }

    /// Starts the server, passes it to `use`, and stops it.
    template <class Use>
    void with_server(Use&& use) {
        RunningServer server(store(), place_.path() / "log");
        use(server);
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().wait(), 0);
    }

    /// The middle of the largest table, which contains entries of the log.
    void damage_a_table() {
        const auto tables = store::files_like(store(), ".sst");
        const auto table = *std::max_element(tables.begin(), tables.end(), [](const auto& a, const auto& b) {
            return std::filesystem::file_size(a) < std::filesystem::file_size(b);
        });
        store::flip_bit(table, std::filesystem::file_size(table) / 2, 1);
    }

    TemporaryDirectory place_;
};

TEST_F(BackgroundCheckTest, ReportsDamageInReadinessAndMetricsAndStaysReady) {
    with_server([&](const RunningServer& server) {
        ChildProcess robot(program("scanloom-robot"),
                           {"--server", server.robot_address(), "--session", "one", "--robot", "r", "--cell-size",
                            "0.2", "simulate", "--world", "office", "--seed", "5", "--speed", "0", "--scans", "600"},
                           place_.path() / "robot");
        while (robot.read_line()) {
        }
        ASSERT_EQ(robot.wait(), 0);
    });
    with_server([](const RunningServer&) {}); // moves the write-ahead log into a table
    damage_a_table();
    with_server([](const RunningServer& server) {
        while (server.get_json("/readyz").at("damaged").as_array().empty()) { // answers 200 meanwhile
        }
        const auto damaged = server.get_json("/readyz").at("damaged");
        ASSERT_EQ(damaged.as_array().size(), 1U);
        EXPECT_EQ(damaged.at(0).at("name"), "one");
        while (server.get("/metrics").body.find("scanloom_sessions_checked_total 1\n") == std::string::npos) {
        } // counted after the damage is known
        EXPECT_THAT(server.get("/metrics").body, HasSubstr("scanloom_sessions_damaged 1\n"));
        const auto session = server.get_json("/api/v1/sessions/one"); // its checkpoint is still served
        EXPECT_EQ(session.at("state"), "ok");
        EXPECT_EQ(session.at("damage"), damaged.at(0).at("reason"));
        EXPECT_EQ(server.get_json("/api/v1/sessions").at("sessions").at(0).at("damage"), session.at("damage"));
        const auto answer = server.get("/api/v1/sessions/one/digest?until=599"); // reads the log
        EXPECT_EQ(answer.status, 500U) << "a retry does not help: " << answer.body;
        EXPECT_THAT(answer.body, HasSubstr("--repair"));
    });
    EXPECT_THAT(store::bytes_of(place_.path() / "log"), HasSubstr("session 'one' is damaged: "));
}

} // namespace
} // namespace scanloom::test
