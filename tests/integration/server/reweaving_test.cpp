#include "tests/integration/server/programs_fixture.hpp"

namespace scanloom::test {
namespace {

class Reweaving : public ProgramsTest {};

TEST_F(Reweaving, GivesTheDigestsOfASessionCreatedWithTheSettings) {
    simulate("coarse", "0.1");
    simulate("fine", "0.05");
    EXPECT_EQ(layers("coarse", "?cell_size=0.05"), layers("fine"));
    EXPECT_EQ(layers("fine", "?cell_size=0.1"), layers("coarse"));
    EXPECT_NE(layers("fine"), layers("coarse"));
}

TEST_F(Reweaving, OfARealLogGivesThemToo) {
    const auto intel = kRealData / "logs/intel-corrected.log.gz";
    if (!std::filesystem::exists(intel)) GTEST_SKIP() << intel << " is not there";
    stream("intel", "0.05", {"replay", intel.string()});
    stream("coarse", "0.1", {"replay", intel.string()});
    EXPECT_EQ(layers("intel", "?cell_size=0.1"), layers("coarse"));
    EXPECT_EQ(layers("coarse", "?cell_size=0.05"), layers("intel"));
    EXPECT_EQ(layers("intel", "?cell_size=0.05"), layers("intel"));
}

} // namespace
} // namespace scanloom::test
