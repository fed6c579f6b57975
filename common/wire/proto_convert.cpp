#include "common/wire/proto_convert.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace scanloom::wire {
namespace {

bool is_angle(double angle) { return std::isfinite(angle) && std::abs(angle) <= 2.0 * kFullTurn; }

Result<> check_spacing(const UniformAngles& uniform) {
    if (!is_angle(uniform.first)) {
        return invalid_field(fmt::format("angles.uniform.first is {}; an angle in radians is needed", uniform.first));
    }
    if (!std::isfinite(uniform.increment) || uniform.increment == 0.0) {
        return invalid_field(
            fmt::format("angles.uniform.increment is {}; a finite angle other than 0 is needed", uniform.increment));
    }
    const double span = std::abs(uniform.increment) * static_cast<double>(uniform.count - 1);
    if (span > kFullTurn) {
        return invalid_field(
            fmt::format("angles.uniform spans {:.3f} rad over {} beams, more than a full turn", span, uniform.count));
    }
    return {};
}

Result<> check_spacing(const ExplicitAngles& list) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (!is_angle(list[i])) {
            return invalid_field(
                fmt::format("angles.explicit.angles[{}] is {}; an angle in radians is needed", i, list[i]));
        }
    }
    return {};
}

Result<> check_spacing(const SteppedAngles& stepped) {
    if (!std::isfinite(stepped.unit) || stepped.unit == 0.0) {
        return invalid_field(
            fmt::format("angles.stepped.unit is {}; a finite angle other than 0 is needed", stepped.unit));
    }
    for (std::size_t i = 0; i < stepped.steps.size(); ++i) {
        const double angle = stepped.unit * stepped.steps[i];
        if (!is_angle(angle)) {
            return invalid_field(fmt::format("angles.stepped.deltas lead beam {} to {} steps of {}, which is {}; an "
                                             "angle in radians is needed",
                                             i, stepped.steps[i], stepped.unit, angle));
        }
    }
    return {};
}

Result<> check_angles(const BeamAngles& angles) {
    const std::size_t count = beam_count(angles);
    if (count == 0) return invalid_field("angles describe 0 beams; at least 1 is needed");
    if (count > kBeamsMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("angles describe {} beams, at most {} are allowed", count, kBeamsMax)};
    }
    return std::visit([](const auto& spacing) { return check_spacing(spacing); }, angles);
}

/// Errors: kInvalidField if a sum of steps does not fit 32 bits.
Result<BeamAngles> read_stepped(const v1::SteppedAngles& proto) {
    SteppedAngles stepped{proto.unit(), {}};
    stepped.steps.reserve(static_cast<std::size_t>(proto.deltas_size()));
    std::int64_t step = 0;
    for (const std::int32_t delta : proto.deltas()) {
        step += delta;
        if (step != static_cast<std::int32_t>(step)) {
            return invalid_field(fmt::format("angles.stepped.deltas lead beam {} to {} steps; 32 bits must hold them",
                                             stepped.steps.size(), step));
        }
        stepped.steps.push_back(static_cast<std::int32_t>(step));
    }
    return BeamAngles(std::move(stepped));
}

void write_stepped(const SteppedAngles& stepped, v1::SteppedAngles& out) {
    out.set_unit(stepped.unit);
    out.mutable_deltas()->Reserve(static_cast<int>(stepped.steps.size()));
    std::int32_t before = 0;
    for (const std::int32_t step : stepped.steps) {
        out.add_deltas(static_cast<std::int32_t>(std::int64_t{step} - before));
        before = step;
    }
}

