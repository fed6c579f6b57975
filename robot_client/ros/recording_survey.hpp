#pragma once

#include "common/error/error.hpp"
#include "common/hash/sha256.hpp"
#include "robot_client/recordings/recording.hpp"
#include "robot_client/ros/frame_tree.hpp"
#include "robot_client/ros/laser_conversion.hpp"
#include "robot_client/ros/stamp_epochs.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Transforms that a recording may have between its lasers and its fixed frames; they take about 0.5 GB.
inline constexpr std::size_t kTransformsMax = 4'000'000;

/// A topic of a recording.
struct SurveyedTopic : RecordedTopic {
    std::uint64_t messages = 0;
    std::uint64_t malformed = 0; ///< of these
    RosTime first = 0;           ///< when the first message was recorded
    RosTime last = 0;
    std::map<std::string, std::uint64_t> frames; ///< of messages with scans or odometry: count by frame
};

/// A message of a laser.
struct SurveyedScan {
    std::uint32_t topic = 0;
    std::uint32_t frame = 0;   ///< index in RecordingSurvey::frames
    std::uint32_t problem = 0; ///< index in RecordingSurvey::problems
    std::uint32_t epoch = 0;   ///< of `middle`
    RosTime middle = 0;        ///< when its middle was taken
};

/// What was found of a laser's topic.
struct SurveyedLaser {
    RangeHabits habits;
    Sha256 hash; ///< of its scans
};

/// Parts of a file that could not be read.
struct RecordingLosses {
    std::uint64_t count = 0;
    std::vector<RecordingLoss> first; ///< at most kRecordingLossesListed of them
};

/// Returns the first losses, as sentences for people, and how many more there are.
[[nodiscard]] std::vector<std::string> texts_of(const RecordingLosses& losses);

/// What a recording contains, or what a live robot has sent so far.
struct RecordingSurvey {
    std::string_view origin = "recording"; ///< what it is of, for messages: a literal
    std::vector<SurveyedTopic> topics;
    std::vector<SurveyedScan> scans; ///< all messages of all lasers, in the order of the file
    std::vector<std::string> frames;
    std::vector<std::string> problems{""};         ///< why scans cannot be used; the first is none
    std::map<std::size_t, SurveyedLaser> lasers;   ///< by topic
    std::map<std::string, FrameTree> trees;        ///< of /tf and /tf_static, by namespace; until choose_lasers()
    FrameTree tree;                                ///< what choose_lasers() has joined of these
    std::map<std::size_t, FrameTree> odometry;     ///< by topic: the frame of the robot in that of the odometry
    std::map<std::size_t, std::string> odom_child; ///< by topic
    std::size_t unusable_transforms = 0;           ///< not finite, without a rotation, or without a child
    RecordingLosses losses;
};

/// Returns whether messages of this type are scans of a laser.
[[nodiscard]] bool is_laser(const RecordedTopic& topic);

/// Returns whether messages of this type are transforms.
[[nodiscard]] bool has_transforms(const RecordedTopic& topic);

/// Returns whether messages of this topic are transforms that hold at all times.
[[nodiscard]] bool has_static_transforms(const RecordedTopic& topic);

/// Returns the namespace of a topic: "/robot" of "/robot/tf".
[[nodiscard]] std::string namespace_of(std::string_view topic);

/// Returns how many characters the namespaces of two topics have in common.
[[nodiscard]] std::size_t common_namespace(std::string_view a, std::string_view b);

/// Decodes the pose of a nav_msgs/Odometry. A robot's frame without a name gets one; a pose without a stamp is of the
/// time when it was recorded.
/// Errors: those of decode_odometry().
[[nodiscard]] Result<RosTransform> odometry_of(const RecordedMessage& message, MessageEncoding encoding);

/// Collects what messages contain.
/// Threads: one at a time.
class Surveyor {
public:
    Surveyor() = default;
    /// @param kept  see FrameTree::forget_before_newest(): for messages of a live robot
    explicit Surveyor(RosTime kept) : kept_(kept) {}

    /// Adds a message.
    /// @param topics  all topics so far: those of the call before, then new ones
    /// Errors: kTooLarge if there are more than kTransformsMax transforms between lasers and fixed frames, or more than
    ///         2^32 - 2 scans.
    [[nodiscard]] Result<> add(const std::vector<RecordedTopic>& topics, const RecordedMessage& message);

    /// Returns what was found.
    /// @param topics  all topics, also those without messages
    [[nodiscard]] RecordingSurvey finish(const std::vector<RecordedTopic>& topics) &&;

private:
    void add_laser(SurveyedTopic& topic, const RecordedMessage& message);
    void add_odometry(SurveyedTopic& topic, const RecordedMessage& message);
    void add_transforms(SurveyedTopic& topic, const RecordedMessage& message);
    void add_topics(const std::vector<RecordedTopic>& topics);
    [[nodiscard]] Result<> limit_transforms();
    /// Returns the epoch of a stamp. A live robot has one: what was before its clock was set back is forgotten.
    [[nodiscard]] std::uint32_t epoch_of(const RecordedMessage& message, const std::string& child, RosTime stamp) {
        return kept_ ? 0 : epochs_.of(message.topic, child, stamp);
    }

    RecordingSurvey found_;
    std::optional<RosTime> kept_;
    StampEpochs epochs_;
    std::size_t pruned_at_ = 0; // number of transforms at which those that are not needed are removed next
};

/// Reads a whole recording once.
/// @param on_read  called after each message
/// Errors: those of open_recording(), Recording::next() and Surveyor::add().
[[nodiscard]] Result<RecordingSurvey> survey(const std::filesystem::path& path, const OnRead& on_read = {});

} // namespace scanloom::robot
