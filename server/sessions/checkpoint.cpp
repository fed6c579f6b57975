#include "server/sessions/checkpoint.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"
#include "server/sessions/checkpoint_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace scanloom::sessions {
namespace {

constexpr std::string_view kLaserChunk = "weave/laser/";
constexpr std::string_view kSonarChunk = "weave/sonar/";

// Version 1 had no version number and stored chunks as in memory. Version 2 lacked the number of pages and the poses of
// the robots, so a session had to be loaded to be listed. Versions 2 and 3 stored trajectories as
// track/<index>/<block>.
constexpr std::uint32_t kPartsVersion = 4;
constexpr std::uint32_t kOldestPartsVersion = 2;
constexpr std::size_t kChunkBytesMax = sizeof(mapping::LaserChunk) + sizeof(mapping::SonarChunk);

Error damaged(std::string_view key) { return {Errc::kMalformed, fmt::format("checkpoint part '{}' is damaged", key)}; }

/// Returns the hexadecimal numbers in a key without its prefix, which are separated by slashes; nullopt if invalid.
std::optional<std::vector<std::uint32_t>> numbers_in(std::string_view key) {
    std::vector<std::uint32_t> numbers;
    while (!key.empty()) {
        const auto slash = std::min(key.find('/'), key.size());
        std::uint32_t number = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + slash, number, 16);
        if (error != std::errc{} || end != key.data() + slash) return std::nullopt;
        numbers.push_back(number);
        key.remove_prefix(std::min(slash + 1, key.size()));
    }
    return numbers;
}

std::string format_part() {
    std::string value;
    put(value, mapping::kProjectionVersion);
    put(value, kPartsVersion);
    return value;
}

std::string head_part(const mapping::ProjectionState& state) {
    std::string value;
    put(value, state.revision);
    put(value, state.bounds.laser.occupancy);
    put(value, state.bounds.laser.himm);
    put(value, state.bounds.sonar);
    put(value, std::uint64_t{state.pages});
    return value;
}

std::string robot_part(const mapping::ProjectionState::Robot& robot) {
    std::string value;
    put(value, robot.last_seq);
    put(value, robot.scan_count);
    if (robot.newest) put(value, *robot.newest); // present exactly if scan_count > 0
    value += robot.name + '\0' + robot.source;
    const bool has_jumps = robot.jumps.newest.has_value();
    if (!robot.body_radius && !has_jumps) return value; // same bytes as in earlier versions, which had neither
    put(value += '\0', robot.body_radius.value_or(0.0));
    if (!has_jumps) return value;
    put(value, *robot.jumps.integrated);
    put(value, *robot.jumps.newest);
    put(value, robot.jumps.left_out);
    return value;
}

std::string chunk_part(const mapping::LaserChunk& chunk) {
    std::string value;
    put(value, chunk.revision);
    put(value, chunk.occupancy);
    put(value, chunk.himm);
    put(value, chunk.occ_types);
    return value;
}

std::string chunk_part(const mapping::SonarChunk& chunk) {
    std::string value;
    put(value, chunk.revision);
    put(value, chunk.cells);
    return value;
}

std::string chunk_key(std::string_view prefix, grid::ChunkKey key) {
    return fmt::format("{}{:08x}/{:08x}", prefix, static_cast<std::uint32_t>(key.cj),
                       static_cast<std::uint32_t>(key.ci));
}

grid::ChunkKey chunk_key_of(const std::vector<std::uint32_t>& numbers) {
    return {static_cast<std::int32_t>(numbers[0]), static_cast<std::int32_t>(numbers[1])};
}

/// Collects parts and writes them to the store in pieces. Writes nothing more after a failure.
class PieceWriter {
public:
    PieceWriter(store::ScanLog& log, store::SessionId session, const std::atomic<bool>& stop)
        : log_(log), session_(session), stop_(stop) {}

    /// Adds a part that is stored compressed. Its uncompressed size counts, so a piece covers the same amount of map
    /// whatever the compression ratio.
    void add_compressed(std::string key, std::string_view value) {
        bytes_ += key.size() + value.size();
        parts_.push_back({std::move(key), compressor_.compressed(value)});
    }

    void add(std::string key, std::string value) {
        bytes_ += key.size() + value.size();
        parts_.push_back({std::move(key), std::move(value)});
    }

    void write_if_full() {
        if (bytes_ >= kPieceBytes) write();
    }

    void write() {
        if (stop_ && written_) written_ = Error{Errc::kShuttingDown, "the session is being closed"};
        if (written_) written_ = log_.write_checkpoint(session_, std::exchange(parts_, {}));
        parts_.clear();
        bytes_ = 0;
    }

    [[nodiscard]] const Result<>& written() const { return written_; }

private:
    static constexpr std::size_t kPieceBytes = std::size_t{4} << 20;

    store::ScanLog& log_;
    store::SessionId session_;
    const std::atomic<bool>& stop_;
    PartCompressor compressor_;
    std::vector<store::CheckpointPart> parts_;
    std::size_t bytes_ = 0;
    Result<> written_;
};

