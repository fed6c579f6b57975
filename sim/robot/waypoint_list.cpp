#include "sim/robot/waypoint_list.hpp"

#include "common/scan/limits.hpp"
#include "common/text/parse_number.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

namespace scanloom::sim {
namespace {

constexpr std::size_t kWaypointsMax = 10'000;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t begin = text.find_first_not_of(kBlank);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::optional<double> as_coordinate(std::string_view text) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto value = parse_number<double>(text);
    return value && std::abs(*value) <= kCoordinateMax ? value : std::nullopt; // the comparison also rejects NaN
}

/// Parses "x,y" or "x y".
std::optional<Point2> as_waypoint(std::string_view text) {
    text = trimmed(text);
    const bool has_comma = text.find(',') != std::string_view::npos;
    const std::size_t between = has_comma ? text.find(',') : text.find_first_of(" \t");
    if (between == std::string_view::npos) return std::nullopt;
    const auto x = as_coordinate(text.substr(0, between));
    const auto y = as_coordinate(text.substr(between + 1));
    return x && y ? std::optional(Point2{*x, *y}) : std::nullopt;
}

Error no_waypoint(std::string_view where, std::size_t number, std::string_view text) {
    return {Errc::kInvalidField,
            fmt::format("--waypoints: {} {}: '{}' is not a waypoint; write x,y in metres, at most {} from the origin",
                        where, number, text, kCoordinateMax)};
}

Result<std::vector<Point2>> read_list(std::string_view list) {
    std::vector<Point2> waypoints;
    for (std::size_t number = 1; !list.empty(); ++number) {
        const std::string_view text = list.substr(0, list.find(';'));
        list.remove_prefix(std::min(list.size(), text.size() + 1));
        if (trimmed(text).empty() && list.empty()) break; // after the last separator
        const auto waypoint = as_waypoint(text);
        if (!waypoint) return no_waypoint("number", number, text);
        waypoints.push_back(*waypoint);
    }
    return waypoints;
}

Result<std::vector<Point2>> read_file(std::ifstream& file) {
    std::vector<Point2> waypoints;
    std::string line;
    for (std::size_t number = 1; std::getline(file, line) && waypoints.size() <= kWaypointsMax; ++number) {
        const std::string_view text = trimmed(std::string_view(line).substr(0, line.find('#')));
        if (text.empty()) continue;
        const auto waypoint = as_waypoint(text);
        if (!waypoint) return no_waypoint("line", number, text.substr(0, 40));
        waypoints.push_back(*waypoint);
    }
    return waypoints;
}

} // namespace

Result<std::vector<Point2>> read_waypoints(const std::string& list) {
    const bool is_list = list.find_first_not_of("0123456789+-.eE,; \t") == std::string::npos;
    std::ifstream file;
    if (!is_list) {
        file.open(list);
        if (!file) {
            return Error{Errc::kNotFound, fmt::format("--waypoints: '{}' is neither a list \"x,y;x,y;...\" nor a file "
                                                      "that can be read",
                                                      list)};
        }
    }
    auto waypoints = is_list ? read_list(list) : read_file(file);
    if (!waypoints) return waypoints;
    if (waypoints->empty()) return Error{Errc::kInvalidField, "--waypoints: the list is empty; give at least one"};
    if (waypoints->size() > kWaypointsMax) {
        return Error{Errc::kInvalidField,
                     fmt::format("--waypoints: there are more than {}; drive fewer", kWaypointsMax)};
    }
    return waypoints;
}

std::string to_text(const std::vector<Point2>& waypoints) {
    std::vector<std::string> texts;
    texts.reserve(waypoints.size());
    for (const Point2& waypoint : waypoints) texts.push_back(fmt::format("{},{}", waypoint.x, waypoint.y));
    return fmt::format("{}", fmt::join(texts, ";"));
}

} // namespace scanloom::sim
