#include "server/session/checkpoint.hpp"

#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <type_traits>

namespace scanloom::session {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are written in the machine's own order");

template <class Value>
void put(std::string& out, const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes values off the front of a part; fails for good when it is too short.
class PartReader {
public:
    explicit PartReader(std::string_view bytes) : rest_(bytes) {}

    template <class Value>
    Value take() {
        static_assert(std::is_trivially_copyable_v<Value>);
        Value value{};
        if (rest_.size() < sizeof value) {
            failed_ = true;
            return value;
        }
        std::memcpy(&value, rest_.data(), sizeof value);
        rest_.remove_prefix(sizeof value);
        return value;
    }

    [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
    [[nodiscard]] bool complete() const noexcept { return !failed_ && rest_.empty(); }
    [[nodiscard]] bool failed() const noexcept { return failed_; }

private:
    std::string_view rest_;
    bool failed_ = false;
};

Error damaged(std::string_view key) { return {Errc::kMalformed, fmt::format("checkpoint part '{}' is damaged", key)}; }

/// The hexadecimal numbers between the slashes of what follows a key's prefix.
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

std::string head_part(const mapping::ProjectionState& state) {
    std::string value;
    put(value, mapping::kWeavingVersion);
    put(value, state.revision);
    put(value, state.bounds.i_begin);
    put(value, state.bounds.j_begin);
    put(value, state.bounds.i_end);
    put(value, state.bounds.j_end);
    return value;
}

void add_robot(std::vector<store::CheckpointPart>& parts, RobotIndex index,
               const mapping::ProjectionState::Robot& robot) {
    std::string value;
    put(value, robot.last_seq);
    put(value, robot.scan_count);
    parts.push_back({fmt::format("robot/{:08x}", index), value + robot.name});
    for (const auto& sensor : robot.sensors) {
        parts.push_back({fmt::format("sensor/{:08x}/{:08x}", index, sensor.id),
                         wire::encode_entry(SensorDescribed{index, sensor})});
    }
}

void add_track(std::vector<store::CheckpointPart>& parts, RobotIndex index, const mapping::TrajectoryView& track,
               Revision since) {
    const std::size_t first_block = track.first_after(since) / mapping::kTrajectoryBlock;
    for (std::size_t begin = first_block * mapping::kTrajectoryBlock; begin < track.size();
         begin += mapping::kTrajectoryBlock) {
        const std::size_t end = std::min(begin + mapping::kTrajectoryBlock, track.size());
        std::string value;
        for (std::size_t n = begin; n < end; ++n) put(value, track[n]);
        parts.push_back(
            {fmt::format("track/{:08x}/{:08x}", index, begin / mapping::kTrajectoryBlock), std::move(value)});
    }
}

void add_chunks(std::vector<store::CheckpointPart>& parts, const mapping::OccupancyView& view, Revision since) {
    view.visit({}, since, [&](mapping::ChunkKey key, const mapping::OccupancyChunk& chunk) {
        std::string value;
        put(value, chunk.revision);
        put(value, chunk.cells);
        parts.push_back({fmt::format("weave/occupancy/{:08x}/{:08x}", static_cast<std::uint32_t>(key.cj),
                                     static_cast<std::uint32_t>(key.ci)),
                         std::move(value)});
    });
}

} // namespace

std::vector<store::CheckpointPart> checkpoint_parts(const mapping::Snapshot& snapshot,
                                                    const mapping::ProjectionState& state, Revision since) {
    std::vector<store::CheckpointPart> parts{{"head", head_part(state)}};
    for (RobotIndex index = 0; index < state.robots.size(); ++index) {
        add_robot(parts, index, state.robots[index]);
        add_track(parts, index, snapshot.robots[index].trajectory, since);
    }
    add_chunks(parts, snapshot.occupancy, since);
    return parts;
}

const CheckpointReader::Kind CheckpointReader::kKinds[4] = {
    {"robot/", 1, &CheckpointReader::add_robot},
    {"sensor/", 2, &CheckpointReader::add_sensor},
    {"track/", 2, &CheckpointReader::add_points},
    {"weave/occupancy/", 2, &CheckpointReader::add_chunk},
};

Result<> CheckpointReader::add(std::string_view key, std::string_view value) {
    if (key == "head") return add_head(value);
    for (const auto& kind : kKinds) {
        if (!key.starts_with(kind.prefix)) continue;
        const auto numbers = numbers_in(key.substr(kind.prefix.size()));
        if (numbers && numbers->size() == kind.numbers && (this->*kind.add)(*numbers, value)) return {};
    }
    return damaged(key);
}

Result<> CheckpointReader::add_head(std::string_view value) {
    PartReader part(value);
    const auto version = part.take<std::uint32_t>();
    state_.revision = part.take<Revision>();
    state_.bounds.i_begin = part.take<std::int32_t>();
    state_.bounds.j_begin = part.take<std::int32_t>();
    state_.bounds.i_end = part.take<std::int32_t>();
    state_.bounds.j_end = part.take<std::int32_t>();
    if (!part.complete()) return damaged("head");
    if (version == mapping::kWeavingVersion) return {};
    return Error{Errc::kUnsupportedVersion,
                 fmt::format("the checkpoint was woven by version {}, this program weaves version {}", version,
                             mapping::kWeavingVersion)};
}

bool CheckpointReader::add_robot(const Numbers& numbers, std::string_view value) {
    if (numbers[0] != state_.robots.size()) return false;
    PartReader part(value);
    auto& robot = state_.robots.emplace_back();
    robot.last_seq = part.take<std::uint64_t>();
    robot.scan_count = part.take<std::uint64_t>();
    robot.name = part.rest();
    return !part.failed();
}

bool CheckpointReader::add_sensor(const Numbers& numbers, std::string_view value) {
    auto entry = wire::decode_entry(value);
    if (!entry || numbers[0] >= state_.robots.size()) return false;
    auto* described = std::get_if<SensorDescribed>(&*entry);
    if (described == nullptr) return false;
    state_.robots[numbers[0]].sensors.push_back(std::move(described->sensor));
    return true;
}

bool CheckpointReader::add_points(const Numbers& numbers, std::string_view value) {
    begin_weaving();
    PartReader part(value);
    while (!part.complete()) {
        const auto point = part.take<mapping::TrajectoryPoint>();
        if (part.failed() || !projection_.restore_point(numbers[0], point)) return false;
    }
    return true;
}

bool CheckpointReader::add_chunk(const Numbers& numbers, std::string_view value) {
    begin_weaving();
    PartReader part(value);
    const auto revision = part.take<Revision>();
    const auto cells = part.take<decltype(mapping::OccupancyChunk::cells)>();
    if (!part.complete()) return false;
    projection_.restore_chunk({static_cast<std::int32_t>(numbers[0]), static_cast<std::int32_t>(numbers[1])}, revision,
                              cells);
    return true;
}

void CheckpointReader::begin_weaving() {
    if (!weaving_) projection_.restore(state_);
    weaving_ = true;
}

Result<mapping::Projection> CheckpointReader::finish() && {
    begin_weaving();
    for (const auto& robot : projection_.snapshot().robots) {
        if (robot.trajectory.size() == robot.scan_count) continue;
        return Error{Errc::kMalformed, fmt::format("the checkpoint has {} poses of robot '{}', which took {} scans",
                                                   robot.trajectory.size(), robot.name, robot.scan_count)};
    }
    return std::move(projection_);
}

} // namespace scanloom::session