template <class View>
void write_chunks(PieceWriter& out, std::string_view prefix, const View& view, Revision since) {
    view.visit({}, since, [&](grid::ChunkKey key, const auto& chunk) {
        if (!out.written()) return;
        out.add_compressed(chunk_key(prefix, key), chunk_part(chunk));
        out.write_if_full();
    });
}

/// Writes the parts that must agree, as one piece. A stored sensor must not be newer than the head: a recovery would
/// apply it to earlier scans.
void write_state(PieceWriter& out, const mapping::ProjectionState& state, Revision since) {
    out.add("head", head_part(state));
    if (state.exclusions->revision() != 0) out.add(std::string(kExclusionsPart), exclusions_part(state));
    for (RobotIndex index = 0; index < state.robots.size(); ++index) {
        out.add(fmt::format("robot/{:08x}", index), robot_part(state.robots[index]));
        for (const auto& [id, known] : state.robots[index].sensors) {
            if (known.revision <= since) continue;
            out.add(fmt::format("sensor/{:08x}/{:08x}", index, id),
                    wire::encode_entry(SensorDescribed{index, *known.sensor}));
        }
    }
    out.write();
}

} // namespace

Result<> write_checkpoint(store::ScanLog& log, store::SessionId session, const mapping::Snapshot& snapshot,
                          const mapping::ProjectionState& state, std::optional<Revision> since,
                          const std::atomic<bool>& stop) {
    try {
        if (!since) {
            if (auto cleared = log.clear_checkpoint(session); !cleared) return cleared;
        }
        const Revision stored = since.value_or(0);
        PieceWriter out(log, session, stop);
        out.add("format", format_part());
        write_chunks(out, kLaserChunk, snapshot.laser, stored);
        write_chunks(out, kSonarChunk, snapshot.sonar, stored);
        write_state(out, state, stored);
        return out.written();
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left to write it"};
    }
}

const CheckpointReader::Kind CheckpointReader::kKinds[5] = {
    {"robot/", 1, &CheckpointReader::add_robot},          {"sensor/", 2, &CheckpointReader::add_sensor},
    {"track/", 2, &CheckpointReader::add_old_points},     {kLaserChunk, 2, &CheckpointReader::add_laser_chunk},
    {kSonarChunk, 2, &CheckpointReader::add_sonar_chunk},
};

Result<> CheckpointReader::add(std::string_view key, std::string_view value) {
    if (key == "format") return add_format(value);
    if (!has_format_) return Error{Errc::kMalformed, "the checkpoint's part 'format' is missing"};
    if (key == "head") return add_head(value);
    if (key == kExclusionsPart) return add_exclusions(value);
    for (const auto& kind : kKinds) {
        if (!key.starts_with(kind.prefix)) continue;
        const auto numbers = numbers_in(key.substr(kind.prefix.size()));
        if (numbers && numbers->size() == kind.numbers && (this->*kind.add)(*numbers, value)) return {};
    }
    return damaged(key);
}

Result<> CheckpointReader::add_format(std::string_view value) {
    PartReader part(value);
    const auto version = part.take<std::uint32_t>();
    const auto parts_version = part.rest().empty() ? 1 : part.take<std::uint32_t>();
    if (!part.complete()) return damaged("format");
    has_format_ = true;
    if (version != mapping::kProjectionVersion) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("the checkpoint was computed by version {}, this program computes version {}", version,
                                 mapping::kProjectionVersion)};
    }
    parts_version_ = parts_version;
    if (parts_version < kOldestPartsVersion || parts_version > kPartsVersion) {
        return Error{Errc::kUnsupportedVersion, fmt::format("the checkpoint's parts are of version {}, this program's "
                                                            "of version {}",
                                                            parts_version, kPartsVersion)};
    }
    return {};
}

Result<> CheckpointReader::add_head(std::string_view value) {
    PartReader part(value);
    state_.revision = part.take<Revision>();
    state_.bounds.laser.occupancy = part.take<grid::CellBox>();
    state_.bounds.laser.himm = part.take<grid::CellBox>();
    state_.bounds.sonar = part.take<grid::CellBox>();
    if (parts_version_ > 2) state_.pages = part.take<std::uint64_t>();
    if (!part.complete()) return damaged("head");
    return {};
}

Result<> CheckpointReader::add_exclusions(std::string_view value) {
    auto part = read_exclusions_part(value);
    if (!part) return damaged(kExclusionsPart);
    state_.exclusions = std::make_shared<const Exclusions>(std::move(part->exclusions));
    excluded_ = std::move(part->excluded);
    return {};
}

