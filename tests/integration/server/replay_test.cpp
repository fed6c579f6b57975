#include "tests/integration/server/programs_fixture.hpp"

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>

#include <atomic>
#include <cstdint>
#include <future>

namespace scanloom::test {
namespace {

class ReplayOverHttp : public ProgramsTest {};

TEST_F(ReplayOverHttp, EqualsASessionCreatedWithTheSettings) {
    simulate("coarse", "0.1");
    simulate("fine", "0.05");
    EXPECT_EQ(layers("coarse", "?cell_size=0.05"), layers("fine"));
    EXPECT_EQ(layers("fine", "?cell_size=0.1"), layers("coarse"));
    EXPECT_NE(layers("fine"), layers("coarse"));
}

TEST_F(ReplayOverHttp, OfARealLogEqualsASessionCreatedWithTheSettings) {
    const auto intel = kRealData / "logs/intel-corrected.log.gz";
    if (!std::filesystem::exists(intel))
        GTEST_SKIP() << "the recorded data, which are no part of the project, are missing: " << intel;
    stream("intel", "0.05", {"replay", intel.string()});
    stream("coarse", "0.1", {"replay", intel.string()});
    EXPECT_EQ(layers("intel", "?cell_size=0.1"), layers("coarse"));
    EXPECT_EQ(layers("coarse", "?cell_size=0.05"), layers("intel"));
    EXPECT_EQ(layers("intel", "?cell_size=0.05"), layers("intel"));
}

TEST_F(ReplayOverHttp, ExtendsWithAStreamingSession) {
    std::atomic<bool> streamed = false;
    auto viewer = std::async(std::launch::async, [&] {
        std::int64_t seen = 0;
        while (!streamed) {
            const auto answer = server_.get("/api/v1/sessions/live/digest?cell_size=0.02");
            if (answer.status != 200) continue; // the robot has not connected yet
            const auto revision = boost::json::parse(answer.body).at("revision").to_number<std::int64_t>();
            EXPECT_GE(revision, seen);
            seen = revision;
        }
    });
    simulate("live", "0.05");
    streamed = true;
    viewer.get();
    simulate("fine", "0.02");
    EXPECT_EQ(layers("live", "?cell_size=0.02"), layers("fine"));
    EXPECT_EQ(server_.get_json("/api/v1/sessions/live/weave").at("weaves").as_array().size(), 0U)
        << "a GET with settings creates no listed replay job";
}

} // namespace
} // namespace scanloom::test
