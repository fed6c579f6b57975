#include "server/sessions/replay_request.hpp"

#include "common/hash/sha256.hpp"
#include "core/mapping/reach.hpp"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <string>
#include <variant>

namespace scanloom::sessions {

std::string replay_id_of(const SessionInfo& session, const ReplayRequest& request) {
    std::string text = tag_of(session);
    if (request.end.revision) text += fmt::format(" until {}", *request.end.revision);
    if (request.end.stamp) text += fmt::format(" until {} s", *request.end.stamp);
    if (request.poses == ReplayPoses::kThen) text += " poses then";
    // With other exclusions, another scan may be the first one after the stamp.
    if (request.end.stamp && session.exclusions->revision() != 0) {
        text += fmt::format(" excluding {}", session.exclusions->revision());
    }
    for (const auto& field : mapping::config_fields()) {
        std::visit([&](const auto& value) { text += fmt::format("\n{} {}", field.name, value); },
                   mapping::value_of(field, request.config));
    }
    Sha256 hash;
    hash.update(std::as_bytes(std::span(text)));
    return hash.hex().substr(0, 16);
}

namespace {

std::string named(const mapping::Projection& projection, RobotIndex robot, const Sensor& sensor) {
    auto text = fmt::format("sensor {}", sensor.id);
    if (!sensor.name.empty()) text += fmt::format(" ('{}')", sensor.name);
    return text +
           fmt::format(" of robot '{}'", robot < projection.robots().size() ? projection.robots()[robot].name : "");
}

/// Returns the smallest cell size, in metres with whole millimetres, at which the sensor's range is allowed.
double cell_size_for(const Sensor& sensor) { return std::ceil(sensor.range_max / kReachCellsMax * 1e3) / 1e3; }

Error too_many_cells(const mapping::Projection& projection, const std::string& what) {
    return {Errc::kInvalidField,
            fmt::format("{} covers too many cells of {} metres to be computed at once; give a larger "
                        "cell_size",
                        what, projection.config().cell_size)};
}

template <class Other>
Result<> check(const mapping::Projection&, const Other&) { // an entry that changes no cells
    return {};
}

Result<> check(const mapping::Projection& projection, const SensorDescribed& described) {
    const auto& config = projection.config();
    const auto& sensor = described.sensor;
    if (mapping::check_reach(config, sensor)) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("{} reaches {} metres, more than {} cells of {} metres; give a cell_size of {} or more",
                             named(projection, described.robot, sensor), sensor.range_max, kReachCellsMax,
                             config.cell_size, cell_size_for(sensor))};
}

Result<> check(const mapping::Projection& projection, const ScanTaken& taken) {
    const auto sensor = projection.sensor_of(taken.robot, taken.scan.sensor);
    if (sensor == nullptr) return {};
    if (mapping::check_work(mapping::reach_of(projection.config(), *sensor, taken.scan))) return {};
    return too_many_cells(projection,
                          fmt::format("scan {} by {}", taken.scan.seq, named(projection, taken.robot, *sensor)));
}

Result<> check(const mapping::Projection& projection, const MapPatch& patch) {
    if (mapping::check_work(mapping::reach_of(projection.config(), patch))) return {};
    return too_many_cells(projection, "a part of the imported map");
}

} // namespace

Result<> check_replayable(const mapping::Projection& projection, const LogEntry& entry) {
    return std::visit([&](const auto& body) { return check(projection, body); }, entry);
}

} // namespace scanloom::sessions
