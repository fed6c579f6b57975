#include "server/http/handlers/session_json.hpp"

#include "core/mapping/map_config.hpp"
#include "server/http/handlers/lookup.hpp"
#include "server/http/json_read.hpp"
#include "server/http/text.hpp"
#include "server/tiles/map_image.hpp"

#include <boost/json/array.hpp>
#include <boost/json/value.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string_view>
#include <variant>

namespace scanloom::http {
namespace {

std::string rfc3339(double seconds) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(static_cast<std::time_t>(std::floor(seconds))));
}

boost::json::value bounds_json(const grid::CellBox& bounds, double cell_size) {
    if (bounds.empty()) return nullptr;
    return to_json(tiles::extent_of(bounds, cell_size));
}

boost::json::array layer_names() {
    boost::json::array names;
    for (const mapping::Layer layer : mapping::kLayers) names.emplace_back(mapping::name_of(layer));
    return names;
}

boost::json::value pose_json(const std::optional<Pose2>& pose) {
    if (!pose) return nullptr;
    return boost::json::object{{"x", rounded_metres(pose->x)}, {"y", rounded_metres(pose->y)}, {"yaw", pose->yaw}};
}

boost::json::value number_json(const std::optional<double>& number) {
    if (!number) return nullptr;
    return *number;
}

boost::json::object localization_json(const mapping::RobotState& robot) {
    const auto& known = robot.localization;
    return {{"poses", name_of(robot.poses)},
            {"state", name_of(known.state)},
            {"inliers", known.inlier_ratio},
            {"sigma_m", known.position_sigma},
            {"sigma_rad", known.yaw_sigma},
            {"loops", known.loops},
            {"corrections", known.corrections},
            {"unplaced", robot.unplaced},
            {"mount_yaw_error", number_json(known.mount_yaw_error)}};
}

/// @param session  null if it is not in memory
boost::json::object session_json(const sessions::SessionInfo& info, const mapping::Snapshot& snapshot,
                                 const sessions::Session* session, std::optional<std::string> failure) {
    boost::json::array robots;
    std::uint64_t scans = 0;
    for (RobotIndex index = 0; index < snapshot.robots.size(); ++index) {
        const auto& robot = snapshot.robots[index];
        scans += robot.scan_count;
        robots.push_back(boost::json::object{{"name", robot.name},
                                             {"connected", session != nullptr && session->is_connected(index)},
                                             {"scans", robot.scan_count},
                                             {"jumps", robot.jumps},
                                             {"excluded", robot.excluded},
                                             {"last_seq", robot.last_seq},
                                             {"stamp", robot.stamp},
                                             {"pose", pose_json(robot.pose)},
                                             {"localization", localization_json(robot)},
                                             {"body_radius", number_json(robot.body_radius)}});
    }
    const auto main_bounds = session == nullptr ? grid::CellBox() : session->main_bounds();
    if (const auto own = session == nullptr ? std::nullopt : session->failure()) failure = own->message;
    boost::json::object json{{"name", info.name},
                             {"state", failure ? "failed" : "ok"},
                             {"loaded", session != nullptr},
                             {"id", session_tag(info)},
                             {"created", rfc3339(info.created)},
                             {"number", info.id},
                             {"revision", snapshot.revision},
                             {"exclusions", snapshot.exclusions->revision()},
                             {"scans", scans},
                             {"moving_scans", snapshot.moving_scans},
                             {"localize_only", snapshot.is_localize_only},
                             {"config", to_json(info.config)},
                             {"layers", layer_names()},
                             {"bounds", bounds_json(mapping::bounds_of(snapshot), info.config.cell_size)},
                             {"main_bounds", bounds_json(main_bounds, info.config.cell_size)},
                             {"robots", std::move(robots)}};
    if (failure) json["reason"] = *failure;
    return json;
}

} // namespace

boost::json::object to_json(const tiles::Extent& extent) {
    return {{"min_x", rounded_metres(extent.min_x)},
            {"min_y", rounded_metres(extent.min_y)},
            {"max_x", rounded_metres(extent.max_x)},
            {"max_y", rounded_metres(extent.max_y)}};
}

boost::json::object to_json(const sessions::Session& session) {
    return session_json(session.info(), *session.snapshot(), &session, std::nullopt);
}

boost::json::object to_json(const sessions::ListedSession& listed, std::optional<std::string> store_failure) {
    const auto* session = listed.session.get();
    const auto maps = session == nullptr ? listed.summary.facts : session->snapshot();
    auto json = session_json(listed.info, *maps, session, std::move(store_failure));
    if (const auto& owner = listed.shared.owner) {
        json["node"] = owner->name;
        json["revision"] = listed.shared.end;
    }
    return json;
}

boost::json::object failed_json(std::string_view name, const Error& reason) {
    return {{"name", name}, {"state", "failed"}, {"reason", reason.message}};
}

boost::json::object damaged_json(std::string_view name, const Error& reason) {
    return {{"name", name},
            {"state", reason.code == Errc::kOverloaded ? "not_loaded" : "damaged"},
            {"reason", reason.message}};
}

Result<SessionRequest> parse_session_request(std::string_view body) {
    std::vector<std::string_view> known = {"name", "localize_only"};
    for (const auto& field : mapping::config_fields()) known.push_back(field.name);
    const auto object = parse_json_object(body, known);
    if (!object) return object.error();

    SessionRequest wanted;
    auto name = read_text(*object, "name");
    if (!name) return name.error();
    wanted.name = std::move(*name);
    const auto localize_only = read_flag(*object, "localize_only");
    if (!localize_only) return localize_only.error();
    wanted.is_localize_only = localize_only->value_or(false);
    if (auto read = read_options(*object, wanted.options); !read) return read.error();
    return wanted;
}

namespace {

/// Converts a value to the type that a configuration field accepts. A value of no such type becomes an empty string.
mapping::ConfigValue config_value(const boost::json::value& json) {
    if (json.is_bool()) return json.get_bool();
    if (json.is_string()) return std::string_view(json.get_string());
    boost::system::error_code not_whole;
    if (const auto whole = json.to_number<std::int32_t>(not_whole); !not_whole) return whole;
    boost::system::error_code no_number;
    if (const auto number = json.to_number<double>(no_number); !no_number) return number;
    return std::string_view();
}

boost::json::value value_json(const mapping::ConfigValue& value) {
    return std::visit([](const auto& held) { return boost::json::value(held); }, value);
}

} // namespace

boost::json::object to_json(const mapping::MapConfig& config) {
    boost::json::object json;
    for (const auto& field : mapping::config_fields()) json[field.name] = value_json(mapping::value_of(field, config));
    return json;
}

Result<> read_options(const boost::json::object& object, SessionOptions& options) {
    for (const auto& field : mapping::config_fields()) {
        const auto* given = object.if_contains(field.name);
        if (given == nullptr) continue;
        if (auto set = mapping::set_option(options, field, config_value(*given)); !set) return set.error();
    }
    return {};
}

} // namespace scanloom::http
