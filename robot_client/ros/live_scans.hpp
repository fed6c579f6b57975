#pragma once

#include "robot_client/recordings/recording_lists.hpp"
#include "robot_client/ros/scan_observer.hpp"
#include "robot_client/ros/stamp_gaps.hpp"
#include "robot_client/sources/source.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// How the messages of a live robot are read.
struct LiveScanOptions {
    RecordingOptions robot;
    std::chrono::milliseconds survey{2'000};         ///< how long messages are watched before lasers are chosen
    std::chrono::milliseconds survey_max{5'000};     ///< likewise while poses, mounts or what `robot` names are missing
    std::chrono::milliseconds transform_wait{1'000}; ///< how long a scan waits for the transforms after it
};

/// Scans from the messages of a live robot, with poses and mounts as for a recording (see choose_lasers()).
///
/// First it surveys the robot: from the first scan on, messages are watched for a short time. Then choose() decides
/// which lasers, frames and poses are used; scans of the survey are kept. A scan waits a short time for transforms
/// after it, because its pose is interpolated; a scan that gets none is skipped. Memory is bounded: transforms of some
/// seconds and kWaitingMax scans.
///
/// It is driven by add() and take(), and has no clock: `now` must not decrease.
/// Threads: one at a time.
class LiveScans {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Most scans that wait for their transforms; beyond that the oldest are skipped.
    static constexpr std::size_t kWaitingMax = 512;

    explicit LiveScans(LiveScanOptions options);

    /// Returns whether messages of a topic are needed.
    [[nodiscard]] bool needs(const RecordedTopic& topic) const;

    /// Returns whether a topic is of a laser that appeared after choose(), so that its scans are not used.
    [[nodiscard]] bool is_late_laser(const RecordedTopic& topic) const;

    /// Adds a message of a topic that is needed.
    /// @param received  when the sender received it, by the robot's clock, in ns
    /// @return the stamp of a scan; nullopt: the message is none
    std::optional<RosTime> add(const RecordedTopic& topic, RosTime received, std::string_view bytes, Time now);

    /// Notes that no messages come for some time: scans wait longer for their transforms.
    void interrupt() { is_interrupted_ = true; }
    /// Notes that messages come again. Gaps in their stamps are no fault of the sender.
    void resume(Time now);

    /// States what the poses must be. Call it before choose().
    void expect_poses(Poses poses) { options_.robot.poses = poses; }

    /// Returns when the survey ends; nullopt while a scan of a laser that the options name, or any scan, is missing.
    [[nodiscard]] std::optional<Time> survey_end() const { return survey_end_; }
    /// Returns the topics that the options name and that have sent no scan so far.
    [[nodiscard]] std::vector<std::string> missing_topics() const;

    /// Chooses lasers, frames and poses when the survey has ended, once.
    /// @return whether it is done; false: something is missing that may still come, and survey_end() is later now
    /// Errors: those of choose_lasers().
    [[nodiscard]] Result<bool> choose(Time now);
    /// Returns the choice. Precondition: choose() has returned true.
    [[nodiscard]] const LaserChoice& choice() const { return *choice_; }
    /// Returns the name of the odometry topic that poses come from; empty: from transforms. Precondition: as choice().
    [[nodiscard]] std::string odom_topic() const;
    /// Returns the frames above one of the robot by the newest transforms, itself first. Precondition: as choice().
    [[nodiscard]] std::vector<std::string> ancestors(const std::string& frame) const { return tree_.ancestors(frame); }

    /// Returns the next scan whose place is known. Skips scans whose places will not be known.
    /// @param now  Time::max(): no further transforms come
    [[nodiscard]] std::optional<Observation> take(Time now);
    /// Returns when a scan stops waiting, so that take() skips it; nullopt: none waits.
    [[nodiscard]] std::optional<Time> next_deadline() const;

    /// Returns sentences for people that are new.
    [[nodiscard]] std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }

    /// Returns the number of scans that were skipped, by the reason.
    [[nodiscard]] const std::map<std::string, std::uint64_t>& skipped() const noexcept { return skipped_; }
    /// Returns the number of scans that were taken.
    [[nodiscard]] std::uint64_t taken() const noexcept { return taken_; }
    /// Returns the number of gaps in the stamps of lasers.
    [[nodiscard]] std::uint64_t gaps() const;
    /// Returns the number of scans that are missing in these gaps, by estimation.
    [[nodiscard]] std::uint64_t missing() const;

private:
    struct Waiting {
        RosLaserScan scan;
        RosTime received;
        std::size_t topic;
        Time until;
    };

    /// A topic of scans.
    struct Laser {
        RangeHabits habits; // after the survey
        StampGaps gaps;
    };

    [[nodiscard]] std::optional<RosTime> add_scan(std::size_t topic, const RecordedMessage& message, Time now);
    void add_transforms(const RecordedTopic& topic, const RecordedMessage& message);
    [[nodiscard]] bool may_be_used(const RecordedTopic& topic) const;
    [[nodiscard]] bool lacks_something(const Result<LaserChoice>& choice) const;
    void prune_tree();
    void note_gap(const std::string& topic, std::uint64_t missing);
    [[nodiscard]] const FoundLaser* found_laser(std::size_t topic) const;

    LiveScanOptions options_;
    TopicList topics_;
    Surveyor survey_;
    std::optional<Time> survey_end_;
    Time survey_end_max_{};
    std::optional<LaserChoice> choice_;
    FrameTree tree_;
    std::set<std::string> laser_frames_;
    std::size_t pruned_at_ = 0;           // size of the tree at which other frames are removed next
    std::map<std::size_t, Laser> lasers_; // by topic
    std::deque<Waiting> waiting_;
    ScanObserver observer_;
    std::map<std::string, std::uint64_t> skipped_;
    std::uint64_t taken_ = 0;
    std::vector<std::string> notes_;
    bool is_gap_noted_ = false;
    bool is_interrupted_ = false;
};

} // namespace scanloom::robot
