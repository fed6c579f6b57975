#pragma once

#include "core/localization/estimation_state.hpp"
#include "core/localization/localized_projection.hpp"
#include "tests/support/restored.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::localization {

/// Returns the state after its way through bytes.
inline EstimationState stored(const EstimationState& state) {
    EstimationState read{state.bytes, {}, {}, {}};
    std::string scans;
    for (const auto& scan : state.scans) scans += bytes_of(*scan);
    EXPECT_TRUE(append_scans(scans, read.scans));
    for (const auto& each : state.corrections) EXPECT_TRUE(append_correction(bytes_of(*each), read.corrections));
    return read;
}

/// Returns the maps that a checkpoint of these would give.
inline std::optional<LocalizedProjection> through_bytes(LocalizedProjection& maps) {
    const auto state = maps.projection().state();
    auto estimation = restored(stored(state_of(maps)), state);
    if (!estimation) return std::nullopt;
    for (std::size_t n = 0; n < state.robots.size(); ++n) {
        const auto poses = estimation->robots[n].poses.snapshot();
        EXPECT_EQ(poses.size(), state.robots[n].scan_poses.size());
        for (std::size_t k = 0; k < poses.size(); ++k) EXPECT_EQ(poses[k], state.robots[n].scan_poses[k]);
        EXPECT_EQ(estimation->robots[n].turns, state.robots[n].turns);
    }
    EXPECT_EQ(estimation->corrected, state.corrected);
    return LocalizedProjection(testing_support::restored(maps.projection()), std::move(estimation->poses),
                               estimation->shown, estimation->announced);
}

/// A log that grows, and its maps.
class GrowingLog {
public:
    /// @param every  the maps are written to bytes and read again after this number of entries, if the newest one is a
    ///               scan, and after each entry of another kind; 0: never
    explicit GrowingLog(std::size_t every) : every_(every) {}

    void add(LogEntry entry) {
        log_.push_back(entry);
        double work = HUGE_VAL;
        ASSERT_TRUE(maps_->apply(entry, work).value());
        if (std::holds_alternative<MapsCorrected>(entry)) show_corrected();
        const bool is_scan = std::holds_alternative<ScanTaken>(entry);
        if (every_ == 0 || (is_scan && log_.size() % every_ != 0)) return;
        look();
        auto again = through_bytes(*maps_);
        ASSERT_TRUE(again);
        maps_.emplace(std::move(*again));
    }

    void join(RobotIndex robot, const slam::Drive& drive, Poses poses) {
        add(RobotJoined{robot, "robot " + std::to_string(robot), {}, {}, poses});
        add(SensorDescribed{robot, drive.laser});
    }

    /// Adds a scan. The maps are corrected 30 entries after it is due.
    void drive(RobotIndex robot, const slam::Drive& drive, std::size_t n, Poses poses) {
        Scan scan = drive.scans[n];
        scan.seq = maps_->projection().robots()[robot].last_seq + 1;
        scan.stamp = 0.1 * static_cast<double>(scan.seq);
        if (n % 2 == 0) scan.duration = 0.05;
        scan.pose.reset();
        if (poses == Poses::kMap) scan.pose = compose(inverse(drive.truth.front()), drive.truth[n]);
        if (poses == Poses::kOdometry) scan.odometry = drive.odometry[n];
        add(ScanTaken{robot, scan, maps_->projection().is_localize_only()});
        if (!maps_->is_outdated()) {
            outdated_ = 0;
        } else if (++outdated_ > 30) {
            add(MapsCorrected{maps_->poses().corrected()});
        }
    }

    [[nodiscard]] LocalizedProjection& maps() { return *maps_; }

    // How often the maps were written and read in special situations.
    std::size_t open = 0;      // scans of which are not decided
    std::size_t unlocated = 0; // robots that are not located
    std::size_t outdated = 0;  // maps that are to be corrected

private:
    void look() {
        outdated += maps_->is_outdated() ? 1 : 0;
        for (RobotIndex robot = 0; robot < maps_->projection().robots().size(); ++robot) {
            const auto* poses = maps_->poses().find(robot);
            if (poses == nullptr) continue;
            open += poses->estimator().decided_count() < poses->estimator().scan_count() ? 1 : 0;
            unlocated += poses->localization().state == LocalizationState::kUnlocated ? 1 : 0;
        }
    }

    void show_corrected() {
        const auto poses = maps_->poses().in_maps();
        mapping::Projection corrected(maps_->projection().config());
        for (LogEntry entry : log_) {
            poses.place(entry);
            ASSERT_TRUE(corrected.apply(entry));
        }
        maps_->replace(std::move(corrected), maps_->poses().corrected());
    }

    std::size_t every_;
    std::size_t outdated_ = 0; // scans since the maps are
    std::vector<LogEntry> log_;
    std::optional<LocalizedProjection> maps_{mapping::Projection(mapping::resolve({.cell_size = 0.1}).value())};
};

} // namespace scanloom::localization
