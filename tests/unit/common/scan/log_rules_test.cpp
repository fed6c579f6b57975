#include "common/scan/log_rules.hpp"

#include "tests/support/random_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace scanloom {
namespace {

using testing::HasSubstr;
using testing_support::random_scan;
using testing_support::small_laser;

/// Returns a random entry; some entries are out of sequence.
LogEntry random_entry(std::mt19937& engine) {
    const auto random = [&](unsigned below) { return static_cast<unsigned>(engine() % below); };
    const RobotIndex robot = random(4);
    switch (random(12)) {
    case 0: {
        const std::string name(1, static_cast<char>('a' + random(3)));
        return RobotJoined{robot, name, random(2) ? "s" : "", {}, random(4) ? Poses::kMap : Poses::kOdometry};
    }
    case 1: {
        Sensor sensor = small_laser();
        sensor.id = random(3);
        return SensorDescribed{robot, sensor};
    }
    case 2: return MapPatch{0.05, 0.0, 0.0, 1, {MapCell{}}};
    case 3: return ScansExcluded{random(6), robot, SeqRange{1, 2}};
    case 4: return ExclusionLifted{random(6)};
    case 5: return MapsCorrected{random(80)};
    case 6: return RobotRelocalized{robot, {1.0, 2.0}, 3.0};
    case 7: return ModeChanged{random(3) == 0};
    default: {
        Scan scan = random_scan(1, random(5) + 1);
        scan.sensor = random(3);
        if (random(8) == 0) scan.pose.reset();
        return ScanTaken{robot, scan, random(4) == 0};
    }
    }
}

/// Returns the entries of one kind.
template <class Body>
std::vector<Body> all_of(const std::vector<LogEntry>& log) {
    std::vector<Body> found;
    for (const auto& entry : log) {
        if (const auto* body = std::get_if<Body>(&entry)) found.push_back(*body);
    }
    return found;
}

/// Decides by the definitions, from all earlier entries.
struct CanFollow {
    const std::vector<LogEntry>& log;

    [[nodiscard]] bool has_joined(RobotIndex robot) const {
        return std::ranges::any_of(all_of<RobotJoined>(log), [&](const auto& one) { return one.robot == robot; });
    }
    [[nodiscard]] RobotJoined joined_last(RobotIndex robot) const {
        RobotJoined last;
        for (const auto& one : all_of<RobotJoined>(log)) {
            if (one.robot == robot) last = one;
        }
        return last;
    }
    [[nodiscard]] std::size_t scans_of(RobotIndex robot) const {
        return static_cast<std::size_t>(std::ranges::count(all_of<ScanTaken>(log), robot, &ScanTaken::robot));
    }

