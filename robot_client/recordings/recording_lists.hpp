#pragma once

#include "robot_client/recordings/recording.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// What the readers of all formats keep of a recording, in bounded memory.
namespace scanloom::robot {

/// Losses of a recording: the first ones, and the number of all.
class LossList {
public:
    void add(std::uint64_t offset, std::string reason) {
        ++count_;
        if (listed_.size() < kRecordingLossesListed) listed_.push_back({offset, std::move(reason)});
    }

    [[nodiscard]] const std::vector<RecordingLoss>& listed() const noexcept { return listed_; }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

private:
    std::vector<RecordingLoss> listed_;
    std::uint64_t count_ = 0;
};

/// Topics of a recording, each once.
class TopicList {
public:
    static constexpr std::size_t kTopicsMax = 10'000;
    static constexpr std::size_t kNameBytesMax = 4096;

    /// Returns the index of the topic, which is added if it is new; nullopt if there are too many, or a name is too
    /// long.
    [[nodiscard]] std::optional<std::size_t> add(RecordedTopic topic) {
        if (topic.name.size() > kNameBytesMax || topic.type.size() > kNameBytesMax) return std::nullopt;
        auto key = std::tuple(topic.name, topic.type, topic.encoding);
        if (const auto known = indices_.find(key); known != indices_.end()) return known->second;
        if (topics_.size() == kTopicsMax) return std::nullopt;
        indices_.emplace(std::move(key), topics_.size());
        topics_.push_back(std::move(topic));
        return topics_.size() - 1;
    }

    [[nodiscard]] const std::vector<RecordedTopic>& all() const noexcept { return topics_; }

private:
    std::vector<RecordedTopic> topics_;
    std::map<std::tuple<std::string, std::string, MessageEncoding>, std::size_t> indices_;
};

/// Returns a message type without the "msg/" that ROS 2 has in it: "sensor_msgs/LaserScan" of
/// "sensor_msgs/msg/LaserScan".
[[nodiscard]] inline std::string type_without_msg(std::string_view type) {
    constexpr std::string_view kMiddle = "/msg/";
    const auto at = type.find(kMiddle);
    if (at == std::string_view::npos) return std::string(type);
    return std::string(type.substr(0, at + 1)).append(type.substr(at + kMiddle.size()));
}

/// Returns a word of a file or a peer for messages: shortened, and without characters that a terminal could interpret.
[[nodiscard]] inline std::string shown_word(std::string_view word, std::size_t shown_max = 40) {
    std::string text(word.substr(0, shown_max));
    std::ranges::replace_if(
        text, [](char c) { return c < ' ' || c > '~'; }, '?');
    return word.size() > shown_max ? text + "..." : text;
}

/// Returns a time in ns; times beyond the year 2262 become its last one.
[[nodiscard]] inline std::int64_t recorded_time(std::uint64_t nanoseconds) {
    constexpr std::uint64_t kLast = std::numeric_limits<std::int64_t>::max();
    return static_cast<std::int64_t>(std::min(nanoseconds, kLast));
}

} // namespace scanloom::robot
