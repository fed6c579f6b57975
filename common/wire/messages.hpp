#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/poses.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "common/scan/session_options.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The frames of the robot link as plain values. proto/scanloom/v1/frame.proto documents each field.
/// Code outside common/wire does not use protobuf's types.
namespace scanloom::wire {

inline constexpr std::uint32_t kProtocolVersion = 1;

struct Hello {
    std::uint32_t protocol_version = kProtocolVersion;
    std::string robot;
    std::string session;
    std::string token;
    std::optional<SessionOptions> create;
    std::string client;
    std::string source;                ///< identifies what is streamed, if it can be streamed again; see frame.proto
    std::optional<double> body_radius; ///< metres, above 0, at most kBodyRadiusMax
    Poses poses = Poses::kMap;         ///< what the robot knows of its poses

    friend bool operator==(const Hello&, const Hello&) = default;
};

struct Limits {
    std::uint32_t frame_size_max = 0; ///< bytes of a frame, without its length prefix
    std::uint32_t beams_max = 0;      ///< of a scan
    std::uint32_t scans_per_batch_max = 0;

    friend bool operator==(const Limits&, const Limits&) = default;
};

struct Welcome {
    std::string session_id;
    std::uint64_t last_durable_seq = 0;
    Limits limits;
    std::uint64_t credit_bytes = 0; ///< that may be sent without an acknowledgement
    bool zstd = false;              ///< whether the server accepts CompressedScanBatch

    friend bool operator==(const Welcome&, const Welcome&) = default;
};

struct ScanBatch {
    std::vector<Scan> scans;

    friend bool operator==(const ScanBatch&, const ScanBatch&) = default;
};

/// A compressed ScanBatch for slow links; see common/wire/compression.hpp.
struct CompressedScanBatch {
    std::uint32_t size = 0; ///< bytes of the frame body it holds
    std::string zstd;

    friend bool operator==(const CompressedScanBatch&, const CompressedScanBatch&) = default;
};

struct Ack {
    std::uint64_t durable_seq = 0;  ///< this scan and all earlier ones are durable
    std::uint64_t applied_seq = 0;  ///< this scan and all earlier ones are in the maps
    std::uint64_t credit_bytes = 0; ///< that may be sent without an acknowledgement

    friend bool operator==(const Ack&, const Ack&) = default;
};

/// An Error frame: the failure, and whether a retry with the same Hello may succeed.
struct LinkError {
    Error error;
    bool retryable = false;
    std::string address = {}; ///< with kNotOwner: where the session is, HOST:PORT; empty: not known

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

/// The pose of a robot's odometry frame in the map, as the server has estimated it: the answer to a LocateRequest, and
/// sent by itself to robots whose poses the server estimates.
struct Correction {
    Pose2 T_map_odom; ///< metres, radians; for Poses::kNone of the robot at its newest scan
    std::uint64_t revision = 0;
    double explained = 0.0;      ///< inlier ratio of the robot's points in the map, 0 to 1
    double position_sigma = 0.0; ///< metres, in the most uncertain direction
    double yaw_sigma = 0.0;      ///< radians
    LocalizationState state = LocalizationState::kGiven;
    std::optional<double> mount_yaw_error = {}; ///< radians: by how much the yaw of the laser's mount seems too large

    friend bool operator==(const Correction&, const Correction&) = default;
};

inline constexpr std::size_t kReplyPointsMax = 65'000; ///< of a path in a reply, so that it fits a frame
inline constexpr std::size_t kRegionPointsMax = 4096;

/// The reply to the request with the same `id`.
template <class T>
struct ReplyOf {
    std::uint64_t id = 0;
    std::uint64_t revision = 0; ///< of the maps
    Result<T> result;           ///< the result, or why there is none

    friend bool operator==(const ReplyOf&, const ReplyOf&) = default;
};

/// Straight lines from point to point. Metres, map frame.
struct Path {
    std::vector<Point2> points; ///< at least 1
    double length = 0.0;        ///< metres
    double cost = 0.0;          ///< metres, but a metre in danger counts 1 + danger_cost

    friend bool operator==(const Path&, const Path&) = default;
};

/// Asks for the cheapest path. decode() validates only the points of a request; handlers validate the rest.
struct PlanRequest {
    using Reply = ReplyOf<Path>;

    std::uint64_t id = 0;
    std::optional<Point2> start; ///< nullopt: where the robot's newest scan was taken
    Point2 goal{0.0, 0.0};       ///< metres, map frame
    bool allow_unknown = false;
    std::optional<double> body_radius; ///< metres
    std::optional<double> danger_cost; ///< additional metres for each metre in danger

