#include "server/sessions/capture_layers.hpp"

#include "common/wire/log_codec.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/room_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing_support::reference_laser;
using testing_support::room_scans;
using namespace std::chrono_literals;

const auto kContinue = [] { return true; };

std::vector<landmarks::MapLandmark> all_of(const landmarks::LandmarkState& state) {
    std::vector<landmarks::MapLandmark> all;
    for (std::size_t id = 0; id < state.landmarks.size(); ++id) all.push_back(state.landmarks[id]);
    return all;
}

/// Two robots that drive and stand in a room; one of them has a sonar as well.
class CaptureLayersTest : public testing::Test {
protected:
    CaptureLayersTest() {
        info_.id = log_.create_session("s").value();
        info_.name = "s";
        const Sensor laser = reference_laser();
        Sensor sonar;
        sonar.id = 2;
        sonar.kind = SensorKind::kSonar;
        sonar.angles = UniformAngles{0.0, 1.0, 2};
        sonar.range_max = 5.0;
        entries_ = {RobotJoined{0, "a"}, SensorDescribed{0, laser}, SensorDescribed{0, sonar}, RobotJoined{1, "b"},
                    SensorDescribed{1, laser}};
        std::mt19937 random(2);
        std::array<std::uint64_t, 2> seq{};
        std::array<std::size_t, 2> at{0, 60};
        const auto round = room_scans(120);
        for (int n = 0; n < 900; ++n) {
            const RobotIndex robot = random() % 2;
            if (random() % 3 == 0) ++at[robot]; // otherwise the robot stands
            Scan scan = round[at[robot] % round.size()];
            scan.seq = ++seq[robot];
            scan.stamp = 0.1 * n;
            if (robot == 0 && random() % 4 == 0) {
                scan.sensor = 2;
                scan.ranges = {700, kNoReturn};
            }
            entries_.emplace_back(ScanTaken{robot, scan});
        }
        append(entries_);
    }

    void append(const std::vector<LogEntry>& entries) {
        for (const auto& entry : entries) append(wire::encode_entry(entry));
    }
    void append(const std::string& bytes) { store::append_and_wait(log_, info_.id, ++end_, {bytes}).value(); }

    /// Computes the landmarks from every scan, by the definition.
    [[nodiscard]] landmarks::LandmarkState expected(Revision until) const {
        landmarks::LandmarkLayer layer;
        std::array<landmarks::CaptureCutter, 2> cutters;
        std::map<std::pair<RobotIndex, std::uint32_t>, Sensor> sensors;
        for (Revision revision = 1; revision <= until; ++revision) {
            const auto& entry = entries_[revision - 1];
            if (const auto* described = std::get_if<SensorDescribed>(&entry)) {
                sensors[{described->robot, described->sensor.id}] = described->sensor;
            } else if (const auto* taken = std::get_if<ScanTaken>(&entry)) {
                const auto& sensor = sensors[{taken->robot, taken->scan.sensor}];
                if (sensor.kind != SensorKind::kLaser) continue;
                const auto ended = cutters[taken->robot].add(taken->scan, sensor, revision);
                if (ended) layer.add({taken->robot, *ended, revision});
            }
        }
        return layer.snapshot();
    }

    void expect_landmarks(const ComputedLandmarks& applied, Revision until) {
        const auto right = expected(until);
        EXPECT_EQ(applied.revision, until);
        EXPECT_EQ(applied.state.captures, right.captures) << until;
        EXPECT_EQ(applied.state.sums, right.sums) << until;
        EXPECT_EQ(all_of(applied.state), all_of(right)) << until;
    }

    store::MemoryScanLog log_;
    SessionInfo info_;
    std::vector<LogEntry> entries_;
    Revision end_ = 0;
};

TEST_F(CaptureLayersTest, AreIndependentOfTheNumberOfSteps) {
    std::mt19937 random(7);
    LandmarkLayers layers(log_);
    for (Revision until = 0; until < end_; until = std::min(end_, until + 1 + random() % 100)) {
        expect_landmarks(layers.up_to(info_, until, {}, kContinue).value(), until);
    }
    expect_landmarks(layers.up_to(info_, end_, {}, kContinue).value(), end_);
    expect_landmarks(LandmarkLayers(log_).up_to(info_, end_, {}, kContinue).value(), end_);
    EXPECT_GT(all_of(expected(end_)).size(), 5U);
    EXPECT_GT(expected(end_).captures, 20U);
}

