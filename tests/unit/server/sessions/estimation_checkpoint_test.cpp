#include "core/localization/estimation_state.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "server/sessions/session_check.hpp"
#include "server/sessions/summary.hpp"
#include "tests/unit/server/sessions/estimated_poses_fixture.hpp"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// Checkpoints of sessions whose poses the server estimates.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;

using Parts = std::map<std::string, std::string>;

class EstimationCheckpointTest : public EstimatedPosesTest {
protected:
    void close() {
        bool is_closed = false;
        session_->close({Errc::kShuttingDown, "closed"}, [&] { is_closed = true; });
        run();
        ASSERT_TRUE(is_closed);
    }

    /// The log of two robots, of which the second is located late, with the corrections of the maps. Made once.
    void drive_two() {
        static std::vector<std::string> entries;
        entries_ = entries;
        if (!entries_.empty()) return;
        const slam::Drive second = slam::drive_along(
            slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}}, {.scale = 0.98}, 2);
        drive_on(20, lap().scans.size() - 100);
        drive_on("second", second, 20, second.scans.size());
        drive_on(20);
        entries_ = entries = store::entries_after(log_, id_, 0).value();
    }

    /// Returns the maps of the whole log.
    localization::LocalizedProjection whole() { return recovered_with({}).maps; }

    /// Returns what a session with these parts and the whole log begins with.
    Recovered recovered_with(const Parts& parts) {
        const auto id = log_.create_session("an unused record").value();
        EXPECT_TRUE(store::append_and_wait(log_, id, 1, entries_));
        for (const auto& [key, value] : parts) EXPECT_TRUE(log_.write_checkpoint(id, {{key, value}}));
        return recover(log_, id, config_, false).value();
    }

    /// Returns the parts of a checkpoint of these maps.
    static Parts parts_of(localization::LocalizedProjection& maps) {
        store::MemoryScanLog log;
        const auto id = log.create_session("an unused record").value();
        EXPECT_TRUE(write(log, id, maps, std::nullopt));
        return store::checkpoint_of(log, id).value();
    }

    static Result<> write(store::ScanLog& log, store::SessionId id, localization::LocalizedProjection& maps,
                          std::optional<Revision> since) {
        return write_checkpoint(log, id, maps.projection().snapshot(), maps.projection().state(), since, false,
                                estimation_to_store(maps));
    }

    static void expect_equal(localization::LocalizedProjection& a, localization::LocalizedProjection& b) {
        EXPECT_TRUE(localization::are_equal(a.poses(), b.poses()));
        EXPECT_EQ(a.moving_scans(), b.moving_scans());
        const auto left = a.projection().snapshot();
        const auto right = b.projection().snapshot();
        EXPECT_EQ(testing_support::digests_of(left), testing_support::digests_of(right));
        ASSERT_EQ(left.robots.size(), right.robots.size());
        for (RobotIndex n = 0; n < left.robots.size(); ++n) {
            const auto& l = left.robots[n];
            const auto& r = right.robots[n];
            EXPECT_EQ(std::tie(l.name, l.poses, l.last_seq, l.scan_count, l.unplaced, l.stamp, l.pose),
                      std::tie(r.name, r.poses, r.last_seq, r.scan_count, r.unplaced, r.stamp, r.pose));
            for (std::uint64_t seq = 1; seq <= l.last_seq; ++seq) {
                ASSERT_EQ(left.scan_poses.find(n, seq), right.scan_poses.find(n, seq));
            }
        }
    }

    std::vector<std::string> entries_;
    Revision announced_ = 0; // the last correction of the maps in them
};

