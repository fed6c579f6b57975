#include "tests/integration/server/programs_fixture.hpp"
#include "tests/support/postgres_server.hpp"

#include <boost/json/serialize.hpp>
#include <gmock/gmock.h>

#include <csignal>

/// `scanloom-server --copy` and a server with a store in a database, as users run them.
namespace scanloom::test {
namespace {

class CopyTest : public ProgramsTest {
protected:
    [[nodiscard]] int run(const std::vector<std::string>& arguments) const {
        ChildProcess copy(program("scanloom-server"), arguments, place_.path() / "said");
        while (copy.read_line()) {
        }
        return copy.wait();
    }

    static void stop(RunningServer& server) {
        server.process().signal(SIGTERM);
        EXPECT_EQ(server.process().wait(), 0);
    }

    PostgresServer postgres_;
};

TEST_F(CopyTest, MapsAreTheSameInADatabaseAndBack) {
    simulate("one", "0.1");
    const auto before = boost::json::serialize(layers("one"));
    stop(server_);
    const auto store = (place_.path() / "store").native();
    const auto back = (place_.path() / "back").native();
    const auto database = postgres_.new_database();
    ASSERT_EQ(run({"--copy", store, "--to", database}), 1) << "it is not replicated";
    ASSERT_EQ(run({"--copy", store, "--to", database, "--allow-unreplicated"}), 0);
    const std::vector<std::string> allowed{"--allow-unreplicated"};
    const auto digest = [](const RunningServer& server) {
        return boost::json::serialize(server.get_json("/api/v1/sessions/one/digest").at("layers"));
    };
    {
        RunningServer server(database, place_.path() / "log", 0, 0, allowed);
        EXPECT_EQ(digest(server), before);
        server.process().signal(SIGKILL);
        server.process().wait();
    }
    EXPECT_EQ(run({"--check=deep", "--store", database}), 0);
    ASSERT_EQ(run({"--copy", database, "--to", back}), 0);
    const RunningServer server(back, place_.path() / "log");
    EXPECT_EQ(digest(server), before);
}

} // namespace
} // namespace scanloom::test
