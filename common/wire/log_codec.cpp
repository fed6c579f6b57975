#include "common/wire/log_codec.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/packed_ranges.hpp"
#include "common/wire/proto_convert.hpp"

#include "scanloom/v1/log.pb.h"

#include <google/protobuf/arena.h>

#include <algorithm>
#include <cmath>

namespace scanloom::wire {
namespace {

Error damaged(const char* what) {
    return {Errc::kMalformed,
            std::string(what) + " in the store cannot be read; the store is damaged or was written by another program"};
}

struct EntryToProto {
    v1::LogEntry& out;

    void operator()(const RobotJoined& joined) const {
        out.mutable_robot_joined()->set_robot(joined.robot);
        out.mutable_robot_joined()->set_name(joined.name);
        out.mutable_robot_joined()->set_source(joined.source);
        if (joined.body_radius) out.mutable_robot_joined()->set_body_radius(*joined.body_radius);
        out.mutable_robot_joined()->set_poses(to_proto(joined.poses));
    }
    void operator()(const SensorDescribed& described) const {
        out.mutable_sensor_described()->set_robot(described.robot);
        to_proto(described.sensor, *out.mutable_sensor_described()->mutable_sensor());
    }
    void operator()(const ScanTaken& taken) const {
        out.mutable_scan_taken()->set_robot(taken.robot);
        to_proto_without_ranges(taken.scan, *out.mutable_scan_taken()->mutable_scan());
        out.mutable_scan_taken()->set_packed_ranges(pack_ranges(taken.scan.ranges));
        out.mutable_scan_taken()->set_localize_only(taken.is_localize_only);
    }
    void operator()(const MapPatch& patch) const {
        auto& proto = *out.mutable_map_patch();
        proto.set_cell_size(patch.cell_size);
        proto.set_min_x(patch.min_x);
        proto.set_min_y(patch.min_y);
        proto.set_width(patch.width);
        proto.set_cells(patch.cells.data(), patch.cells.size());
    }
    void operator()(const ScansExcluded& excluded) const {
        auto& proto = *out.mutable_scans_excluded();
        proto.set_id(excluded.id);
        proto.set_robot(excluded.robot);
        if (const auto* stamps = std::get_if<StampRange>(&excluded.scans)) {
            proto.mutable_stamps()->set_from(stamps->from);
            proto.mutable_stamps()->set_to(stamps->to);
        } else {
            const auto& seqs = std::get<SeqRange>(excluded.scans);
            proto.mutable_seqs()->set_from(seqs.from);
            proto.mutable_seqs()->set_to(seqs.to);
        }
    }
    void operator()(const ExclusionLifted& lifted) const { out.mutable_exclusion_lifted()->set_id(lifted.id); }
    void operator()(const MapsCorrected& corrected) const { out.mutable_maps_corrected()->set_as_of(corrected.as_of); }
    void operator()(const RobotRelocalized& relocalized) const {
        auto& proto = *out.mutable_robot_relocalized();
        proto.set_robot(relocalized.robot);
        proto.set_x(relocalized.near.x);
        proto.set_y(relocalized.near.y);
        proto.set_radius(relocalized.radius);
    }
    void operator()(const ModeChanged& changed) const {
        out.mutable_mode_changed()->set_localize_only(changed.is_localize_only);
    }
};

Result<LogEntry> read_robot_joined(const v1::RobotJoined& proto) {
    if (!is_valid_name(proto.name())) return damaged("a log entry"); // names are used in log output and file names
    RobotJoined joined{proto.robot(), proto.name(), proto.source()};
    if (proto.has_body_radius()) {
        if (!is_body_radius(proto.body_radius())) return damaged("a log entry");
        joined.body_radius = proto.body_radius();
    }
    const auto poses = from_proto(proto.poses());
    if (!poses) return damaged("a log entry");
    joined.poses = *poses;
    return LogEntry(std::move(joined));
}

Result<LogEntry> read_scan_taken(const v1::ScanTaken& proto) {
    const bool is_packed = !proto.packed_ranges().empty(); // since format 2 of the store
    if (is_packed && !proto.scan().ranges().empty()) return damaged("a log entry");
    auto ranges = is_packed ? unpack_ranges(proto.packed_ranges()) : std::nullopt;
    if (is_packed && !ranges) return damaged("a log entry");
    auto scan = is_packed ? from_proto(proto.scan(), std::move(*ranges)) : from_proto(proto.scan());
    if (!scan) return prefixed("scan_taken.", scan.error());
    return LogEntry(ScanTaken{proto.robot(), std::move(*scan), proto.localize_only()});
}

Result<LogEntry> read_map_patch(const v1::MapPatch& proto) {
    const auto& cells = proto.cells();
    const bool is_placed = proto.cell_size() > 0.0 && proto.cell_size() <= kMapCellSizeMax &&
                           std::abs(proto.min_x()) <= kCoordinateMax && std::abs(proto.min_y()) <= kCoordinateMax;
    const bool is_whole = proto.width() > 0 && cells.size() <= kMapPatchCellsMax && cells.size() % proto.width() == 0;
    const bool are_cells = std::all_of(cells.begin(), cells.end(), [](char cell) { return cell >= 0 && cell <= 2; });
    if (!is_placed || !is_whole || !are_cells) return damaged("a part of an imported map");
    MapPatch patch{proto.cell_size(), proto.min_x(), proto.min_y(), proto.width(), {}};
    patch.cells.resize(cells.size());
    std::transform(cells.begin(), cells.end(), patch.cells.begin(),
                   [](char cell) { return static_cast<MapCell>(cell); });
    return LogEntry(std::move(patch));
}

Result<LogEntry> read_scans_excluded(const v1::ScansExcluded& proto) {
    ScansExcluded excluded{proto.id(), proto.robot(), {}};
    if (proto.has_stamps()) {
        const StampRange range{proto.stamps().from(), proto.stamps().to()};
        if (!(range.from <= range.to)) return damaged("a log entry"); // also rejects NaN
        excluded.scans = range;
    } else {
        const SeqRange range{proto.seqs().from(), proto.seqs().to()};
        if (!proto.has_seqs() || range.from > range.to) return damaged("a log entry");
        excluded.scans = range;
    }
    return LogEntry(excluded);
}

Result<LogEntry> read_robot_relocalized(const v1::RobotRelocalized& proto) {
    const bool is_place = std::fabs(proto.x()) <= kCoordinateMax && std::fabs(proto.y()) <= kCoordinateMax;
    if (!is_place || !(proto.radius() > 0.0 && proto.radius() <= kCoordinateMax)) return damaged("a log entry");
    return LogEntry(RobotRelocalized{proto.robot(), {proto.x(), proto.y()}, proto.radius()});
}

} // namespace

std::string encode_entry(const LogEntry& entry) {
    google::protobuf::Arena arena;
    auto* proto = google::protobuf::Arena::CreateMessage<v1::LogEntry>(&arena);
    std::visit(EntryToProto{*proto}, entry);
    return proto->SerializeAsString();
}

Result<LogEntry> decode_entry(std::string_view bytes) {
    google::protobuf::Arena arena;
    auto* proto = google::protobuf::Arena::CreateMessage<v1::LogEntry>(&arena);
    if (!proto->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return damaged("a log entry");
    switch (proto->body_case()) {
    case v1::LogEntry::kRobotJoined: return read_robot_joined(proto->robot_joined());
    case v1::LogEntry::kSensorDescribed: {
        auto sensor = from_proto(proto->sensor_described().sensor());
        if (!sensor) return prefixed("sensor_described.", sensor.error());
        return LogEntry(SensorDescribed{proto->sensor_described().robot(), std::move(*sensor)});
    }
    case v1::LogEntry::kMapPatch: return read_map_patch(proto->map_patch());
    case v1::LogEntry::kScanTaken: return read_scan_taken(proto->scan_taken());
    case v1::LogEntry::kScansExcluded: return read_scans_excluded(proto->scans_excluded());
    case v1::LogEntry::kExclusionLifted: return LogEntry(ExclusionLifted{proto->exclusion_lifted().id()});
    case v1::LogEntry::kMapsCorrected: return LogEntry(MapsCorrected{proto->maps_corrected().as_of()});
    case v1::LogEntry::kRobotRelocalized: return read_robot_relocalized(proto->robot_relocalized());
    case v1::LogEntry::kModeChanged: return LogEntry(ModeChanged{proto->mode_changed().localize_only()});
    case v1::LogEntry::BODY_NOT_SET: break;
    }
    return damaged("a log entry");
}

Result<std::optional<ScanPose>> decode_scan_pose(std::string_view bytes) {
    google::protobuf::Arena arena;
    auto* proto = google::protobuf::Arena::CreateMessage<v1::LogEntry>(&arena);
    if (!proto->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return damaged("a log entry");
    if (!proto->has_scan_taken()) return std::optional<ScanPose>();
    const auto& scan = proto->scan_taken().scan();
    ScanPose taken{proto->scan_taken().robot(), scan.seq(), scan.stamp(), std::nullopt,
                   proto->scan_taken().localize_only()};
    if (scan.has_pose()) {
        const auto pose = from_proto(scan.pose());
        if (!pose) return prefixed("scan_taken.pose: ", pose.error());
        taken.pose = *pose;
    }
    return std::optional(taken);
}

Result<std::string> plain_entry(std::string_view bytes) {
    google::protobuf::Arena arena;
    auto* proto = google::protobuf::Arena::CreateMessage<v1::LogEntry>(&arena);
    if (!proto->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return damaged("a log entry");
    if (!proto->has_scan_taken() || proto->scan_taken().packed_ranges().empty()) return std::string(bytes);
    auto& taken = *proto->mutable_scan_taken();
    const auto ranges = unpack_ranges(taken.packed_ranges());
    if (!ranges) return damaged("a log entry");
    taken.clear_packed_ranges();
    taken.mutable_scan()->mutable_ranges()->Add(ranges->begin(), ranges->end());
    return proto->SerializeAsString();
}

std::string encode_session(const SessionRecord& record) {
    v1::SessionRecord proto;
    proto.set_name(record.name);
    proto.set_created(record.created);
    to_proto(record.options, *proto.mutable_config());
    proto.set_map_patches(record.entries_at_creation);
    proto.set_created_by(record.created_by);
    proto.set_chunks_max(record.chunks_max);
    proto.set_replaces(record.replaces);
    return proto.SerializeAsString();
}

Result<SessionRecord> decode_session(std::string_view bytes) {
    v1::SessionRecord proto;
    if (!proto.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return damaged("a session");
    if (!is_valid_name(proto.name())) return damaged("a session"); // rejects paths and line breaks
    auto options = from_proto(proto.config());
    if (!options) return options.error();
    return SessionRecord{proto.name(),       proto.created(),    *options,        proto.map_patches(),
                         proto.created_by(), proto.chunks_max(), proto.replaces()};
}

} // namespace scanloom::wire
