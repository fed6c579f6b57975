#pragma once

#include "common/link/client_protocol.hpp"
#include "robot_client/uplink/send_buffer.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::robot {

/// Returns the options of the robot `r1` in the session `s1`.
inline link::ClientProtocolOptions client_options() {
    link::ClientProtocolOptions options;
    options.hello.robot = "r1";
    options.hello.session = "s1";
    return options;
}

/// @param range_max In metres.
inline std::shared_ptr<const Sensor> half_turn_laser(double range_max = 10.0) {
    return std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 180}, 0.0, 0.0, range_max});
}

/// Returns a scan whose ranges are all 1 m.
inline Observation uniform_scan(std::shared_ptr<const Sensor> sensor, std::size_t beams = 180) {
    Observation made{std::move(sensor), {}};
    made.scan.ranges.assign(beams, 1000);
    return made;
}

/// A ClientProtocol and its SendBuffer, to which a test is the server. The protocol receives the server's frames in
/// pieces of at most `piece_bytes` bytes.
class ClientLink {
public:
    using Time = link::ClientProtocol::Time;

    ClientLink(link::ClientProtocolOptions options, Time now, std::size_t buffer_bytes_max = std::size_t{32} << 20)
        : buffer(buffer_bytes_max), protocol(std::move(options), buffer, now) {}

    void add(Observation observation, Time now) {
        buffer.push(std::move(observation));
        protocol.on_scans_added(1, now);
    }

    [[nodiscard]] std::optional<wire::LinkError> receive(const wire::Message& message, Time now) {
        std::string frame;
        wire::encode(message, frame);
        return receive_bytes(frame, now);
    }

    [[nodiscard]] std::optional<wire::LinkError> receive_bytes(std::string_view bytes, Time now) {
        while (!bytes.empty()) {
            const std::size_t count = std::min(piece_bytes, bytes.size());
            std::ranges::copy(std::as_bytes(std::span(bytes).first(count)), protocol.prepare(count).begin());
            if (auto failure = protocol.on_bytes(count, now)) return failure;
            bytes.remove_prefix(count);
        }
        return std::nullopt;
    }

    /// Returns the next frame that it sends now, if any.
    [[nodiscard]] std::optional<std::string> next_frame(Time now) {
        std::string frame;
        if (!protocol.append_next_frame(frame, now)) return std::nullopt;
        return frame;
    }

    /// Returns the messages that it sends now.
    [[nodiscard]] std::vector<wire::Message> sent(Time now) {
        std::vector<wire::Message> messages;
        while (const auto frame = next_frame(now))
            messages.push_back(*wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes)));
        return messages;
    }

    SendBuffer buffer;
    link::ClientProtocol protocol;
    std::size_t piece_bytes = 7;
};

} // namespace scanloom::robot