TEST_F(EstimationCheckpointTest, LoadingGoesOnAfterIt) {
    drive_two();
    auto expected = whole();
    const Revision end = entries_.size();
    std::set<Revision> cuts{3, end / 2, end - 150, end};
    for (Revision n = 1; n <= end; ++n) { // of the last correction: the maps are outdated before, and not afterwards
        const auto entry = wire::decode_entry(entries_[n - 1]).value();
        if (std::holds_alternative<MapsCorrected>(entry)) announced_ = n;
    }
    cuts.insert({announced_ - 1, announced_});
    const auto id = log_.create_session("an unused record").value();
    for (Revision stored = 0; const Revision cut : cuts) {
        SCOPED_TRACE("checkpoint after entry " + std::to_string(cut));
        const auto at = [&](Revision n) { return entries_.begin() + static_cast<std::ptrdiff_t>(n); };
        ASSERT_TRUE(store::append_and_wait(log_, id, stored + 1, {at(stored), at(cut)}));
        auto maps = recover(log_, id, config_, false).value(); // from the checkpoint before
        EXPECT_EQ(maps.checkpointed, stored);
        ASSERT_TRUE(write(log_, id, maps.maps, stored));
        stored = cut;
        auto recovered = recovered_with(store::checkpoint_of(log_, id).value());
        ASSERT_FALSE(recovered.checkpoint_rejected) << recovered.checkpoint_rejected->message;
        EXPECT_EQ(recovered.checkpointed, cut);
        expect_equal(recovered.maps, expected);
    }
}

TEST_F(EstimationCheckpointTest, ASessionThatWasClosedGoesOn) {
    drive_on(20);
    const State expected = state();
    id_ = log_.create_session("an unused record").value();
    start_session();
    for (const std::size_t scans : {std::size_t{1}, lap().scans.size() / 2, lap().scans.size() - 40}) {
        drive_on(20, scans);
        const auto before = session_->snapshot();
        close();
        const auto recovered = recover(log_, id_, config_, false).value();
        EXPECT_EQ(recovered.checkpointed, before->revision);
        start_session();
        EXPECT_EQ(session_->snapshot()->scan_poses.corrected(), before->scan_poses.corrected());
        const auto& now = session_->snapshot()->robots.at(0);
        EXPECT_EQ(now.localization.inlier_ratio, before->robots.at(0).localization.inlier_ratio);
        EXPECT_EQ(now.localization.corrections, before->robots.at(0).localization.corrections);
    }
    drive_on(20);
    EXPECT_EQ(state(), expected);
}

TEST_F(EstimationCheckpointTest, TheSummaryShowsHowWellPosesAreKnown) {
    drive_on(20, 300);
    const auto before = session_->snapshot();
    close();
    const auto summary = read_summary(log_, id_, config_).value();
    ASSERT_TRUE(summary);
    const auto& shown = summary->facts->robots.at(0);
    EXPECT_EQ(shown.poses, Poses::kOdometry);
    EXPECT_EQ(shown.localization.state, LocalizationState::kTracking);
    EXPECT_EQ(shown.localization.inlier_ratio, before->robots.at(0).localization.inlier_ratio);
    EXPECT_EQ(shown.pose, before->robots.at(0).pose);
    auto maps = recover(log_, id_, config_, false).value().maps;
    EXPECT_EQ(summary->pages, maps.page_count());
}

/// A store that fails after a given number of checkpoint pieces, as after a power cut.
class PowerCut : public store::MemoryScanLog {
public:
    [[nodiscard]] Result<> write_checkpoint(store::SessionId session,
                                            std::vector<store::CheckpointPart> parts) override {
        if (pieces_left == 0) return Error{Errc::kStoreFailed, "no power"};
        --pieces_left;
        return MemoryScanLog::write_checkpoint(session, std::move(parts));
    }

    std::size_t pieces_left = 1'000'000;
};

