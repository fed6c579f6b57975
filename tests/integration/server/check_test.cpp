#include "tests/integration/server/programs_fixture.hpp"
#include "tests/support/store_files.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>

/// `scanloom-server --check`, as users run it.
namespace scanloom::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

class CheckTest : public ProgramsTest {
protected:
    struct Answer {
        int code = 0;
        std::string text; ///< the whole output
        boost::json::object summary;
    };

    Answer check(const std::string& flag = "--check") {
        ChildProcess checker(program("scanloom-server"), {flag, "--store", (place_.path() / "store").native()},
                             place_.path() / "checker");
        Answer answer;
        std::string last;
        while (const auto line = checker.read_line()) answer.text += (last = *line) + "\n";
        answer.code = checker.wait();
        if (last.starts_with("{")) answer.summary = boost::json::parse(last).as_object();
        return answer;
    }

    void kill_server() {
        server_.process().signal(SIGKILL);
        server_.process().wait();
    }
};

TEST_F(CheckTest, AKilledStorePassesAndADamagedTableIsReportedWithSessionAndReason) {
    simulate("one", "0.1");
    simulate("two", "0.1");
    EXPECT_EQ(check().code, 1) << "a server uses the store";
    kill_server();
    for (const auto* flag : {"--check", "--check=deep"}) {
        const auto whole = check(flag);
        EXPECT_EQ(whole.code, 0) << whole.text;
        EXPECT_THAT(whole.text, AllOf(HasSubstr("one: 302 entries, whole\n"), HasSubstr("two: 302 entries, whole\n")));
        EXPECT_EQ(whole.summary.at("event"), "checked");
        EXPECT_EQ(whole.summary.at("sessions").to_number<int>(), 2);
        EXPECT_EQ(whole.summary.at("entries").to_number<int>(), 604);
        EXPECT_TRUE(whole.summary.at("damaged").as_array().empty());
        EXPECT_THAT(whole.text, ContainsRegex("\"seconds\":[0-9.]+\\}\n$"));
    }
    {
        RunningServer again(place_.path() / "store", place_.path() / "log"); // moves its contents into tables
        again.process().signal(SIGTERM);
        again.process().wait();
    }
    const auto tables = store::files_like(place_.path() / "store", ".sst");
    const auto largest = *std::max_element(tables.begin(), tables.end(), [](const auto& a, const auto& b) {
        return std::filesystem::file_size(a) < std::filesystem::file_size(b);
    });
    store::flip_bit(largest, std::filesystem::file_size(largest) / 2, 1);
    const auto damaged = check();
    EXPECT_EQ(damaged.code, 1);
    ASSERT_FALSE(damaged.summary.at("damaged").as_array().empty()) << damaged.text;
    const auto& session = damaged.summary.at("damaged").as_array()[0];
    EXPECT_THAT(std::string(session.at("reason").as_string()), HasSubstr(largest.filename().native()));
    EXPECT_THAT(damaged.text, HasSubstr("DAMAGED"));
}

TEST_F(CheckTest, ADamagedWriteAheadLogIsReported) {
    simulate("one", "0.1");
    kill_server();
    store::flip_bit(store::only_file_like(place_.path() / "store", ".log"), 100, 1);
    const auto damaged = check();
    EXPECT_EQ(damaged.code, 1);
    EXPECT_THAT(damaged.text, StartsWith("DAMAGED: "));
    EXPECT_THAT(std::string(damaged.summary.at("damaged").at(0).at("reason").as_string()), HasSubstr(".log"));
}

} // namespace
} // namespace scanloom::test
