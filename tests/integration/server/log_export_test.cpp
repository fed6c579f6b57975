#include "tests/integration/server/programs_fixture.hpp"

namespace scanloom::test {
namespace {

class LogExport : public ProgramsTest {};

TEST_F(LogExport, OfASimulatedRunReplaysToTheSameMaps) {
    simulate("first", "0.05");
    const auto log = save("/api/v1/sessions/first/log?format=clf", "first.clf");
    stream("again", "0.05", {"replay", log.string()});
    EXPECT_EQ(layers("again"), layers("first"));
}

TEST_F(LogExport, OfARealLogReplaysToTheSameMaps) {
    const auto intel = kRealData / "logs/intel-corrected.log.gz";
    if (!std::filesystem::exists(intel))
        GTEST_SKIP() << "the recorded data, which are no part of the project, are missing: " << intel;
    stream("intel", "0.1", {"replay", intel.string()});
    const auto log = save("/api/v1/sessions/intel/log?format=clf", "intel.clf");
    stream("again", "0.1", {"replay", log.string()});
    EXPECT_EQ(layers("again"), layers("intel"));
}

} // namespace
} // namespace scanloom::test
