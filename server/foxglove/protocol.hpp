#pragma once

#include "common/error/error.hpp"
#include "server/foxglove/schemas.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// The WebSocket protocol of Foxglove, version 1, as far as a server needs it that only shows data.
/// Source: https://github.com/foxglove/ws-protocol, docs/spec.md.
namespace scanloom::foxglove {

/// Names of the protocol in Sec-WebSocket-Protocol, which mean the same; the preferred one is first.
inline constexpr std::string_view kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A viewer wants the messages of channels, each with an id of its own.
struct Subscribe {
    struct Subscription {
        std::uint32_t id = 0;
        std::uint32_t channel = 0;
    };
    std::vector<Subscription> subscriptions;
};

/// A viewer no longer wants the messages of these subscriptions.
struct Unsubscribe {
    std::vector<std::uint32_t> ids;
};

/// Decodes a text message of a viewer.
/// Errors: kMalformed if it is not a JSON object with a known op and its fields; kUnsupportedVersion if its op needs a
///     capability that this server does not announce.
[[nodiscard]] Result<std::variant<Subscribe, Unsubscribe>> decode_request(std::string_view text);

/// A channel as it is announced.
struct Advertised {
    std::uint32_t id = 0;
    std::string_view topic;
    Message message;
};

/// Returns the first message to a viewer. It announces no capabilities.
/// @param name        for people
/// @param session_id  viewers forget what they have if it changes
[[nodiscard]] std::string server_info_text(std::string_view name, std::string_view session_id);

/// Returns the announcement of further channels.
[[nodiscard]] std::string advertise_text(std::span<const Advertised> channels);

/// Returns a remark for the people in front of the viewer.
[[nodiscard]] std::string warning_text(std::string_view message);

/// Returns the beginning of the binary message with the data of a subscription; the message of the topic follows.
/// @param log_time  nanoseconds
[[nodiscard]] std::string data_head(std::uint32_t subscription, std::int64_t log_time);

} // namespace scanloom::foxglove
