#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <exception>
#include <filesystem>
#include <thread>
#include <vector>

/// Backups of a server while a robot streams, and stores restored from them, with the commands for users.
namespace scanloom::test {
namespace {

using testing::HasSubstr;

class BackupTest : public testing::Test {
protected:
    static constexpr const char* kSession = "/api/v1/sessions/one";

    HttpAnswer make(const RunningServer& server) const {
        return http_request(server.http_port(), "POST", "/api/v1/backups", "{}");
    }

    /// @param said  its last line
    int restore(const std::string& id, const std::filesystem::path& store, std::string* said = nullptr) const {
        ChildProcess restorer(program("scanloom-server"),
                              {"--restore", id, "--backups", backups_.native(), "--store", store.native()},
                              place_.path() / "restorer");
        while (const auto line = restorer.read_line()) {
            if (said != nullptr) *said = *line;
        }
        return restorer.wait();
    }

    static std::int64_t revision(const RunningServer& server) {
        return server.get_json(kSession).at("revision").to_number<std::int64_t>();
    }

    /// The digests of all layers at an entry of the log.
    static std::string digests(const RunningServer& server, std::int64_t until) {
        const auto query = std::string(kSession) + "/digest?until=" + std::to_string(until);
        return boost::json::serialize(server.get_json(query).at("layers"));
    }

    void expect_that_backups_survive_kills(int rounds);

    TemporaryDirectory place_;
    int newest_ = 0; // number of the newest backup
    std::filesystem::path store_ = place_.path() / "store";
    std::filesystem::path backups_ = place_.path() / "backups";
};

TEST_F(BackupTest, ContainsEveryScanAcknowledgedBeforeItAndTheMapsOfThatLog) {
    RunningServer server(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native(), "--backups-kept", "2"});
    ChildProcess robot(program("scanloom-robot"),
                       {"--server", server.robot_address(), "--session", "one", "--robot", "r", "--cell-size", "0.1",
                        "simulate", "--world", "office", "--seed", "5", "--speed", "20", "--noise", "gaussian"},
                       place_.path() / "robot");
    const auto has_scans = [&] { return server.get(kSession).status == 200 && revision(server) > 20; };
    while (!has_scans()) {
    }
    const auto acknowledged = revision(server);
    const auto made = make(server);
    ASSERT_EQ(made.status, 201U) << made.body;
    robot.signal(SIGTERM);
    robot.wait();

    ASSERT_EQ(restore("newest", place_.path() / "restored"), 0);
    RunningServer restored(place_.path() / "restored", place_.path() / "log");
    const auto kept = revision(restored);
    EXPECT_GE(kept, acknowledged);
    EXPECT_LE(kept, revision(server));
    EXPECT_EQ(digests(restored, kept), digests(server, kept));
}

TEST_F(BackupTest, StoreAndBackupsAreReadableByTheirOwnerOnly) {
    namespace fs = std::filesystem;
    RunningServer server(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native()});
    ASSERT_EQ(make(server).status, 201U);
    for (const auto& top : {store_, backups_}) {
        std::vector<fs::path> paths{top};
        for (const auto& entry : fs::recursive_directory_iterator(top)) paths.push_back(entry.path());
        for (const auto& path : paths) {
            const auto others = fs::status(path).permissions() & (fs::perms::group_all | fs::perms::others_all);
            EXPECT_EQ(others, fs::perms::none) << path;
        }
    }
}

TEST_F(BackupTest, AreListedAndOldOnesAreRemoved) {
    RunningServer server(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native(), "--backups-kept", "2"});
    EXPECT_EQ(server.get_json("/api/v1/backups").at("backups").as_array().size(), 0U);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(make(server).status, 201U);
    const auto listed = server.get_json("/api/v1/backups");
    ASSERT_EQ(listed.at("backups").as_array().size(), 2U);
    EXPECT_EQ(listed.at("backups").at(0).at("id").to_number<int>(), 2);
    EXPECT_EQ(listed.at("kept").to_number<int>(), 2);
    EXPECT_EQ(restore("1", place_.path() / "restored"), 1) << "the backup was removed";
    EXPECT_EQ(restore("2", place_.path() / "restored"), 0);
    EXPECT_EQ(restore("3", place_.path() / "restored"), 1) << "the target has a store now";
    EXPECT_EQ(restore("x", place_.path() / "other"), 2);
}

TEST_F(BackupTest, RestoreReportsTheListedDescription) {
    const RunningServer server(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native()});
    const auto made = make(server).body; // {"id":1,...
    std::string said;
    ASSERT_EQ(restore("newest", place_.path() / "restored", &said), 0);
    EXPECT_EQ(said, R"({"event":"restored",)" + made.substr(1));
}

void BackupTest::expect_that_backups_survive_kills(int rounds) {
    for (int round = 1; round <= rounds; ++round) {
        RunningServer server(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native()});
        ChildProcess robot(program("scanloom-robot"),
                           {"--server", server.robot_address(), "--session", "one", "--robot", std::to_string(round),
                            "--cell-size", "0.1", "simulate", "--world", "office", "--seed", "5", "--speed", "20"},
                           place_.path() / "robot");
        while (server.get(kSession).status != 200) {
        }
        std::atomic<bool> answered = false;
        std::thread asking([&] {
            try {
                static_cast<void>(make(server));
            } catch (const std::exception&) { // the server was killed
            }
            answered = true;
        });
        const auto being_made = backups_ / "private" / std::to_string(newest_ + 1);
        while (!answered && !std::filesystem::exists(being_made)) {
        }
        server.process().signal(SIGKILL);
        server.process().wait();
        asking.join();
        robot.signal(SIGKILL);
        robot.wait();

        const RunningServer next(store_, place_.path() / "log", 0, 0, {"--backups", backups_.native()});
        EXPECT_EQ(make(next).status, 201U);
        const auto listed = next.get_json("/api/v1/backups");
        for (const auto& backup : listed.at("backups").as_array()) {
            const auto id = std::to_string(newest_ = backup.at("id").to_number<int>());
            std::filesystem::remove_all(place_.path() / "restored");
            ASSERT_EQ(restore(id, place_.path() / "restored"), 0) << id;
            const RunningServer restored(place_.path() / "restored", place_.path() / "log");
            EXPECT_EQ(restored.get(kSession).status, 200U) << id;
        }
    }
}

TEST_F(BackupTest, AServerKilledDuringABackupContinuesAndAllListedBackupsRestore) {
    expect_that_backups_survive_kills(2);
}

class BackupTrials : public BackupTest {};

TEST_F(BackupTrials, AServerKilledDuringABackupContinuesAndAllListedBackupsRestore) {
    expect_that_backups_survive_kills(6);
}

TEST_F(BackupTest, AServerWithoutBackupsReportsIt) {
    const RunningServer server(store_, place_.path() / "log");
    for (const auto& answer : {make(server), server.get("/api/v1/backups")}) {
        EXPECT_EQ(answer.status, 404U);
        EXPECT_THAT(answer.body, HasSubstr("--backups DIR"));
    }
}

} // namespace
} // namespace scanloom::test