Result<BeamAngles> read_angles(const v1::BeamAngles& proto) {
    BeamAngles angles;
    switch (proto.spacing_case()) {
    case v1::BeamAngles::kUniform:
        angles = UniformAngles{proto.uniform().first(), proto.uniform().increment(), proto.uniform().count()};
        break;
    case v1::BeamAngles::kExplicit:
        angles = ExplicitAngles(proto.explicit_().angles().begin(), proto.explicit_().angles().end());
        break;
    case v1::BeamAngles::kStepped: {
        auto stepped = read_stepped(proto.stepped());
        if (!stepped) return stepped.error();
        angles = std::move(*stepped);
        break;
    }
    case v1::BeamAngles::SPACING_NOT_SET:
        return invalid_field("angles are neither uniform, explicit nor stepped; set one of them");
    }
    if (auto ok = check_angles(angles); !ok) return ok.error();
    return angles;
}

void write_angles(const BeamAngles& angles, v1::BeamAngles& out) {
    if (const auto* uniform = std::get_if<UniformAngles>(&angles)) {
        out.mutable_uniform()->set_first(uniform->first);
        out.mutable_uniform()->set_increment(uniform->increment);
        out.mutable_uniform()->set_count(uniform->count);
        return;
    }
    if (const auto* stepped = std::get_if<SteppedAngles>(&angles))
        return write_stepped(*stepped, *out.mutable_stepped());
    const auto& list = std::get<ExplicitAngles>(angles);
    out.mutable_explicit_()->mutable_angles()->Add(list.begin(), list.end());
}

Result<> check_beam_counts(const Scan& scan) {
    const std::size_t beams = scan.ranges.size();
    if (beams == 0) return invalid_field("ranges is empty; a scan has at least 1 beam");
    if (beams > kBeamsMax) {
        return Error{Errc::kTooLarge, fmt::format("ranges has {} beams, at most {} are allowed", beams, kBeamsMax)};
    }
    if (!scan.intensities.empty() && scan.intensities.size() != beams) {
        return invalid_field(fmt::format("intensities has {} values for {} ranges; send none or one a beam",
                                         scan.intensities.size(), beams));
    }
    if (scan.angles && beam_count(*scan.angles) != beams) {
        return invalid_field(fmt::format("angles describe {} beams, ranges has {}; send one range an angle",
                                         beam_count(*scan.angles), beams));
    }
    return {};
}

} // namespace

Error invalid_field(std::string message) { return {Errc::kInvalidField, std::move(message)}; }

Result<> check_coordinate(std::string_view field, double value) {
    if (!std::isfinite(value)) return invalid_field(fmt::format("{} is {}; a finite number is needed", field, value));
    if (std::abs(value) > kCoordinateMax) {
        return invalid_field(fmt::format("{} is {}; at most {} either way is allowed", field, value, kCoordinateMax));
    }
    return {};
}

void append_differences(std::span<const PointMm> points, Differences& out) {
    out.Reserve(out.size() + static_cast<int>(2 * points.size()));
    PointMm before;
    for (const PointMm& point : points) {
        out.AddAlreadyReserved(point.x - before.x);
        out.AddAlreadyReserved(point.y - before.y);
        before = point;
    }
}

Result<Pose2> from_proto(const v1::Pose2& proto) {
    if (auto ok = check_coordinate("x", proto.x()); !ok) return ok.error();
    if (auto ok = check_coordinate("y", proto.y()); !ok) return ok.error();
    if (auto ok = check_coordinate("yaw", proto.yaw()); !ok) return ok.error();
    return Pose2{proto.x(), proto.y(), normalize_angle(proto.yaw())};
}