TEST_F(EstimationCheckpointTest, ACrashLeavesTheOldOneOrTheNewOne) {
    drive_two();
    auto expected = whole();
    const Revision end = entries_.size();
    const Revision before = end - 150;
    PowerCut log;
    const auto id = log.create_session("an unused record").value();
    const auto middle = entries_.begin() + static_cast<std::ptrdiff_t>(before);
    ASSERT_TRUE(store::append_and_wait(log, id, 1, {entries_.begin(), middle}));
    auto first = recover(log, id, config_, false).value().maps;
    ASSERT_TRUE(store::append_and_wait(log, id, before + 1, {middle, entries_.end()}));
    bool is_complete = false;
    for (std::size_t pieces = 0; !is_complete; ++pieces) {
        for (const bool has_first : {false, true}) {
            if (!has_first && pieces != 1) continue; // as with a first one, but takes longer
            SCOPED_TRACE("cut after piece " + std::to_string(pieces));
            ASSERT_TRUE(log.clear_checkpoint(id));
            log.pieces_left = 1'000'000;
            if (has_first) {
                ASSERT_TRUE(write(log, id, first, 0));
            }
            log.pieces_left = pieces;
            const Revision previous = has_first ? before : 0;
            is_complete = write(log, id, expected, previous).has_value();
            const Revision stored = is_complete ? end : previous;
            log.pieces_left = 1'000'000;
            auto recovered = recover(log, id, config_, false).value();
            EXPECT_FALSE(recovered.checkpoint_rejected) << recovered.checkpoint_rejected->message;
            EXPECT_EQ(recovered.checkpointed, stored);
            expect_equal(recovered.maps, expected);
            ASSERT_TRUE(write(log, id, recovered.maps, recovered.checkpointed)) << "the next one repairs it";
            auto again = recover(log, id, config_, false).value();
            EXPECT_EQ(again.checkpointed, end);
            expect_equal(again.maps, expected);
        }
        ASSERT_TRUE(is_complete || pieces < 20);
        EXPECT_TRUE(!is_complete || pieces >= 2) << "the test needs several pieces";
    }
}

TEST_F(EstimationCheckpointTest, ScansOfKeyframesAreWrittenOnce) {
    drive_two();
    PowerCut log;
    const auto id = log.create_session("an unused record").value();
    ASSERT_TRUE(store::append_and_wait(log, id, 1, entries_));
    auto maps = recover(log, id, config_, false).value().maps;
    ASSERT_TRUE(write(log, id, maps, 0));
    const Parts parts = store::checkpoint_of(log, id).value();
    ASSERT_TRUE(parts.contains("slam/scans/00000001"));
    ASSERT_TRUE(parts.contains("slam/correction/00000000/00000000"));
    ASSERT_TRUE(log.write_checkpoint(id, {{"slam/scans/00000000", "kept"}}));
    ASSERT_TRUE(log.write_checkpoint(id, {{"slam/correction/00000000/00000000", "kept"}}));
    ASSERT_TRUE(write(log, id, maps, entries_.size()));
    const Parts later = store::checkpoint_of(log, id).value();
    EXPECT_EQ(later.at("slam/scans/00000000"), "kept");
    EXPECT_EQ(later.at("slam/correction/00000000/00000000"), "kept");
    EXPECT_EQ(later.at("slam/state/00000001/00000000"), parts.at("slam/state/00000000/00000000"));
}

