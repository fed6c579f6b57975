#include "tests/support/class_oracle.hpp"

#include "core/mapping/projection.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/restored.hpp"
#include "tests/support/room_scans.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>
#include <vector>

/// Compares the classes of maps with their definition after every scan, because classes depend on the order of scans.
namespace scanloom::mapping {
namespace {

using classify::CellClass;
using classify::OccType;
using testing_support::class_at;

/// Returns scans along a walk through a room. Some scans in between contradict it, so that cells change their class.
std::vector<LogEntry> contradictory_walk(std::size_t scans) {
    std::vector<LogEntry> log{RobotJoined{0, "r"}, SensorDescribed{0, testing_support::reference_laser()},
                              SensorDescribed{0, testing_support::small_laser()}};
    std::uint64_t seq = 0;
    for (const Scan& of_room : testing_support::room_scans(scans)) {
        Scan scan = ++seq % 3 == 0 ? testing_support::random_scan(5, seq) : of_room;
        if (seq % 5 == 1) scan.ranges.assign(scan.ranges.size(), 700 + 20 * static_cast<RangeMm>(seq));
        scan.seq = seq;
        log.push_back(ScanTaken{0, std::move(scan)});
    }
    return log;
}

/// Compares the class of every cell and of its neighbours with the definition. `counts` counts cells per class.
void expect_defined_classes(const oracle::OccTypes& types, const Snapshot& snapshot, std::map<CellClass, int>& counts) {
    const std::int32_t reach = danger_reach(snapshot.config);
    std::size_t wrong = 0;
    types.plane().for_each(3, [&](grid::Cell cell, OccType) {
        const CellClass expected = oracle::class_of(types.plane(), cell, reach);
        ++counts[expected];
        if (class_at(snapshot, cell) == expected || ++wrong > 5) return;
        ADD_FAILURE() << "cell " << cell.i << ", " << cell.j << " is " << static_cast<int>(class_at(snapshot, cell))
                      << ", not " << static_cast<int>(expected) << ", after entry " << snapshot.revision;
    });
    snapshot.classes.visit({}, 0, [&](grid::ChunkKey key, const classify::ClassChunk& chunk) {
        for (std::int32_t n = 0; n < 4096; ++n) {
            const grid::Cell cell{64 * key.ci + n % 64, 64 * key.cj + n / 64};
            const CellClass shown = chunk.cells[static_cast<std::size_t>(n)];
            if (shown != CellClass::kUnexplored && shown != oracle::class_of(types.plane(), cell, reach)) ++wrong;
        }
    });
    ASSERT_EQ(wrong, 0U);
}

class ClassesFrom : public testing::TestWithParam<std::pair<const std::string, SessionOptions>> {
protected:
    [[nodiscard]] static MapConfig config() { return resolve(GetParam().second).value(); }
};

const std::map<std::string, SessionOptions> kClassSources = {
    {"Occupancy", {.cell_size = 0.1}},
    {"Himm", {.cell_size = 0.1, .class_source = ClassSource::kHimm}},
    {"HimmOfOtherStepsAndThresholds",
     {.cell_size = 0.2,
      .himm_increment = 5,
      .himm_decrement = 2,
      .class_source = ClassSource::kHimm,
      .class_himm_occupied = 11,
      .class_himm_free = 2}},
    {"WeakEvidenceAndWideDeadBand",
     {.cell_size = 0.1, .p_occupied = 0.6, .p_free = 0.45, .class_p_occupied = 0.8, .class_p_free = 0.2}},
    {"ThresholdsThatOneScanReachesExactly",
     {.cell_size = 0.1, .p_occupied = 0.8, .p_free = 0.3, .class_p_occupied = 0.8, .class_p_free = 0.3}},
    {"BothThresholdsAboveThePrior", {.cell_size = 0.1, .class_p_occupied = 0.9, .class_p_free = 0.6}},
    {"PriorAboveAHalf", {.cell_size = 0.1, .p_prior = 0.7}},
    {"RaysAndOneDangerCell",
     {.cell_size = 0.1, .ray_model = RayModel::kBresenham, .accumulate = true, .danger_cells = 1}},
    {"ALargeDangerRadius", {.cell_size = 0.25, .ray_model = RayModel::kTraversal, .danger_radius = 1.6}},
};

INSTANTIATE_TEST_SUITE_P(Classification, ClassesFrom, testing::ValuesIn(kClassSources),
                         [](const auto& tried) { return tried.param.first; });

TEST_P(ClassesFrom, MatchTheDefinitionAfterEveryScan) {
    Projection projection{config()};
    oracle::OccTypes types{config()};
    std::map<CellClass, int> counts;
    const auto log = contradictory_walk(45);
    for (const auto& entry : log) {
        ASSERT_TRUE(projection.apply(entry));
        const auto snapshot = projection.snapshot();
        types.apply(snapshot);
        if (snapshot.revision % 9 != 0 && snapshot.revision != log.size()) continue;
        ASSERT_NO_FATAL_FAILURE(expect_defined_classes(types, snapshot, counts));
    }
    for (int value = 0; value <= 4; ++value) EXPECT_GT(counts[static_cast<CellClass>(value)], 5) << "class " << value;
    EXPECT_GT(types.changes(), 1000U) << "too few cells changed their class";
}

/// Returns the class of every cell of all chunks.
std::map<std::pair<int, int>, CellClass> classes_of(const Snapshot& snapshot) {
    std::map<std::pair<int, int>, CellClass> classes;
    snapshot.classes.visit({}, 0, [&](grid::ChunkKey key, const classify::ClassChunk& chunk) {
        for (int n = 0; n < 4096; ++n) {
            if (chunk.cells[static_cast<std::size_t>(n)] == CellClass::kUnexplored) continue;
            classes[{64 * key.ci + n % 64, 64 * key.cj + n / 64}] = chunk.cells[static_cast<std::size_t>(n)];
        }
    });
    return classes;
}

TEST_P(ClassesFrom, AreIndependentOfBatching) {
    const auto log = contradictory_walk(45);
    Projection at_the_end_only{config()};
    for (const auto& entry : log) ASSERT_TRUE(at_the_end_only.apply(entry));
    const auto expected = classes_of(at_the_end_only.snapshot());
    ASSERT_GT(expected.size(), 2000U);

    for (const unsigned seed : {1U, 2U}) {
        std::mt19937 random(seed);
        Projection projection{config()};
        for (const auto& entry : log) {
            for (bool in = false; !in;) {
                double work = seed == 1 ? 1e9 : 500.0 + static_cast<double>(random() % 5000);
                in = projection.apply(entry, work).value();
            }
            if (random() % 4 == 0) (void)projection.snapshot();
        }
        EXPECT_EQ(classes_of(projection.snapshot()), expected);
    }
}

TEST_P(ClassesFrom, AreUnchangedByACheckpointBetweenScans) {
    const auto log = contradictory_walk(45);
    Projection whole{config()};
    for (const auto& entry : log) ASSERT_TRUE(whole.apply(entry));
    const auto expected = classes_of(whole.snapshot());

    for (const std::size_t cut : {5U, 20U, 40U}) {
        Projection first{config()};
        for (std::size_t n = 0; n < cut; ++n) ASSERT_TRUE(first.apply(log[n]));
        Projection second = testing_support::restored(first);
        EXPECT_EQ(classes_of(second.snapshot()), classes_of(first.snapshot())) << "checkpoint after entry " << cut;
        for (std::size_t n = cut; n < log.size(); ++n) ASSERT_TRUE(second.apply(log[n]));
        EXPECT_EQ(classes_of(second.snapshot()), expected) << "checkpoint after entry " << cut;
    }
}

/// Readings of one beam along +x from the centre of cell (0, 0), with a cell size of 0.1 m. The watched cell is 1 m
/// away.
class OneBeam {
public:
    explicit OneBeam(const SessionOptions& options) : projection_(resolve(options).value()) {
        Sensor beam;
        beam.angles = UniformAngles{0.0, 1.0, 1};
        beam.range_max = 5.0;
        EXPECT_TRUE(projection_.apply(RobotJoined{0, "r"}));
        EXPECT_TRUE(projection_.apply(SensorDescribed{0, beam}));
    }

