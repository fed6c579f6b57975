#include "tests/integration/server/programs_fixture.hpp"
#include "tests/support/store_files.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <gmock/gmock.h>

#include <csignal>

/// `scanloom-server --repair`, as users run it.
namespace scanloom::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

class RepairTest : public ProgramsTest {
protected:
    [[nodiscard]] std::filesystem::path store() const { return place_.path() / "store"; }
    [[nodiscard]] std::filesystem::path repaired() const { return place_.path() / "repaired"; }

    void kill_server() {
        server_.process().signal(SIGKILL);
        server_.process().wait();
    }

    struct Answer {
        int code = 0;
        std::string text;
        boost::json::object summary;
    };

    [[nodiscard]] Answer run(const std::vector<std::string>& arguments) const {
        ChildProcess program_run(program("scanloom-server"), arguments, place_.path() / "said");
        Answer answer;
        std::string last;
        while (const auto line = program_run.read_line()) answer.text += (last = *line) + "\n";
        answer.code = program_run.wait();
        if (last.starts_with("{")) answer.summary = boost::json::parse(last).as_object();
        return answer;
    }

    [[nodiscard]] Answer repair() const { return run({"--repair", repaired().native(), "--store", store().native()}); }
};

TEST_F(RepairTest, AnIntactStoreKeepsItsMaps) {
    simulate("one", "0.1");
    const auto before = boost::json::serialize(layers("one"));
    kill_server();
    const auto answer = repair();
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_THAT(answer.text, HasSubstr("one: 302 entries kept\n"));
    EXPECT_EQ(answer.summary.at("event"), "repaired");
    EXPECT_EQ(answer.summary.at("lost").to_number<int>(), 0);
    EXPECT_THAT(answer.text, ContainsRegex("\"seconds\":[0-9.]+\\}\n$"));
    const RunningServer server(repaired(), place_.path() / "log");
    const auto after = server.get_json("/api/v1/sessions/one/digest").at("layers");
    EXPECT_EQ(boost::json::serialize(after), before);
    EXPECT_EQ(repair().code, 1) << "the target is not empty";
}

TEST_F(RepairTest, LossesOfADamagedStoreAreReportedAndTheRobotContinues) {
    simulate("one", "0.1", "15"); // so that other writes follow the damaged one
    kill_server();
    const auto log = store::only_file_like(store(), ".log");
    store::flip_bit(log, std::filesystem::file_size(log) / 2, 1);
    EXPECT_EQ(run({"--check", "--store", store().native()}).code, 1);
    const auto answer = repair();
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_EQ(answer.summary.at("damaged_files").to_number<int>(), 1);
    EXPECT_GT(answer.summary.at("lost").to_number<int>(), 0);
    EXPECT_EQ(answer.summary.at("lost"), answer.summary.at("stood_in")) << "all lost entries are scans";
    EXPECT_EQ(answer.summary.at("kept").to_number<int>() + answer.summary.at("lost").to_number<int>(), 302);
    EXPECT_EQ(run({"--check=deep", "--store", repaired().native()}).code, 0);
    const RunningServer server(repaired(), place_.path() / "log");
    const auto session = server.get_json("/api/v1/sessions/one");
    EXPECT_EQ(session.at("robots").at(0).at("last_seq").to_number<int>(), 300) << boost::json::serialize(session);
}

TEST_F(RepairTest, ALogWithoutItsRobotEntryIsSetAside) {
    simulate("one", "0.1");
    kill_server();
    const auto log = store::only_file_like(store(), ".log");
    const auto joined = store::bytes_of(log).find("simulation:"); // its source
    ASSERT_NE(joined, std::string::npos);
    store::flip_bit(log, joined, 0);
    const auto answer = repair();
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_EQ(answer.summary.at("kept").to_number<int>(), 0);
    EXPECT_GE(answer.summary.at("set_aside").to_number<int>(), 300);
    EXPECT_GT(std::filesystem::file_size(place_.path() / "repaired.lost" / "one.scanlog"), 300U * 100U);
}

TEST_F(RepairTest, LossesOfTheCreationAreReported) {
    const auto made = http_request(server_.http_port(), "POST", "/api/v1/sessions",
                                   R"({"name": "one", "cell_size": 0.1, "localize_only": true})");
    ASSERT_EQ(made.status, 201U) << made.body;
    simulate("one", "0.1");
    kill_server();
    const auto log = store::only_file_like(store(), ".log");
    const auto mode = store::bytes_of(log).find("\x4a\x02\x08\x01"); // LogEntry.mode_changed
    ASSERT_NE(mode, std::string::npos);
    store::flip_bit(log, mode, 0);
    const auto answer = repair();
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_THAT(answer.text, HasSubstr("1 lost, 1 of the lost ones from its creation"));
    EXPECT_EQ(run({"--check=deep", "--store", repaired().native()}).code, 0);
    const RunningServer server(repaired(), place_.path() / "log");
    EXPECT_EQ(server.get_json("/api/v1/sessions/one").at("localize_only"), true) << "its scans say so";
}

TEST_F(RepairTest, AKilledRepairLeavesNoStoreAndCanBeRepeated) {
    for (const auto* name : {"one", "two", "three", "four"}) simulate(name, "0.1");
    kill_server();
    for (int lines = 0; lines < 5; ++lines) {
        {
            ChildProcess killed(program("scanloom-server"),
                                {"--repair", repaired().native(), "--store", store().native()}, place_.path() / "said");
            for (int n = 0; n < lines; ++n) static_cast<void>(killed.read_line());
            killed.signal(SIGKILL);
            killed.wait();
        }
        const auto check = run({"--check", "--store", repaired().native()});
        if (check.code == 0) { // the repair had finished
            EXPECT_EQ(check.summary.at("sessions").to_number<int>(), 4);
            std::filesystem::remove_all(repaired());
        } else {
            EXPECT_EQ(check.text.find("whole"), std::string::npos) << check.text;
        }
    }
    const auto answer = repair();
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_EQ(answer.summary.at("sessions").to_number<int>(), 4);
    EXPECT_EQ(run({"--check", "--store", repaired().native()}).code, 0);
}

TEST_F(RepairTest, ATargetInsideOrAroundTheOldStoreIsRefused) {
    for (const auto& into : {store(), store() / "in", place_.path()}) {
        EXPECT_EQ(run({"--repair", into.native(), "--store", store().native()}).code, 2) << into;
    }
    EXPECT_FALSE(std::filesystem::exists(store() / "in"));
}

} // namespace
} // namespace scanloom::test
