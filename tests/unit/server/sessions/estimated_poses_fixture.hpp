#pragma once

#include "tests/unit/core/slam/drive.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::sessions {

using localization::Estimate;
using localization::StampedPose;

/// A lap of a corridor and a quarter, with odometry that drifts by metres.
inline const slam::Drive& lap() {
    static const slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

/// The maps and the poses of a session at rest.
struct State {
    std::string digest;
    std::vector<StampedPose> poses;

    friend bool operator==(const State&, const State&) = default;
};

/// A link that also records where its robot is.
struct LocatedLink : RecordedLink {
    void on_located(const Located& where) override { located.push_back(where); }

    std::vector<Located> located;
};

class EstimatedPosesTest : public SessionTest {
protected:
    /// Joins the robot and sends the scans that the session does not have.
    std::shared_ptr<LocatedLink> drive_on(std::size_t scans_at_once, std::size_t end = lap().scans.size(),
                                          Poses poses = Poses::kOdometry) {
        return drive_on("robot", lap(), scans_at_once, end, poses);
    }

    std::shared_ptr<LocatedLink> drive_on(const std::string& robot, const slam::Drive& drive, std::size_t scans_at_once,
                                          std::size_t end, Poses poses = Poses::kOdometry) {
        const auto link = std::make_shared<LocatedLink>();
        std::uint64_t stored = 0;
        session_->join({robot, {}, {}, poses}, link,
                       [&](const Result<Joined>& joined) { stored = joined.value().last_durable_seq; });
        run();
        session_->submit(link, drive.laser, 0);
        for (std::size_t n = stored; n < end;) {
            std::vector<Scan> scans;
            for (; n < end && scans.size() < scans_at_once; ++n) {
                scans.push_back(drive.scans[n]);
                scans.back().seq = n + 1;
                scans.back().pose.reset();
                if (poses == Poses::kMap) scans.back().pose = drive.odometry[n];
                if (poses == Poses::kOdometry) scans.back().odometry = drive.odometry[n];
            }
            session_->submit(link, std::move(scans), 0);
            run();
        }
        EXPECT_THAT(link->failures, testing::IsEmpty());
        EXPECT_EQ(find_robot(robot).last_seq, end);
        return link;
    }

    [[nodiscard]] const mapping::RobotState& find_robot(const std::string& name) {
        return *std::ranges::find(session_->snapshot()->robots, name, &mapping::RobotState::name);
    }

    [[nodiscard]] State state() {
        std::vector<StampedPose> poses;
        session_->read_poses([&](const auto& estimated) { poses = estimated.trajectory(0, Estimate::kNewest); });
        run();
        return {digest(), std::move(poses)};
    }

    /// Continues with a session that has the first entries of the log.
    void crash_after(Revision end) {
        auto entries = store::entries_after(log_, id_, 0).value();
        entries.resize(end);
        id_ = log_.create_session("an unused record").value();
        log_.append(id_, 1, std::move(entries), [](const Result<>& appended) { EXPECT_TRUE(appended); });
        start_session();
        if (is_outdated_) session_->correct_maps();
    }

    void start_session() {
        auto recovered = recover(log_, id_, config_, false).value();
        is_outdated_ = recovered.maps.is_outdated();
        session_ = std::make_shared<Session>(SessionInfo{id_, "lab", 0.0, config_}, std::move(recovered.maps),
                                             recovered.checkpointed, log_, compute_.get_executor(), counters_, limits_);
    }

    /// Returns the revisions of the entries that announce corrected maps.
    [[nodiscard]] std::vector<Revision> announcements() {
        std::vector<Revision> revisions;
        const auto entries = logged();
        for (std::size_t n = 0; n < entries.size(); ++n) {
            if (std::holds_alternative<MapsCorrected>(entries[n])) revisions.push_back(n + 1);
        }
        return revisions;
    }

    /// Returns the digest of the maps that are made from the log with the poses that the session's maps show.
    [[nodiscard]] std::string digest_with_poses_in_maps() {
        mapping::Projection maps(config_);
        for (auto entry : logged()) {
            session_->snapshot()->scan_poses.place(entry);
            EXPECT_TRUE(maps.apply(entry));
        }
        return testing_support::digests_of(maps.snapshot());
    }

    bool is_outdated_ = false; // maps of the recovered session
};

} // namespace scanloom::sessions