    void hit() { read(1000); }
    void pass() { read(3000); }

    /// Returns the watched cell's type, whether or not obstacles are near.
    [[nodiscard]] OccType watched() {
        switch (class_at(projection_.snapshot(), {10, 0})) {
        case CellClass::kFree:
        case CellClass::kDanger: return OccType::kFree;
        case CellClass::kOccupied: return OccType::kOccupied;
        default: return OccType::kUnexplored;
        }
    }
    [[nodiscard]] double probability() {
        return probability_of(testing_support::occupancy_at(projection_.snapshot(), {10, 0}));
    }

private:
    void read(RangeMm range) {
        Scan scan{.seq = ++seq_, .pose = Pose2{0.05, 0.05, 0.0}, .ranges = {range}};
        EXPECT_TRUE(projection_.apply(ScanTaken{0, scan}));
    }

    Projection projection_;
    std::uint64_t seq_ = 0;
};

TEST(Classification, OscillationAroundOneThresholdKeepsTheType) {
    // The log-odds change by 0.663 per hit and by -0.201 per pass; the thresholds are +-0.619.
    OneBeam near_occupied({.cell_size = 0.1, .p_occupied = 0.66, .p_free = 0.45});
    near_occupied.hit();
    int beyond = 0;
    for (int n = 0; n < 200; ++n) {
        const double p = near_occupied.probability();
        EXPECT_EQ(near_occupied.watched(), OccType::kOccupied) << "after " << n << ", p " << p;
        beyond += p < 0.65;
        p < 0.65 ? near_occupied.hit() : near_occupied.pass();
        while (near_occupied.probability() > 0.7) near_occupied.pass();
    }
    EXPECT_GT(beyond, 40) << "the value must cross the threshold repeatedly";

    OneBeam near_free({.cell_size = 0.1, .p_occupied = 0.55, .p_free = 0.34});
    near_free.pass();
    beyond = 0;
    for (int n = 0; n < 200; ++n) {
        const double p = near_free.probability();
        EXPECT_EQ(near_free.watched(), OccType::kFree) << "after " << n << ", p " << p;
        beyond += p > 0.35;
        p > 0.35 ? near_free.pass() : near_free.hit();
        while (near_free.probability() < 0.3) near_free.hit();
    }
    EXPECT_GT(beyond, 40);
}

TEST(Classification, HimmTypeChangesOnlyAtTheOppositeThreshold) {
    OneBeam beam({.cell_size = 0.1, .class_source = ClassSource::kHimm});
    const auto expect_after = [&](bool is_hit, OccType expected, const char* count) {
        is_hit ? beam.hit() : beam.pass();
        EXPECT_EQ(beam.watched(), expected) << "at count " << count;
    };
    expect_after(true, OccType::kUnexplored, "3");
    for (const char* count : {"2", "1"}) expect_after(false, OccType::kUnexplored, count);
    expect_after(false, OccType::kFree, "0");
    for (const char* count : {"3", "6"}) expect_after(true, OccType::kFree, count);
    expect_after(true, OccType::kOccupied, "9");
    for (const char* count : {"8", "7", "6", "5"}) expect_after(false, OccType::kOccupied, count);
    expect_after(true, OccType::kOccupied, "8");
    for (const char* count : {"7", "6", "5"}) expect_after(false, OccType::kOccupied, count);
    expect_after(false, OccType::kFree, "4");
}

TEST(Classification, CellInTheDeadBandStaysUnexplored) {
    OneBeam beam({.cell_size = 0.1, .p_occupied = 0.6, .p_free = 0.4});
    beam.hit(); // 0.6
    EXPECT_EQ(beam.watched(), OccType::kUnexplored) << beam.probability();
    beam.pass(); // 0.5
    EXPECT_EQ(beam.watched(), OccType::kUnexplored) << "known, but inside the dead band";
    beam.hit();
    beam.hit(); // 0.69
    EXPECT_EQ(beam.watched(), OccType::kOccupied);
}

TEST(Classification, ValueEqualToTheThresholdReachesIt) {
    for (const double p : {0.55, 0.65, 0.7, 0.8, 0.85, 0.9, 0.97, 0.999}) {
        OneBeam beam(
            {.cell_size = 0.1, .p_occupied = p, .p_free = 1.0 - p, .class_p_occupied = p, .class_p_free = 1 - p});
        beam.hit();
        EXPECT_EQ(beam.watched(), OccType::kOccupied) << p;
        beam.pass();
        EXPECT_EQ(beam.watched(), OccType::kOccupied) << p << ": back at a probability of 0.5";
        beam.pass();
        EXPECT_EQ(beam.watched(), OccType::kFree) << 1.0 - p;
    }
}

TEST(Classification, ThresholdsAtTheClampAreReached) {
    OneBeam beam({.cell_size = 0.1, .p_min = 0.003, .p_max = 0.997, .class_p_occupied = 0.997, .class_p_free = 0.003});
    for (int n = 0; n < 5; ++n) beam.hit();
    EXPECT_EQ(beam.watched(), OccType::kOccupied);
    for (int n = 0; n < 9; ++n) beam.pass();
    EXPECT_EQ(beam.watched(), OccType::kFree);
}

TEST(Classification, ThresholdsCloserThanTheResolutionStayDistinct) {
    OneBeam beam({.cell_size = 0.1, .class_p_occupied = 0.5, .class_p_free = 0.49999});
    beam.hit();
    beam.pass(); // 0.5
    EXPECT_EQ(beam.watched(), OccType::kOccupied);
    beam.pass();
    EXPECT_EQ(beam.watched(), OccType::kFree);
}

TEST(Classification, AcceptedThresholdsBeyondTheClampAreNeverReached) {
    for (const double low : {1e-12, 1e-7, 0.2}) {
        for (const double high : {0.8, 1.0 - 1e-7, 1.0 - 1e-12}) {
            const SessionOptions options{.cell_size = 0.1, .class_p_occupied = high, .class_p_free = low};
            if (!resolve(options)) continue;
            OneBeam beam(options);
            for (int n = 0; n < 6; ++n) beam.pass();
            EXPECT_EQ(beam.watched() == OccType::kFree, low >= 0.001) << low << ", " << high;
            for (int n = 0; n < 12; ++n) beam.hit();
            EXPECT_EQ(beam.watched() == OccType::kOccupied, high <= 0.999) << low << ", " << high;
        }
    }
}

} // namespace
} // namespace scanloom::mapping