TEST_F(CaptureLayersTest, RequestForAnEarlierRevisionReturnsTheNewestState) {
    LandmarkLayers layers(log_);
    layers.up_to(info_, end_, {}, kContinue).value();
    EXPECT_EQ(layers.up_to(info_, 10, {}, kContinue).value().revision, end_);
}

TEST_F(CaptureLayersTest, LongComputationContinuesWithTheNextRequest) {
    LandmarkLayers layers(log_, {.timeout = 0ms});
    int calls = 0;
    auto applied = layers.up_to(info_, end_, {}, kContinue);
    for (; !applied; applied = layers.up_to(info_, end_, {}, kContinue)) {
        EXPECT_EQ(applied.error().code, Errc::kOverloaded);
        EXPECT_THAT(applied.error().message, HasSubstr("of 905 log entries are found; repeat the request"));
        ASSERT_LT(++calls, 100);
    }
    EXPECT_GT(calls, 1);
    expect_landmarks(*applied, end_);
}

TEST_F(CaptureLayersTest, CancelledComputationContinuesLater) {
    LandmarkLayers layers(log_);
    EXPECT_EQ(layers.up_to(info_, end_, {}, [] { return false; }).error().code, Errc::kShuttingDown);
    expect_landmarks(layers.up_to(info_, end_, {}, kContinue).value(), end_);
}

TEST_F(CaptureLayersTest, DamagedEntryIsReportedAndEarlierEntriesStayAvailable) {
    append("nonsense");
    append(std::vector<LogEntry>{entries_.back()});
    LandmarkLayers layers(log_);
    for (int n = 0; n < 2; ++n) {
        const auto applied = layers.up_to(info_, end_, {}, kContinue);
        ASSERT_FALSE(applied);
        EXPECT_EQ(applied.error().code, Errc::kDataLoss);
        EXPECT_THAT(applied.error().message, HasSubstr("log entry 906"));
    }
    expect_landmarks(layers.up_to(info_, end_ - 2, {}, kContinue).value(), end_ - 2);
}

TEST_F(CaptureLayersTest, TooManyLandmarksAreRefused) {
    const auto many = all_of(expected(end_)).size();
    EXPECT_TRUE(LandmarkLayers(log_, {.size_max = many}).up_to(info_, end_, {}, kContinue));
    LandmarkLayers layers(log_, {.size_max = many - 1});
    for (int n = 0; n < 2; ++n) EXPECT_EQ(layers.up_to(info_, end_, {}, kContinue).error().code, Errc::kFull);
}

/// The test detects a kept state by whether the log is read again.
TEST_F(CaptureLayersTest, RemovesLeastRecentlyUsedAndDeletedSessions) {
    const auto is_kept = [&](LandmarkLayers& layers, const SessionInfo& session) {
        log_.fail_reading(Error{Errc::kStoreFailed, "the disk is gone"});
        const bool kept = layers.up_to(session, end_, {}, kContinue).has_value();
        log_.fail_reading(std::nullopt);
        return kept;
    };
    SessionInfo second = info_;
    second.id = log_.create_session("second").value();
    for (Revision revision = 1; revision <= end_; ++revision) {
        store::append_and_wait(log_, second.id, revision, {wire::encode_entry(entries_[revision - 1])}).value();
    }
    const auto many = all_of(expected(end_)).size();
    for (const auto& limits : {CaptureLayerLimits<landmarks::LandmarkLayer>{.kept_max = 1},
                               CaptureLayerLimits<landmarks::LandmarkLayer>{.size_max = 2 * many - 1},
                               CaptureLayerLimits<landmarks::LandmarkLayer>{}}) {
        const bool has_room = limits.kept_max > 1 && limits.size_max >= 2 * many;
        LandmarkLayers layers(log_, limits);
        layers.up_to(info_, end_, {}, kContinue).value();
        layers.up_to(second, end_, {}, kContinue).value();
        EXPECT_TRUE(is_kept(layers, second));
        EXPECT_EQ(is_kept(layers, info_), has_room);
        layers.up_to(info_, end_, {}, kContinue).value();
        layers.remove(info_.id);
        EXPECT_FALSE(is_kept(layers, info_));
    }
}

} // namespace
} // namespace scanloom::sessions