bool CheckpointReader::add_robot(const Numbers& numbers, std::string_view value) {
    if (numbers[0] != state_.robots.size()) return false;
    PartReader part(value);
    auto& robot = state_.robots.emplace_back();
    if (numbers[0] < excluded_.size()) robot.excluded = excluded_[numbers[0]];
    robot.last_seq = part.take<std::uint64_t>();
    robot.scan_count = part.take<std::uint64_t>();
    if (parts_version_ > 2 && robot.scan_count > 0) robot.newest = part.take<mapping::TrajectoryPoint>();
    const auto name_end = std::min(part.rest().find('\0'), part.rest().size());
    robot.name = part.rest().substr(0, name_end);
    part.skip(name_end + 1);
    const auto source_end = std::min(part.rest().find('\0'), part.rest().size());
    robot.source = part.rest().substr(0, source_end);
    part.skip(source_end + 1);
    if (part.rest().empty()) return !part.failed();
    if (const auto radius = part.take<double>(); radius != 0.0) robot.body_radius = radius;
    if (robot.body_radius && !is_body_radius(*robot.body_radius)) return false;
    if (part.complete()) return true;
    robot.jumps.integrated = part.take<Point2>();
    robot.jumps.newest = part.take<Point2>();
    robot.jumps.left_out = part.take<std::uint64_t>();
    return part.complete() && is_finite(*robot.jumps.integrated) && is_finite(*robot.jumps.newest);
}

bool CheckpointReader::add_sensor(const Numbers& numbers, std::string_view value) {
    auto entry = wire::decode_entry(value);
    if (!entry || numbers[0] >= state_.robots.size()) return false;
    auto* described = std::get_if<SensorDescribed>(&*entry);
    if (described == nullptr) return false;
    const auto id = described->sensor.id;
    state_.robots[numbers[0]].sensors[id] = {state_.revision,
                                             std::make_shared<const Sensor>(std::move(described->sensor))};
    return true;
}

/// Reads a block of a trajectory in an earlier format. Only the newest point is used.
bool CheckpointReader::add_old_points(const Numbers& numbers, std::string_view value) {
    PartReader part(value);
    while (!part.complete()) {
        const auto point = part.take<mapping::TrajectoryPoint>();
        if (part.failed()) return false;
        if (point.revision > state_.revision) continue; // its scan will be replayed
        if (numbers[0] >= state_.robots.size()) return false;
        state_.robots[numbers[0]].newest = point;
    }
    return parts_version_ < kPartsVersion;
}

bool CheckpointReader::add_laser_chunk(const Numbers& numbers, std::string_view value) {
    restore_projection();
    const auto bytes = decompressor_.decompressed(value, kChunkBytesMax);
    if (!bytes) return false;
    PartReader part(*bytes);
    const auto revision = part.take<Revision>();
    const auto occupancy = part.take<decltype(mapping::LaserChunk::occupancy)>();
    const auto himm = part.take<decltype(mapping::LaserChunk::himm)>();
    const auto occ_types = part.take<classify::OccPlanes>();
    const bool are_types =
        std::ranges::equal(occ_types.free, occ_types.occupied,
                           [](std::uint64_t free, std::uint64_t occupied) { return (free & occupied) == 0; });
    const bool are_counts = std::ranges::all_of(
        himm, [](auto count) { return count <= mapping::kHimmMax || count == mapping::kUnseenHimm; });
    if (!part.complete() || !are_types || !are_counts) return false;
    mapping::LaserChunk& chunk = projection_.restore_laser_chunk(chunk_key_of(numbers), revision);
    chunk.occupancy = occupancy;
    chunk.himm = himm;
    chunk.occ_types = occ_types;
    return true;
}

bool CheckpointReader::add_sonar_chunk(const Numbers& numbers, std::string_view value) {
    restore_projection();
    const auto bytes = decompressor_.decompressed(value, kChunkBytesMax);
    if (!bytes) return false;
    PartReader part(*bytes);
    const auto revision = part.take<Revision>();
    const auto cells = part.take<decltype(mapping::SonarChunk::cells)>();
    if (!part.complete()) return false;
    projection_.restore_sonar_chunk(chunk_key_of(numbers), revision).cells = cells;
    return true;
}

void CheckpointReader::restore_projection() {
    if (!is_restored_) projection_.restore(state_);
    is_restored_ = true;
}

bool CheckpointReader::is_newest_format() const noexcept { return !has_format_ || parts_version_ == kPartsVersion; }

std::optional<mapping::ProjectionState> CheckpointReader::state() && {
    if (!is_newest_format()) return std::nullopt;
    return std::move(state_);
}

Result<mapping::Projection> CheckpointReader::finish() && {
    restore_projection();
    for (const auto& exclusion : state_.exclusions->all()) {
        if (exclusion.excluded.robot >= state_.robots.size()) return damaged(kExclusionsPart);
    }
    for (const auto& robot : state_.robots) {
        if (robot.newest || robot.scan_count == 0) continue;
        return Error{Errc::kMalformed, fmt::format("the checkpoint has no pose of robot '{}', which took {} scans",
                                                   robot.name, robot.scan_count)};
    }
    return std::move(projection_);
}

} // namespace scanloom::sessions
