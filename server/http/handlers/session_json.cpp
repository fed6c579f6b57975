#include "server/http/handlers/session_json.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/json_read.hpp"
#include "server/tiles/extent.hpp"

#include <boost/json/array.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <optional>

namespace scanloom::http {
namespace {

/// The one list of the options' names in JSON.
struct OptionName {
    std::string_view name;
    std::optional<double> SessionOptions::*option;
};

constexpr OptionName kOptions[] = {
    {"cell_size", &SessionOptions::cell_size},
    {"p_occupied", &SessionOptions::p_occupied},
    {"p_free", &SessionOptions::p_free},
    {"p_prior", &SessionOptions::p_prior},
    {"p_min", &SessionOptions::p_min},
    {"p_max", &SessionOptions::p_max},
    {"obstacle_thickness", &SessionOptions::obstacle_thickness},
    {"beam_aperture", &SessionOptions::beam_aperture},
};

std::string rfc3339(double seconds) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(std::floor(seconds))));
}

boost::json::object config_json(const mapping::MapConfig& config) {
    const SessionOptions options = mapping::options_of(config);
    boost::json::object json;
    for (const auto& [name, option] : kOptions) json[name] = *(options.*option);
    return json;
}

boost::json::value bounds_json(const mapping::Snapshot& snapshot) {
    if (snapshot.bounds.empty()) return nullptr;
    const auto extent = tiles::extent_of(snapshot.bounds, snapshot.config.cell_size);
    return boost::json::object{
        {"min_x", extent.min_x}, {"min_y", extent.min_y}, {"max_x", extent.max_x}, {"max_y", extent.max_y}};
}

boost::json::value pose_json(const std::optional<Pose2>& pose) {
    if (!pose) return nullptr;
    return boost::json::object{{"x", pose->x}, {"y", pose->y}, {"yaw", pose->yaw}};
}

} // namespace

boost::json::object to_json(const session::Session& session) {
    const auto snapshot = session.snapshot();
    boost::json::array robots;
    std::uint64_t scans = 0;
    for (RobotIndex index = 0; index < snapshot->robots.size(); ++index) {
        const auto& robot = snapshot->robots[index];
        scans += robot.scan_count;
        robots.push_back(boost::json::object{{"name", robot.name},
                                             {"connected", session.is_connected(index)},
                                             {"scans", robot.scan_count},
                                             {"last_seq", robot.last_seq},
                                             {"stamp", robot.stamp},
                                             {"pose", pose_json(robot.pose)}});
    }
    const auto& info = session.info();
    return {{"name", info.name},
            {"id", session_tag(info)},
            {"created", rfc3339(info.created)},
            {"revision", snapshot->revision},
            {"scans", scans},
            {"config", config_json(info.config)},
            {"layers", boost::json::array{kOccupancy}},
            {"bounds", bounds_json(*snapshot)},
            {"robots", std::move(robots)}};
}

Result<SessionRequest> parse_session_request(std::string_view body) {
    const auto object = parse_json_object(body);
    if (!object) return object.error();
    std::vector<std::string_view> known = {"name"};
    for (const auto& option : kOptions) known.push_back(option.name);
    if (auto ok = check_members(*object, known); !ok) return ok.error();

    SessionRequest wanted;
    auto name = read_text(*object, "name");
    if (!name) return name.error();
    wanted.name = std::move(*name);
    for (const auto& [option_name, option] : kOptions) {
        const auto number = read_number(*object, option_name);
        if (!number) return number.error();
        wanted.options.*option = *number;
    }
    return wanted;
}

} // namespace scanloom::http