Result<Sensor> from_proto(const v1::SensorDescription& proto) {
    Sensor sensor;
    sensor.id = proto.sensor();
    if (sensor.id >= kSensorsMax) {
        return invalid_field(fmt::format("sensor is {}; sensors are numbered 0 to {}", sensor.id, kSensorsMax - 1));
    }
    switch (proto.kind()) {
    case v1::SENSOR_KIND_LASER: sensor.kind = SensorKind::kLaser; break;
    case v1::SENSOR_KIND_SONAR: sensor.kind = SensorKind::kSonar; break;
    default:
        return invalid_field(
            fmt::format("kind is {}; SENSOR_KIND_LASER or _SONAR is needed", static_cast<int>(proto.kind())));
    }
    sensor.name = proto.name();
    if (sensor.name.size() > kNameBytesMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("name has {} bytes, at most {} are allowed", sensor.name.size(), kNameBytesMax)};
    }
    auto mount = from_proto(proto.mount());
    if (!mount) return prefixed("mount.", mount.error());
    sensor.mount = *mount;
    auto angles = read_angles(proto.angles());
    if (!angles) return angles.error();
    sensor.angles = std::move(*angles);
    sensor.aperture = proto.aperture();
    if (!(sensor.aperture >= 0.0 && sensor.aperture <= std::numbers::pi)) {
        return invalid_field(fmt::format("aperture is {}; 0 to pi radians are allowed", sensor.aperture));
    }
    sensor.range_min = proto.range_min();
    sensor.range_max = proto.range_max();
    if (!(sensor.range_min >= 0.0 && sensor.range_min <= kRangeMax)) {
        return invalid_field(fmt::format("range_min is {}; 0 to {} metres are possible", sensor.range_min, kRangeMax));
    }
    if (!(sensor.range_max > sensor.range_min && sensor.range_max <= kRangeMax)) {
        return invalid_field(fmt::format("range_max is {}; more than range_min ({}) and at most {} metres are needed",
                                         sensor.range_max, sensor.range_min, kRangeMax));
    }
    return sensor;
}

Result<Scan> from_proto(const v1::Scan& proto) {
    return from_proto(proto, {proto.ranges().begin(), proto.ranges().end()});
}

Result<Scan> from_proto(const v1::Scan& proto, std::vector<RangeMm> ranges) {
    Scan scan;
    scan.seq = proto.seq();
    if (scan.seq == 0) return invalid_field("seq is 0; the first scan of a robot has seq 1");
    scan.stamp = proto.stamp();
    if (!std::isfinite(scan.stamp)) {
        return invalid_field(fmt::format("stamp is {}; a finite number of seconds is needed", scan.stamp));
    }
    scan.duration = proto.duration();
    if (!(std::abs(scan.duration) <= kDurationMax)) { // also if it is NaN
        return invalid_field(
            fmt::format("duration is {}; at most {} seconds either way are allowed", scan.duration, kDurationMax));
    }
    scan.sensor = proto.sensor();
    if (proto.has_pose()) {
        auto pose = from_proto(proto.pose());
        if (!pose) return prefixed("pose.", pose.error());
        scan.pose = *pose;
    }
    if (proto.has_odometry()) {
        auto odometry = from_proto(proto.odometry());
        if (!odometry) return prefixed("odometry.", odometry.error());
        scan.odometry = *odometry;
    }
    scan.ranges = std::move(ranges);
    scan.intensities.assign(proto.intensities().begin(), proto.intensities().end());
    if (proto.has_angles()) {
        auto angles = read_angles(proto.angles());
        if (!angles) return angles.error();
        scan.angles = std::move(*angles);
    }
    scan.begins_map = proto.begins_map();
    if (auto ok = check_beam_counts(scan); !ok) return ok.error();
    return scan;
}

void to_proto(const Pose2& pose, v1::Pose2& out) {
    out.set_x(pose.x);
    out.set_y(pose.y);
    out.set_yaw(pose.yaw);
}

void to_proto(const Sensor& sensor, v1::SensorDescription& out) {
    out.set_sensor(sensor.id);
    out.set_kind(sensor.kind == SensorKind::kLaser ? v1::SENSOR_KIND_LASER : v1::SENSOR_KIND_SONAR);
    out.set_name(sensor.name);
    to_proto(sensor.mount, *out.mutable_mount());
    write_angles(sensor.angles, *out.mutable_angles());
    out.set_aperture(sensor.aperture);
    out.set_range_min(sensor.range_min);
    out.set_range_max(sensor.range_max);
}