    bool operator()(const RobotJoined& joined) const {
        if (!has_joined(joined.robot)) return joined.robot == 0 || has_joined(joined.robot - 1);
        const auto newest = joined_last(joined.robot);
        const bool is_same = newest.source == joined.source && newest.poses == joined.poses;
        return newest.name == joined.name && (is_same || scans_of(joined.robot) == 0);
    }
    bool operator()(const SensorDescribed& described) const { return has_joined(described.robot); }
    bool operator()(const ScanTaken& taken) const {
        const bool is_described = std::ranges::any_of(all_of<SensorDescribed>(log), [&](const auto& one) {
            return one.robot == taken.robot && one.sensor.id == taken.scan.sensor;
        });
        const auto modes = all_of<ModeChanged>(log);
        const bool is_of_mode = taken.is_localize_only == (!modes.empty() && modes.back().is_localize_only);
        const bool is_next = taken.scan.seq == scans_of(taken.robot) + 1 && is_of_mode;
        return is_described && is_next && (taken.scan.pose || joined_last(taken.robot).poses != Poses::kMap);
    }
    bool operator()(const MapPatch&) const { return !has_joined(0); }
    bool operator()(const ScansExcluded& excluded) const {
        const auto earlier = all_of<ScansExcluded>(log);
        const auto is_later = [&](const auto& one) { return one.id >= excluded.id; };
        return excluded.id > 0 && has_joined(excluded.robot) && std::ranges::none_of(earlier, is_later);
    }
    bool operator()(const ExclusionLifted& lifted) const {
        const auto is_it = [&](const auto& one) { return one.id == lifted.id; };
        return std::ranges::any_of(all_of<ScansExcluded>(log), is_it) &&
               std::ranges::none_of(all_of<ExclusionLifted>(log), is_it);
    }
    bool operator()(const MapsCorrected& corrected) const { return corrected.as_of <= log.size(); }
    bool operator()(const RobotRelocalized& relocalized) const {
        return has_joined(relocalized.robot) && joined_last(relocalized.robot).poses != Poses::kMap;
    }
    bool operator()(const ModeChanged&) const { return true; }
};

TEST(LogRules, AcceptExactlyTheEntriesInSequence) {
    std::mt19937 random(1);
    int taken = 0;
    int refused = 0;
    for (int run = 0; run < 300; ++run) {
        LogRules rules;
        std::vector<LogEntry> log;
        for (int n = 0; n < 60; ++n) {
            const auto entry = random_entry(random);
            const bool can_follow = std::visit(CanFollow{log}, entry);
            ASSERT_EQ(rules.check(entry).has_value(), can_follow) << run << ", " << n;
            ASSERT_EQ(rules.add(entry).has_value(), can_follow);
            if (can_follow) log.push_back(entry);
            ASSERT_EQ(rules.revision(), log.size());
            ++(can_follow ? taken : refused);
        }
        for (RobotIndex robot = 0; robot < rules.robots().size(); ++robot) {
            EXPECT_EQ(rules.robots()[robot].last_seq, CanFollow{log}.scans_of(robot));
        }
        EXPECT_EQ(rules.exclusions().all().size(), all_of<ScansExcluded>(log).size());
    }
    EXPECT_GT(taken, 1000);
    EXPECT_GT(refused, 1000);
}

TEST(LogRules, ErrorsNameTheEntryAndTheReason) {
    LogRules rules;
    ASSERT_TRUE(rules.add(RobotJoined{0, "a", ""}));
    ASSERT_TRUE(rules.add(SensorDescribed{0, small_laser()}));
    const auto refusal = rules.check(ScanTaken{0, random_scan(1, 4)}).error();
    EXPECT_EQ(refusal.code, Errc::kMalformed);
    EXPECT_EQ(refusal.message, "log entry 3: scan 4 of robot 'a' follows scan 0; the log is damaged");
    EXPECT_THAT(rules.check(ScanTaken{1, random_scan(1, 1)}).error().message, HasSubstr("robot 1, which never joined"));
    EXPECT_EQ(rules.check(MapsCorrected{3}).error().message,
              "log entry 3: maps are corrected as of entry 3; the log is damaged");
    EXPECT_TRUE(rules.check(MapsCorrected{2}));
}

TEST(LogRules, RobotKeepsTheKindOfItsPosesOnceItHasScans) {
    LogRules rules;
    const auto joined = [](Poses poses) { return RobotJoined{.robot = 0, .name = "a", .poses = poses}; };
    ASSERT_TRUE(rules.add(joined(Poses::kMap)));
    ASSERT_TRUE(rules.add(SensorDescribed{0, small_laser()}));
    ASSERT_TRUE(rules.add(joined(Poses::kOdometry)));
    EXPECT_EQ(rules.robots()[0].poses, Poses::kOdometry);
    Scan scan = random_scan(1, 1);
    scan.pose.reset();
    ASSERT_TRUE(rules.add(ScanTaken{0, scan}));
    for (const auto other : {Poses::kMap, Poses::kNone}) EXPECT_FALSE(rules.check(joined(other))) << name_of(other);
    EXPECT_TRUE(rules.check(joined(Poses::kOdometry)));
}

TEST(LogRules, ScanMayLackItsPoseOnlyIfTheRobotDoesNotSendPoses) {
    Scan scan = random_scan(1, 1);
    scan.pose.reset();
    for (const auto poses : {Poses::kMap, Poses::kOdometry, Poses::kNone}) {
        LogRules rules;
        ASSERT_TRUE(rules.add(RobotJoined{.robot = 0, .name = "a", .poses = poses}));
        ASSERT_TRUE(rules.add(SensorDescribed{0, small_laser()}));
        const auto checked = rules.check(ScanTaken{0, scan});
        EXPECT_EQ(checked.has_value(), poses != Poses::kMap) << name_of(poses);
        if (checked) continue;
        EXPECT_EQ(checked.error().message, "log entry 3: scan 1 of robot 'a' has no pose; the log is damaged");
    }
}

/// Rules of a log in which robot 0 sends its poses, and robot 1 does not.
class FrameOriginTest : public testing::Test {
protected:
    void SetUp() override {
        for (RobotIndex robot = 0; robot < 2; ++robot) {
            const Poses poses = robot == kSender ? Poses::kMap : Poses::kOdometry;
            ASSERT_TRUE(rules_.add(RobotJoined{robot, robot == kSender ? "sender" : "other", {}, {}, poses}));
            ASSERT_TRUE(rules_.add(SensorDescribed{robot, small_laser()}));
        }
        before_ = rules_.robots();
    }

