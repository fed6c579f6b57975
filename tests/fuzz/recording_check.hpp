#pragma once

#include "robot_client/recordings/recorded_bytes.hpp"
#include "robot_client/recordings/recording.hpp"
#include "tests/fuzz/check.hpp"

#include <string>
#include <string_view>

namespace scanloom::fuzz {

/// Reads a recording as a whole and checks what every reader promises.
/// @return a digest of its messages
inline std::size_t read_recording(robot::Recording& recording) {
    std::size_t digest = 0;
    std::size_t topics = 0;
    for (;;) {
        const auto message = recording.next();
        check(message.has_value(), "memory can be read to the end");
        check(recording.topics().size() >= topics, "topics are only added");
        topics = recording.topics().size();
        const auto progress = recording.progress();
        check(progress.bytes <= progress.bytes_total, "no more is read than there is");
        if (!*message) break;
        check((*message)->topic < topics, "the topic of every message is known");
        check((*message)->bytes.size() <= robot::kRecordedBytesMax, "messages have a largest size");
        digest = digest * 31 + std::hash<std::string_view>()((*message)->bytes) + (*message)->topic;
        digest = digest * 31 + static_cast<std::size_t>((*message)->time);
    }
    check(recording.losses().size() <= robot::kRecordingLossesListed, "only the first losses are listed");
    check(recording.losses().size() <= recording.losses_count(), "all losses are counted");
    for (const auto& loss : recording.losses()) check(!loss.reason.empty(), "every loss has its reason");
    check(!*recording.next(), "the end is final");
    return digest;
}

/// Reads a file twice by open_rosbag() or open_mcap().
template <class Open>
void check_recording(Open open, std::string_view file) {
    auto recording = open(std::make_unique<robot::BytesInMemory>(file), "fuzz");
    if (!recording) {
        check(!recording.error().message.empty(), "every error has a message");
        return;
    }
    const auto digest = read_recording(**recording);
    auto again = open(std::make_unique<robot::BytesInMemory>(file), "fuzz");
    check(again.has_value() && read_recording(**again) == digest, "the same file yields the same messages");
}

} // namespace scanloom::fuzz
