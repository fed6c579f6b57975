#pragma once

#include "robot_client/recordings/mcap.hpp"
#include "robot_client/recordings/recorded_bytes.hpp"
#include "robot_client/recordings/recording.hpp"
#include "robot_client/recordings/rosbag.hpp"
#include "tests/support/written_recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

/// Reads recordings of tests as a whole.
namespace scanloom::robot {

inline std::filesystem::path real_recording(const std::string& name) {
    return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/recordings" / name;
}

/// A message that was read.
struct ReadMessage {
    std::string topic;
    std::int64_t time = 0;
    std::string bytes;

    friend bool operator==(const ReadMessage&, const ReadMessage&) = default;
};

/// All of a recording.
struct WholeRecording {
    std::vector<ReadMessage> messages;
    std::vector<RecordedTopic> topics;
    std::vector<RecordingLoss> losses;
    std::uint64_t losses_count = 0;
    ReadProgress progress;

    [[nodiscard]] std::map<std::string, std::size_t> counts() const {
        std::map<std::string, std::size_t> counts;
        for (const auto& message : messages) ++counts[message.topic];
        return counts;
    }
};

inline WholeRecording read_whole(Recording& recording) {
    WholeRecording whole;
    for (;;) {
        const auto message = recording.next();
        EXPECT_TRUE(message) << message.error().message;
        if (!message || !*message) break;
        EXPECT_LT((*message)->topic, recording.topics().size());
        whole.messages.push_back(
            {recording.topics().at((*message)->topic).name, (*message)->time, std::string((*message)->bytes)});
        EXPECT_LE(recording.progress().bytes, recording.progress().bytes_total);
    }
    whole.topics = recording.topics();
    whole.losses = recording.losses();
    whole.losses_count = recording.losses_count();
    whole.progress = recording.progress();
    EXPECT_FALSE(*recording.next()) << "the end is final";
    EXPECT_EQ(recording.losses_count(), whole.losses_count);
    return whole;
}

/// Reads bytes by one of the functions open_rosbag() and open_mcap().
template <class Open>
WholeRecording read_bytes(Open open, std::string_view bytes) {
    auto recording = open(std::make_unique<BytesInMemory>(bytes), "test");
    EXPECT_TRUE(recording) << recording.error().message;
    return recording ? read_whole(**recording) : WholeRecording{};
}

inline WholeRecording read_bag(std::string_view bytes) { return read_bytes(open_rosbag, bytes); }
inline WholeRecording read_mcap(std::string_view bytes) { return read_bytes(open_mcap, bytes); }

inline ReadMessage as_read(const testing_support::WrittenMessage& message) {
    return {message.topic, message.time, message.bytes};
}

inline std::vector<ReadMessage> all_of(const testing_support::WrittenRecording& recording) {
    std::vector<ReadMessage> messages;
    for (const auto& message : recording.messages) messages.push_back(as_read(message));
    return messages;
}

/// Returns whether `wanted` are all in `messages`, in the same order.
inline bool has_in_order(const std::vector<ReadMessage>& messages, const std::vector<ReadMessage>& wanted) {
    std::size_t found = 0;
    for (const auto& message : messages) found += found < wanted.size() && message == wanted[found] ? 1U : 0U;
    return found == wanted.size();
}

/// Expects that a recording that is cut at any byte yields exactly its first messages, and all that are whole.
template <class Read>
void expect_cuts_yield_whole_messages(const testing_support::WrittenRecording& recording, Read read, std::size_t from) {
    const auto all = all_of(recording);
    for (std::size_t size = from; size <= recording.file.size(); ++size) {
        const auto cut = read(std::string_view(recording.file).substr(0, size));
        const auto whole =
            std::ranges::count_if(recording.messages, [&](const auto& each) { return each.end <= size; });
        ASSERT_GE(cut.messages.size(), static_cast<std::size_t>(whole)) << "cut at " << size;
        ASSERT_LE(cut.messages.size(), all.size()) << "cut at " << size;
        ASSERT_TRUE(std::equal(cut.messages.begin(), cut.messages.end(), all.begin())) << "cut at " << size;
        ASSERT_TRUE(cut.messages.size() == all.size() || cut.losses_count > 0) << "cut at " << size;
    }
}

/// Returns whether those of `wanted` that are not in `messages` are inside another message: its damaged length led by
/// chance exactly to a later record, which no reader can notice.
inline bool are_swallowed(const std::vector<ReadMessage>& messages, const std::vector<ReadMessage>& wanted) {
    return std::ranges::all_of(wanted, [&](const ReadMessage& lost) {
        return std::ranges::count(messages, lost) > 0 || std::ranges::any_of(messages, [&](const ReadMessage& other) {
                   return other.bytes.size() > lost.bytes.size() + 20 &&
                          other.bytes.find(lost.bytes) != std::string::npos;
               });
    });
}

/// Expects that damage at any byte costs only the record, or the compressed chunk, that it is in.
template <class Read>
void expect_damage_stays_local(const testing_support::WrittenRecording& recording, Read read, std::size_t from) {
    std::string file = recording.file;
    std::size_t swallowed = 0;
    for (std::size_t at = from; at < file.size(); ++at) {
        const auto holds = [&](const auto& each) { return at >= each.begin && at < each.end; };
        std::vector<std::string> hidden; // topics whose description is damaged
        for (const auto& part : recording.descriptions) {
            if (holds(part)) hidden.push_back(part.topic);
        }
        std::vector<ReadMessage> wanted;
        for (const auto& message : recording.messages) {
            const bool is_checksum = message.checksum_at > 0 && at - message.checksum_at < 4;
            if (holds(message) || is_checksum || std::ranges::count(hidden, message.topic) > 0) continue;
            wanted.push_back(as_read(message));
        }
        for (const char mask : {'\x01', '\x40', '\xff'}) {
            file[at] = static_cast<char>(file[at] ^ mask);
            const auto found = read(file);
            const bool has_all = has_in_order(found.messages, wanted);
            swallowed += has_all ? 0U : 1U;
            ASSERT_TRUE(has_all || are_swallowed(found.messages, wanted))
                << "damaged at " << at << " by " << int{mask} << ": " << found.messages.size() << " instead of "
                << wanted.size() << (found.losses.empty() ? "" : ", " + found.losses[0].reason);
            file[at] = recording.file[at];
        }
    }
    EXPECT_LE(swallowed, 5U);
}

} // namespace scanloom::robot
