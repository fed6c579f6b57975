#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The frames of the Foxglove WebSocket protocol, version 1, as a client receives and sends them.
///
/// Source: the specification in github.com/foxglove/ws-protocol, docs/spec.md; foxglove-sdk, protocol/v1.
namespace scanloom::robot::foxglove {

/// Names of the protocol in a WebSocket's handshake: the current one, and that of older bridges. Their frames are
/// equal.
inline constexpr std::string_view kSubprotocols = "foxglove.sdk.v1, foxglove.websocket.v1";

/// Longest text frame that is decoded. An advertisement with the definitions of 1,000 types has about 3 MB.
inline constexpr std::size_t kTextBytesMax = std::size_t{8} << 20;

/// What a bridge says of itself, first of all.
struct ServerInfo {
    std::string name;
    std::vector<std::string> capabilities;
    std::vector<std::string> supported_encodings; ///< of messages that clients publish
};

/// A topic that a bridge offers.
struct Channel {
    std::uint64_t id = 0;
    std::string topic;
    std::string encoding;
    std::string schema_name;

    friend bool operator==(const Channel&, const Channel&) = default;
};

struct Advertise {
    std::vector<Channel> channels;
    std::uint64_t refused = 0; ///< channels without a valid id, topic, encoding or schema name
};

struct Unadvertise {
    std::vector<std::uint64_t> ids;
};

/// A message of a bridge for people.
struct Status {
    enum class Level { kInfo, kWarning, kError };
    Level level = Level::kInfo;
    std::string message;
};

/// A message of a subscribed channel.
struct MessageData {
    std::uint32_t subscription = 0;
    std::uint64_t log_time = 0; ///< ns
    std::string_view payload;   ///< part of the decoded frame
};

/// The time of the robot, which may be a simulation's.
struct ServerTime {
    std::uint64_t nanoseconds = 0;
};

/// A frame of the protocol that a client of topics does not need.
struct Unneeded {};

using Frame = std::variant<Unneeded, ServerInfo, Advertise, Unadvertise, Status, MessageData, ServerTime>;

/// Decodes a text frame.
/// Errors: kTooLarge, kMalformed; the message says in few words what is wrong, the same words for all such frames.
[[nodiscard]] Result<Frame> decode_text(std::string_view text);

/// Decodes a binary frame.
/// Errors: kMalformed, with a message as of decode_text().
[[nodiscard]] Result<Frame> decode_binary(std::string_view bytes);

/// A subscription to a channel. The client chooses its id.
struct Subscription {
    std::uint32_t id = 0;
    std::uint64_t channel = 0;
};

[[nodiscard]] std::string encode_subscribe(const std::vector<Subscription>& subscriptions);
[[nodiscard]] std::string encode_unsubscribe(const std::vector<std::uint32_t>& ids);

/// Encodes the announcement of a channel on which this client publishes.
/// @param channel  its id is at most 2^32 - 1
[[nodiscard]] std::string encode_advertise(const Channel& channel);

/// Encodes a message of such a channel, as a binary frame.
[[nodiscard]] std::string encode_message(std::uint32_t channel, std::string_view payload);

} // namespace scanloom::robot::foxglove
