#include "common/archive/archive.hpp"
#include "core/localization/estimation_state.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/restored.hpp"
#include "tests/unit/core/slam/carried_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Poses estimated with excluded scans equal those of a session that never had these scans.
namespace scanloom::localization {
namespace {

using testing_support::digests_of;

using slam::kBack;
using slam::kCarried;

/// The log of the drive, with a sonar that measures after every fifth scan of the laser.
class ExcludedScans {
public:
    /// @param count  number of the first scans that it has
    explicit ExcludedScans(Poses poses, std::size_t count = slam::carried_drive().scans.size()) {
        const slam::Drive& drive = slam::carried_drive();
        Sensor sonar;
        sonar.id = 1;
        sonar.kind = SensorKind::kSonar;
        sonar.angles = UniformAngles{-1.0, 0.5, 5};
        sonar.range_max = 3.0;
        log_ = {RobotJoined{0, "robot", {}, {}, poses}, SensorDescribed{0, drive.laser}, SensorDescribed{0, sonar}};
        for (std::size_t n = 0; n < count; ++n) {
            add(drive.scans[n], n, poses);
            Scan echo;
            echo.sensor = sonar.id;
            echo.ranges.assign(5, 800); // millimetres
            if (n % 5 == 0) add(echo, n, poses);
            if (n + 1 == kCarried - 1) first_ = seq_ + 1;
            if (n + 1 == kBack - 1) last_ = seq_;
        }
    }

    /// Returns the log, and after it the exclusion of these scans.
    [[nodiscard]] std::vector<LogEntry> with(const SeqRange& excluded) const {
        auto log = log_;
        log.emplace_back(ScansExcluded{1, 0, excluded});
        return log;
    }

    /// Returns the log of a session that never had these scans.
    [[nodiscard]] std::vector<LogEntry> without(const SeqRange& excluded) const {
        std::vector<LogEntry> log;
        std::uint64_t seq = 0;
        for (LogEntry entry : log_) {
            if (auto* taken = std::get_if<ScanTaken>(&entry)) {
                if (taken->scan.seq >= excluded.from && taken->scan.seq <= excluded.to) continue;
                taken->scan.seq = ++seq;
            }
            log.push_back(std::move(entry));
        }
        return log;
    }

    [[nodiscard]] SeqRange carried_scans() const { return {first_, last_}; }

private:
    void add(Scan scan, std::size_t n, Poses poses) {
        scan.seq = ++seq_;
        scan.stamp = 0.1 * static_cast<double>(seq_);
        if (poses == Poses::kOdometry) scan.odometry = slam::carried_drive().odometry[n];
        log_.emplace_back(ScanTaken{0, std::move(scan)});
    }

    std::vector<LogEntry> log_;
    std::uint64_t seq_ = 0;
    std::uint64_t first_ = 0;
    std::uint64_t last_ = 0;
};

SharedExclusions exclusions_of(const std::vector<LogEntry>& log) {
    Exclusions exclusions;
    for (std::size_t n = 0; n < log.size(); ++n) {
        const auto* excluded = std::get_if<ScansExcluded>(&log[n]);
        if (excluded != nullptr) exclusions.add(n + 1, *excluded).value();
    }
    return std::make_shared<const Exclusions>(std::move(exclusions));
}

void apply_next(LocalizedProjection& maps, LogEntry entry) {
    double work = HUGE_VAL;
    ASSERT_TRUE(maps.apply(entry, work).value());
}

/// Lets the maps follow the corrected poses.
void correct(LocalizedProjection& maps, const std::vector<LogEntry>& log) {
    mapping::Projection again{mapping::MapConfig(), exclusions_of(log)};
    const auto poses = maps.poses().in_maps();
    for (LogEntry entry : log) {
        poses.place(entry);
        ASSERT_TRUE(again.apply(entry));
    }
    maps.replace(std::move(again), maps.poses().corrected());
}

/// Returns the maps of a log whose exclusions are known from the start.
LocalizedProjection maps_of(const std::vector<LogEntry>& log) {
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig(), exclusions_of(log)});
    for (const LogEntry& entry : log) apply_next(maps, entry);
    correct(maps, log);
    return maps;
}

template <class... Values>
std::string bytes_of_all(const Values&... values) {
    archive::Writer writer;
    writer(values...);
    return std::move(writer).take();
}