    friend bool operator==(const PlanRequest&, const PlanRequest&) = default;
};

enum class Exploration : std::uint8_t { kGoal = 1, kTakenByOthers = 2, kComplete = 3 };

struct Goal {
    Exploration exploration = Exploration::kComplete;
    std::optional<Path> path;     ///< with kGoal: leads to where to stand
    std::optional<Point2> target; ///< with kGoal: the frontier's cell nearest to there, to look at; metres, map frame
    std::uint32_t given_up = 0;   ///< frontier cells that no longer count, because robots could not observe them
    bool in_danger = false;       ///< whether the place to stand is in danger, as there is no other

    friend bool operator==(const Goal&, const Goal&) = default;
};

struct GoalRequest {
    using Reply = ReplyOf<Goal>;

    std::uint64_t id = 0;
    std::optional<Point2> start;
    std::optional<double> body_radius;   ///< metres
    std::uint32_t frontier_size_min = 0; ///< cells; 0: the width of the body

    friend bool operator==(const GoalRequest&, const GoalRequest&) = default;
};

/// Adjacent cells in a row of a map: (i, j), (i + 1, j), ...
struct CellRun {
    std::int32_t j = 0;
    std::int32_t i = 0;
    std::int32_t count = 0; ///< at least 1

    friend bool operator==(const CellRun&, const CellRun&) = default;
};

/// A path that covers free ground. Its points and the runs together are at most kReplyPointsMax.
struct Coverage {
    Path path;
    double free_area = 0.0;           ///< square metres
    double covered_area = 0.0;        ///< square metres
    std::vector<CellRun> unreachable; ///< free cells that no path reaches
    double cell_size = 0.0;           ///< metres

    friend bool operator==(const Coverage&, const Coverage&) = default;
};

struct CoverageRequest {
    using Reply = ReplyOf<Coverage>;

    std::uint64_t id = 0;
    std::optional<Point2> start;
    std::optional<double> body_radius; ///< metres
    std::optional<double> spacing;     ///< metres
    std::vector<Point2> region;        ///< corners of a polygon, metres; empty: all free ground around the start

    friend bool operator==(const CoverageRequest&, const CoverageRequest&) = default;
};

/// A square around a point of the map.
struct Near {
    Point2 point{0.0, 0.0}; ///< metres, map frame
    double radius = 0.0;    ///< metres, along each axis

    friend bool operator==(const Near&, const Near&) = default;
};

struct LocateRequest {
    using Reply = ReplyOf<Correction>;

    std::uint64_t id = 0;
    std::vector<PointMm> points; ///< odometry frame, within kCoordinateMax
    Point2 from{0.0, 0.0};       ///< metres, odometry frame: from where they were observed
    std::optional<Near> near;    ///< nullopt: anywhere

    friend bool operator==(const LocateRequest&, const LocateRequest&) = default;
};

using PlanReply = PlanRequest::Reply;
using GoalReply = GoalRequest::Reply;
using CoverageReply = CoverageRequest::Reply;
using LocateReply = LocateRequest::Reply;

using Message = std::variant<Hello, Welcome, Sensor, ScanBatch, Ack, LinkError, Ping, Pong, Goodbye, Correction,
                             PlanRequest, PlanReply, GoalRequest, GoalReply, CoverageRequest, CoverageReply,
                             CompressedScanBatch, LocateRequest, LocateReply>;

/// Returns the name of the frame of a message, as in frame.proto ("scan_batch").
[[nodiscard]] std::string_view name_of(const Message& message) noexcept;

/// Parses one frame body and validates every value in it.
/// @param body  the frame without its length prefix
/// @return a message in which poses, angles, lengths and stamps are finite and within common/scan/limits.hpp, names are
///         valid, and every scan has as many intensities and explicit angles as ranges, and no beam beyond a full turn
/// Errors: kMalformed if it is not a Frame or has no body; kInvalidField or kTooLarge if a value is invalid: the
///         message then names the field, as in "scan_batch.scans[3].pose.x is nan".
/// Threads: any thread.
[[nodiscard]] Result<Message> decode(std::string_view body);

/// Appends the message to `out` as a frame with its length prefix and checksum.
void encode(const Message& message, std::string& out);

/// Checks that a scan without angles of its own fits its sensor: if the sensor has explicit or stepped angles, the scan
/// needs as many ranges; if the angles are uniform, the beams must not exceed a full turn.
/// Errors: kInvalidField if it does not fit.
[[nodiscard]] Result<> check_scan(const Scan& scan, const Sensor& sensor);

} // namespace scanloom::wire
