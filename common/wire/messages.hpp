#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/scan/session_options.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The frames of the robot link (proto/scanloom/v1/frame.proto) as plain values.
/// Protobuf stops here: nothing outside common/wire sees its types.
namespace scanloom::wire {

inline constexpr std::uint32_t kProtocolVersion = 1;

struct Hello {
    std::uint32_t protocol_version = kProtocolVersion;
    std::string robot;
    std::string session;
    std::string token;
    std::optional<SessionOptions> create;
    std::string client;
    std::string source; ///< what is streamed, if it can be streamed again; see frame.proto

    friend bool operator==(const Hello&, const Hello&) = default;
};

struct Limits {
    std::uint32_t frame_size_max = 0;
    std::uint32_t beams_max = 0;
    std::uint32_t scans_per_batch_max = 0;

    friend bool operator==(const Limits&, const Limits&) = default;
};

struct Welcome {
    std::string session_id;
    std::uint64_t last_durable_seq = 0;
    Limits limits;
    std::uint64_t credit_bytes = 0;

    friend bool operator==(const Welcome&, const Welcome&) = default;
};

struct ScanBatch {
    std::vector<Scan> scans;

    friend bool operator==(const ScanBatch&, const ScanBatch&) = default;
};

struct Ack {
    std::uint64_t durable_seq = 0;
    std::uint64_t applied_seq = 0;
    std::uint64_t credit_bytes = 0;

    friend bool operator==(const Ack&, const Ack&) = default;
};

/// An Error frame: the failure, and whether the same Hello may succeed later.
struct LinkError {
    Error error;
    bool retryable = false;

    friend bool operator==(const LinkError&, const LinkError&) = default;
};

struct Ping {
    std::uint64_t nonce = 0;

    friend bool operator==(const Ping&, const Ping&) = default;
};

struct Pong {
    std::uint64_t nonce = 0;

    friend bool operator==(const Pong&, const Pong&) = default;
};

struct Goodbye {
    std::string reason;

    friend bool operator==(const Goodbye&, const Goodbye&) = default;
};

struct Correction {
    Pose2 T_map_odom;
    std::uint64_t revision = 0;

    friend bool operator==(const Correction&, const Correction&) = default;
};

using Message = std::variant<Hello, Welcome, Sensor, ScanBatch, Ack, LinkError, Ping, Pong, Goodbye, Correction>;

/// Name of the frame a message travels in, as proto/ spells it ("scan_batch").
[[nodiscard]] std::string_view name_of(const Message& message) noexcept;

/// Reads one frame body (without its length prefix) and checks every value in it.
/// Post    poses, angles, lengths and stamps are finite and within common/scan/limits.hpp;
///         names are valid; every scan has as many intensities and explicit angles as ranges,
///         and no beam beyond a full turn.
/// Errors  kMalformed: not a Frame, or one without a body; kInvalidField, kTooLarge: the message
///         names the field, as in "scan_batch.scans[3].pose.x is nan".
/// Thread  any.
[[nodiscard]] Result<Message> decode(std::string_view body);

/// Appends the message to `out` as a frame, length prefix included.
void encode(const Message& message, std::string& out);

/// Checks that a scan fits the sensor it names: explicit angles of the sensor need as many ranges,
/// uniform ones must not exceed a full turn.
[[nodiscard]] Result<> check_scan(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::wire