/// Expects equal poses of all scans that are not excluded, and equal maps.
void expect_no_trace_in(LocalizedProjection& maps, LocalizedProjection& never) {
    const auto everything = [](const LocalizedProjection& of) {
        const auto& robot = *of.poses().find(0);
        return bytes_of_all(of.poses().map(), robot.estimator(), robot.location().T_map_robot,
                            robot.location().T_map_odom, of.localization_of(0));
    };
    EXPECT_TRUE(everything(maps) == everything(never)); // not EXPECT_EQ, which prints megabytes
    EXPECT_EQ(maps.poses().scan_count(), never.poses().scan_count());
    for (const Estimate estimate : {Estimate::kNewest, Estimate::kFirst}) {
        EXPECT_EQ(maps.poses().trajectory(0, estimate), never.poses().trajectory(0, estimate));
    }
    const auto left = maps.projection().snapshot();
    const auto right = never.projection().snapshot();
    EXPECT_EQ(digests_of(left), digests_of(right));
    EXPECT_EQ(left.robots[0].unplaced, right.robots[0].unplaced);
    EXPECT_EQ(left.robots[0].scan_count, right.robots[0].scan_count);
}

/// Expects equal poses in the maps of earlier entries.
void expect_no_trace_in_history(const PoseHistory& history, const PoseHistory& never, const SeqRange& range) {
    constexpr Revision kJoined = 3; // entries before the first scan
    for (const std::uint64_t seq : {range.from - 20, range.to + 50, range.to + 400}) {
        const std::uint64_t fewer = seq < range.from ? 0 : range.to - range.from + 1;
        const auto then = history.at(kJoined + seq);
        const auto wanted = never.at(kJoined + seq - fewer);
        for (std::uint64_t n = 1; n <= seq; ++n) {
            if (n >= range.from && n <= range.to) {
                ASSERT_FALSE(then.find(0, n));
            } else {
                ASSERT_EQ(then.find(0, n), wanted.find(0, n < range.from ? n : n - fewer)) << n;
            }
        }
    }
}

class ExcludedScansTest : public testing::TestWithParam<Poses> {
protected:
    /// Returns the maps of a drive in which the robot was not carried.
    static LocalizedProjection& maps_without_carried_scans() {
        static std::map<Poses, LocalizedProjection> all;
        const ExcludedScans drive(GetParam());
        auto maps = all.find(GetParam());
        if (maps == all.end()) {
            maps = all.emplace(GetParam(), maps_of(drive.without(drive.carried_scans()))).first;
        }
        return maps->second;
    }
};

TEST_P(ExcludedScansTest, LeaveNoTraceInPosesAndMaps) {
    const ExcludedScans drive(GetParam());
    const SeqRange range = drive.carried_scans();
    auto maps = maps_of(drive.with(range));
    auto& never = maps_without_carried_scans();
    expect_no_trace_in(maps, never);
    expect_no_trace_in_history(maps.poses().history(), never.poses().history(), range);
    EXPECT_EQ(maps.projection().snapshot().robots[0].excluded, range.to - range.from + 1);
    const auto& poses = *maps.poses().find(0);
    for (std::uint64_t seq = range.from; seq <= range.to; ++seq) {
        ASSERT_FALSE(poses.in_maps()[seq - 1] || poses.is_fragment_located(seq - 1) || poses.was_in_map(seq - 1));
    }
}

TEST_P(ExcludedScansTest, DoNotBeginTheMap) {
    const ExcludedScans drive(GetParam(), 200);
    const SeqRange range{1, 10};
    auto maps = maps_of(drive.with(range));
    auto never = maps_of(drive.without(range));
    expect_no_trace_in(maps, never);
}

TEST_P(ExcludedScansTest, AreExcludedInAStateThatWasStored) {
    const ExcludedScans drive(GetParam());
    const auto log = drive.with(drive.carried_scans());
    const auto half = static_cast<std::ptrdiff_t>(drive.carried_scans().from + 40); // among the excluded scans
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig(), exclusions_of(log)});
    for (auto entry = log.begin(); entry != log.begin() + half; ++entry) apply_next(maps, *entry);
    auto estimation = restored(state_of(maps), maps.projection().state());
    ASSERT_TRUE(estimation);
    LocalizedProjection again(testing_support::restored(maps.projection()), std::move(estimation->poses),
                              estimation->shown, estimation->announced);
    for (auto entry = log.begin() + half; entry != log.end(); ++entry) apply_next(again, *entry);
    correct(again, log);
    expect_no_trace_in(again, maps_without_carried_scans());
}

INSTANTIATE_TEST_SUITE_P(WithOdometry, ExcludedScansTest, testing::Values(Poses::kOdometry));
INSTANTIATE_TEST_SUITE_P(WithoutOdometryTrials, ExcludedScansTest, testing::Values(Poses::kNone));

} // namespace
} // namespace scanloom::localization
