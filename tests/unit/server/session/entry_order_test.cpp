#include "server/session/entry_order.hpp"

#include "server/mapping/projection.hpp"
#include "tests/support/random_scans.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom::session {
namespace {

using testing_support::random_scan;
using testing_support::small_laser;

/// Some of them cannot follow what came before.
LogEntry random_entry(std::mt19937& engine) {
    const auto random = [&] { return static_cast<unsigned>(engine()); };
    const RobotIndex robot = random() % 4;
    switch (random() % 8) {
    case 0: return RobotJoined{robot, std::string(1, static_cast<char>('a' + random() % 3)), random() % 2 ? "s" : ""};
    case 1: {
        Sensor sensor = small_laser();
        sensor.id = random() % 3;
        return SensorDescribed{robot, sensor};
    }
    case 2: return MapPatch{0.05, 0.0, 0.0, 1, {MapCell{}}};
    default: {
        Scan scan = random_scan(1, random() % 5 + 1);
        scan.sensor = random() % 3;
        return ScanTaken{robot, scan};
    }
    }
}

TEST(EntryOrder, RefusesWhatTheFoldRefusesInTheSameWords) {
    std::mt19937 random(1);
    int taken = 0;
    int refused = 0;
    for (int log = 0; log < 300; ++log) {
        mapping::Projection projection{mapping::MapConfig{}};
        EntryOrder order;
        for (int n = 0; n < 60; ++n) {
            const auto entry = random_entry(random);
            const auto folded = projection.fold(entry);
            const auto added = order.add(entry);
            ASSERT_EQ(added.has_value(), folded.has_value());
            ++(added ? taken : refused);
            if (!added) {
                ASSERT_EQ(added.error(), folded.error());
            }
            ASSERT_EQ(order.revision(), projection.revision());
        }
        const auto state = projection.state();
        ASSERT_EQ(order.robots().size(), state.robots.size());
        for (std::size_t n = 0; n < state.robots.size(); ++n) {
            EXPECT_EQ(order.robots()[n].name, state.robots[n].name);
            EXPECT_EQ(order.robots()[n].source, state.robots[n].source);
            EXPECT_EQ(order.robots()[n].last_seq, state.robots[n].last_seq);
            EXPECT_EQ(order.robots()[n].sensors.size(), state.robots[n].sensors.size());
        }
    }
    EXPECT_GT(taken, 1000);
    EXPECT_GT(refused, 1000);
}

TEST(EntryOrder, KnowsWhichExclusionsCanFollow) {
    EntryOrder order;
    EXPECT_FALSE(order.add(ScansExcluded{1, 0, SeqRange{1, 1}})) << "the robot never joined";
    ASSERT_TRUE(order.add(RobotJoined{0, "a", ""}));
    EXPECT_FALSE(order.add(ExclusionLifted{1}));
    ASSERT_TRUE(order.add(ScansExcluded{1, 0, SeqRange{1, 1}}));
    EXPECT_FALSE(order.add(ScansExcluded{1, 0, SeqRange{1, 1}})) << "ids rise";
    ASSERT_TRUE(order.add(ExclusionLifted{1}));
    EXPECT_FALSE(order.add(ExclusionLifted{1}));
    EXPECT_EQ(order.revision(), 3U);
    EXPECT_EQ(order.exclusions().revision(), 3U);
}

} // namespace
} // namespace scanloom::session
