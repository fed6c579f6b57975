#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/geometry/pose2.hpp"
#include "common/scan/poses.hpp"
#include "common/scan/sensor.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The messages of the viewers' WebSocket as plain values. proto/scanloom/v1/live.proto documents each field.
namespace scanloom::wire {

/// With the numbers of live.proto.
enum class LiveLayer : std::uint8_t { kOccupancy = 1, kHimm = 2, kSonar = 3, kClassification = 4 };
enum class LiveState : std::uint8_t { kOk = 1, kFailed = 2, kDraining = 3 };

struct LiveRequest {
    std::vector<LiveLayer> layers; ///< as sent; may contain duplicates
    bool points = false;
    bool landmarks = false;

    friend bool operator==(const LiveRequest&, const LiveRequest&) = default;
};

struct TileChanges {
    LiveLayer layer = LiveLayer::kOccupancy;
    bool everything = false;
    std::vector<std::uint32_t> tiles;
    std::vector<std::uint64_t> revisions;
};

struct ScanPoints {
    std::uint32_t sensor = 0;
    SensorKind kind = SensorKind::kLaser;
    double stamp = 0.0;
    Pose2 origin;                ///< T_map_sensor
    std::vector<PointMm> points; ///< relative to the origin, along the map's axes; up to kRangeMax away
};

struct LiveLocalization {
    LocalizationState state = LocalizationState::kGiven;
    Poses poses = Poses::kMap;
    float inliers = 0.0F;
    float sigma_m = 0.0F;         ///< metres
    float sigma_rad = 0.0F;       ///< radians
    float mount_yaw_error = 0.0F; ///< radians: by how much the yaw of the laser's mount seems too large; 0: it is right
};

struct RobotUpdate {
    std::uint32_t robot = 0;
    std::string name;
    bool connected = false;
    std::optional<Pose2> pose;
    double stamp = 0.0;
    std::uint64_t scan_count = 0;
    std::uint64_t last_seq = 0;
    std::vector<PointMm> trail; ///< map frame; within kCoordinateMax, so that differences fit, too
    std::uint64_t trail_from = 0;
    std::optional<ScanPoints> scan;
    std::optional<double> body_radius; ///< metres
    std::optional<LiveLocalization> localization;
};

struct LiveLandmark {
    std::uint32_t id = 0;
    double x = 0.0; ///< metres, map frame
    double y = 0.0;
    std::uint32_t seen = 0;
    float size_x = 0.0F; ///< metres
    float size_y = 0.0F;
    float spread = 0.0F; ///< metres
    float continuity = 0.0F;
    std::uint32_t points = 0;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
};

struct LandmarkChanges {
    std::vector<LiveLandmark> landmarks;
    std::uint64_t following = 0;
    std::uint64_t captures = 0;
    std::uint64_t revision = 0;
    std::string refused;
};

struct LiveCounters {
    std::uint64_t scans = 0;
    std::uint32_t robots = 0;
    std::uint32_t connected = 0;
    std::uint64_t chunks = 0;
};

struct LiveEvent {
    std::string session;
    std::uint64_t revision = 0;
    LiveState state = LiveState::kOk;
    std::string reason;
    LiveCounters counters;
    std::uint64_t frontiers_revision = 0;
    std::vector<TileChanges> tiles;
    std::vector<RobotUpdate> robots;
    std::uint64_t goals_revision = 0;
    std::optional<LandmarkChanges> landmarks;
    std::uint64_t poses_corrected = 0;
    std::uint64_t moving_scans = 0;
};

/// Serializes an event as the body of a binary WebSocket message.
[[nodiscard]] std::string encode(const LiveEvent& event);

/// Parses and validates a viewer's request.
/// @param body  the body of a binary WebSocket message
/// @return the request
/// Errors: kMalformed if it is not a LiveRequest; kInvalidField if it has a field or a layer that this program does not
///         know; kTooLarge if it has more than 16 layers. The message fits into a close frame: 123 bytes.
/// Threads: any thread.
[[nodiscard]] Result<LiveRequest> decode_live_request(std::string_view body);

} // namespace scanloom::wire