    FrameOrigin after_scan_of(RobotIndex robot) {
        Scan scan = random_scan(1, rules_.robots()[robot].last_seq + 1);
        scan.sensor = small_laser().id;
        if (robot != kSender) scan.pose.reset();
        EXPECT_TRUE(rules_.add(ScanTaken{robot, scan, rules_.is_localize_only()}));
        return rules_.frame_origin();
    }
    FrameOrigin after_mode(bool is_localize_only) {
        EXPECT_TRUE(rules_.add(ModeChanged{is_localize_only}));
        return rules_.frame_origin();
    }
    FrameOrigin after_reset_of(RobotIndex robot) {
        rules_.reset_robot(robot, before_[robot]);
        return rules_.frame_origin();
    }

    static constexpr RobotIndex kSender = 0;
    static constexpr RobotIndex kOther = 1;
    LogRules rules_;
    std::vector<LoggedRobot> before_; // without scans
};

TEST_F(FrameOriginTest, TheFirstScanDecides) {
    EXPECT_EQ(rules_.frame_origin(), FrameOrigin::kOpen);
    EXPECT_EQ(after_scan_of(kSender), FrameOrigin::kSent);
    EXPECT_EQ(after_scan_of(kOther), FrameOrigin::kSent);
    EXPECT_EQ(after_reset_of(kSender), FrameOrigin::kEstimated) << "the other one's is the first that is left";
    EXPECT_EQ(after_scan_of(kSender), FrameOrigin::kEstimated);
    EXPECT_EQ(after_reset_of(kOther), FrameOrigin::kSent);
    EXPECT_EQ(after_reset_of(kSender), FrameOrigin::kOpen);
}

TEST_F(FrameOriginTest, AnImportedMapDecidesIfItShowsAnything) {
    LogRules rules;
    ASSERT_TRUE(rules.add(MapPatch{0.05, 0.0, 0.0, 1, {MapCell::kUnknown}}));
    EXPECT_EQ(rules.frame_origin(), FrameOrigin::kOpen);
    ASSERT_TRUE(rules.add(MapPatch{0.05, 0.0, 0.0, 1, {MapCell::kFree}}));
    EXPECT_EQ(rules.frame_origin(), FrameOrigin::kImported);
    rules_ = rules;
    SetUp();
    EXPECT_EQ(after_scan_of(kOther), FrameOrigin::kImported);
    EXPECT_EQ(after_reset_of(kOther), FrameOrigin::kImported);
}

TEST_F(FrameOriginTest, InLocalizeOnlyModeNoEstimatedPoseBeginsAMap) {
    after_mode(true);
    EXPECT_EQ(after_scan_of(kOther), FrameOrigin::kOpen);
    EXPECT_EQ(after_mode(false), FrameOrigin::kEstimated);
    EXPECT_EQ(after_reset_of(kOther), FrameOrigin::kOpen);
    after_mode(true);
    after_scan_of(kOther);
    EXPECT_EQ(after_scan_of(kSender), FrameOrigin::kOpen);
    EXPECT_EQ(after_mode(false), FrameOrigin::kSent) << "so that both can go on";
}

} // namespace
} // namespace scanloom