TEST_F(EstimationCheckpointTest, DamagedOrMissingPartsAreRefusedAndTheLogIsRead) {
    drive_two();
    auto expected = whole();
    const Parts parts = parts_of(expected);
    std::size_t damaged = 0;
    for (const auto& [key, value] : parts) {
        if (!key.starts_with("slam/") && key != "head/estimation") continue;
        std::vector<std::optional<std::string>> values{std::nullopt, ""}; // nullopt: the part is missing
        for (const std::size_t kept : {std::size_t{1}, value.size() / 2, value.size() - 1}) {
            values.emplace_back(value.substr(0, kept));
        }
        for (const auto& other : values) {
            Parts changed = parts;
            if (other) changed[key] = *other;
            if (!other) changed.erase(key);
            CheckpointReader reader(config_);
            std::optional<Error> refused;
            for (const auto& [name, bytes] : changed) {
                if (refused) break;
                if (auto added = reader.add(name, bytes); !added) refused = added.error();
            }
            if (!refused) {
                const auto maps = std::move(reader).finish();
                if (!maps) refused = maps.error();
            }
            const bool is_plain = !other && key == "head/estimation"; // as of a session without estimated poses
            EXPECT_EQ(refused.has_value(), !is_plain) << key << (other ? " has " + std::to_string(other->size()) : "");
            ++damaged;
        }
    }
    EXPECT_GT(damaged, 20U);
    Parts changed = parts;
    changed["slam/scans/00000000"] = "?";
    auto recovered = recovered_with(changed);
    EXPECT_EQ(recovered.checkpoint_rejected.value_or(Error{}).message,
              "checkpoint part 'slam/scans/00000000' is damaged");
    EXPECT_EQ(recovered.checkpointed, std::nullopt) << "the next one replaces it";
    expect_equal(recovered.maps, expected);
}

TEST_F(EstimationCheckpointTest, ADamagedStateIsNamed) {
    drive_on(20, 200);
    entries_ = store::entries_after(log_, id_, 0).value();
    auto expected = whole();
    Parts parts = parts_of(expected);
    ASSERT_EQ(parts.erase("slam/state/00000000/00000000"), 1U);
    auto recovered = recovered_with(parts);
    EXPECT_EQ(recovered.checkpoint_rejected.value_or(Error{}).message,
              "the checkpoint's state of the estimation is damaged")
        << "not a part of the maps";
    expect_equal(recovered.maps, expected);
}

TEST_F(EstimationCheckpointTest, PosesOfAnotherVersionAreEstimatedAgain) {
    drive_on(20, 200);
    entries_ = store::entries_after(log_, id_, 0).value();
    auto expected = whole();
    Parts parts = parts_of(expected);
    parts["head/estimation"][0] = static_cast<char>(localization::kEstimationVersion + 1);
    auto recovered = recovered_with(parts);
    ASSERT_TRUE(recovered.checkpoint_rejected);
    EXPECT_EQ(recovered.checkpoint_rejected->code, Errc::kUnsupportedVersion);
    EXPECT_THAT(recovered.checkpoint_rejected->message,
                HasSubstr(fmt::format("estimated by version {}", localization::kEstimationVersion + 1)));
    expect_equal(recovered.maps, expected);
}

TEST_F(EstimationCheckpointTest, ADeepCheckComparesThePoses) {
    const auto parts_after = [&](const slam::Drive& drive) {
        id_ = log_.create_session(wire::encode_session({"lab", 0.0, mapping::options_of(config_)})).value();
        start_session();
        drive_on("robot", drive, 20, 200);
        close();
        return store::checkpoint_of(log_, id_).value();
    };
    slam::Drive other = lap();
    for (std::size_t n = 100; n < other.odometry.size(); ++n) other.odometry[n].x += 0.01;
    const Parts wrong = parts_after(other);
    parts_after(lap());
    const auto check = [&](CheckDepth depth) {
        const auto sessions = log_.sessions().value();
        const auto found = check_session(log_, sessions.back(), depth, [](std::size_t) -> Result<> { return {}; });
        return found.value().damage.value_or(Error{}).message;
    };
    EXPECT_EQ(check(CheckDepth::kCheckpoint), "");
    EXPECT_EQ(check(CheckDepth::kMaps), "");
    for (const auto& [key, value] : wrong) ASSERT_TRUE(log_.write_checkpoint(id_, {{key, value}}));
    EXPECT_EQ(check(CheckDepth::kCheckpoint), "");
    EXPECT_THAT(check(CheckDepth::kMaps), HasSubstr("the poses estimated from the whole log differ"));
}

} // namespace
} // namespace scanloom::sessions