void to_proto(const Scan& scan, v1::Scan& out) {
    to_proto_without_ranges(scan, out);
    out.mutable_ranges()->Add(scan.ranges.begin(), scan.ranges.end());
}

void to_proto_without_ranges(const Scan& scan, v1::Scan& out) {
    out.set_seq(scan.seq);
    out.set_stamp(scan.stamp);
    out.set_duration(scan.duration);
    out.set_sensor(scan.sensor);
    if (scan.pose) to_proto(*scan.pose, *out.mutable_pose());
    if (scan.odometry) to_proto(*scan.odometry, *out.mutable_odometry());
    out.mutable_intensities()->Add(scan.intensities.begin(), scan.intensities.end());
    if (scan.angles) write_angles(*scan.angles, *out.mutable_angles());
    out.set_begins_map(scan.begins_map);
}

Result<Poses> from_proto(v1::Poses poses) {
    switch (poses) {
    case v1::POSES_MAP: return Poses::kMap;
    case v1::POSES_ODOMETRY: return Poses::kOdometry;
    case v1::POSES_NONE: return Poses::kNone;
    default:
        return invalid_field(fmt::format("poses is {}, which this program does not know", static_cast<int>(poses)));
    }
}

v1::Poses to_proto(Poses poses) {
    switch (poses) {
    case Poses::kMap: return v1::POSES_MAP;
    case Poses::kOdometry: return v1::POSES_ODOMETRY;
    case Poses::kNone: return v1::POSES_NONE;
    }
    return v1::POSES_MAP;
}

// Settings of sessions ------------------------------------------------------------------------------------------------

namespace {

template <class Value>
Result<Value> value_of(Value value) {
    return value;
}

Result<RayModel> value_of(v1::RayModel model) {
    switch (model) {
    case v1::RAY_MODEL_INVERSE_SENSOR_MODEL: return RayModel::kInverseSensorModel;
    case v1::RAY_MODEL_BRESENHAM: return RayModel::kBresenham;
    case v1::RAY_MODEL_TRAVERSAL: return RayModel::kTraversal;
    default: return invalid_field("ray_model is unknown to this server; see session.proto");
    }
}

Result<ClassSource> value_of(v1::ClassSource source) {
    switch (source) {
    case v1::CLASS_SOURCE_OCCUPANCY: return ClassSource::kOccupancy;
    case v1::CLASS_SOURCE_HIMM: return ClassSource::kHimm;
    default: return invalid_field("class_source is unknown to this server; see session.proto");
    }
}

template <class Value>
Value proto_of(Value value) {
    return value;
}

v1::RayModel proto_of(RayModel model) {
    switch (model) {
    case RayModel::kInverseSensorModel: return v1::RAY_MODEL_INVERSE_SENSOR_MODEL;
    case RayModel::kBresenham: return v1::RAY_MODEL_BRESENHAM;
    case RayModel::kTraversal: return v1::RAY_MODEL_TRAVERSAL;
    }
    return v1::RAY_MODEL_UNSPECIFIED;
}

v1::ClassSource proto_of(ClassSource source) {
    return source == ClassSource::kHimm ? v1::CLASS_SOURCE_HIMM : v1::CLASS_SOURCE_OCCUPANCY;
}

} // namespace

Result<SessionOptions> from_proto(const v1::SessionConfig& proto) {
    SessionOptions options;
#define SCANLOOM_SETTING(type, name, ...)                                                                              \
    if (proto.has_##name()) {                                                                                          \
        const auto value = value_of(proto.name());                                                                     \
        if (!value) return value.error();                                                                              \
        options.name = *value;                                                                                         \
    }
#include "common/scan/settings.def"
    return options;
}

void to_proto(const SessionOptions& options, v1::SessionConfig& out) {
#define SCANLOOM_SETTING(type, name, ...)                                                                              \
    if (options.name) out.set_##name(proto_of(*options.name));
#include "common/scan/settings.def"
}

} // namespace scanloom::wire
