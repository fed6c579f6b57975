#include "server/http/handlers/trajectory.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::http {
namespace {

/// Which points of each robot, and what of them besides where they are.
struct Asked {
    Revision since = 0;
    bool with_times = false;
};

Result<bool> times_parameter(const Query& query) {
    const auto text = query.find("times").value_or("false");
    if (text == "true" || text == "false") return text == "true";
    return Error{Errc::kInvalidField, fmt::format("times is {}; true or false is needed", in_quotes(text))};
}

/// `,"name":[...]` with what value(point) is of each point from `first` on.
template <class Value>
void append_list(std::string& text, std::string_view name, const mapping::TrajectoryView& points, std::size_t first,
                 Value&& value) {
    fmt::format_to(std::back_inserter(text), R"(,"{}":[)", name);
    for (std::size_t i = first; i < points.size(); ++i) {
        if (i > first) text += ',';
        fmt::format_to(std::back_inserter(text), "{}", value(points[i]));
    }
    text += ']';
}

double rounded_radians(double radians) {
    constexpr double kPerRadian = 1e4;
    return std::round(radians * kPerRadian) / kPerRadian + 0.0; // -0.0 + 0.0 is 0.0
}

void append_times(std::string& text, const mapping::TrajectoryView& points, std::size_t first) {
    append_list(text, "revisions", points, first, [](const auto& point) { return point.revision; });
    append_list(text, "stamps", points, first, [](const auto& point) { return point.stamp; });
    append_list(text, "yaws", points, first, [](const auto& point) { return rounded_radians(point.pose.yaw); });
}

/// Written straight into the text: a long path would be many times its size as JSON values.
/// Names are [A-Za-z0-9_-] and need no escapes; poses and stamps were checked to be finite.
void append_feature(std::string& text, const mapping::RobotState& robot, const Asked& asked) {
    const auto& points = robot.trajectory;
    const std::size_t first = points.first_after(asked.since);
    const std::size_t count = points.size() - first;
    fmt::format_to(std::back_inserter(text),
                   R"({{"type":"Feature","id":"{0}","properties":{{"robot":"{0}","points":{1})", robot.name, count);
    if (asked.with_times) append_times(text, points, first);
    fmt::format_to(std::back_inserter(text), R"(}},"geometry":{{"type":"{}","coordinates":[)",
                   count < 2 ? "MultiPoint" : "LineString");
    for (std::size_t i = first; i < points.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{}[{},{}]", i == first ? "" : ",", rounded_metres(points[i].pose.x),
                       rounded_metres(points[i].pose.y));
    }
    text += "]}}";
}

std::size_t bytes_about(const mapping::Snapshot& snapshot, const Asked& asked) {
    const std::size_t point_bytes = asked.with_times ? 60 : 24;
    std::size_t points = 0;
    for (const auto& robot : snapshot.robots)
        points += robot.trajectory.size() - robot.trajectory.first_after(asked.since);
    return points * point_bytes;
}

} // namespace

Result<Response> get_trajectory(session::SessionRegistry& sessions, const AnswerSlots& slots, const Call& call) {
    if (auto known = call.query.check_only({"since", "times"}); !known) return known.error();
    const auto since = since_parameter(call.query);
    if (!since) return since.error();
    const auto with_times = times_parameter(call.query);
    if (!with_times) return with_times.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();

    const auto snapshot = (*session)->snapshot();
    const Asked asked{since_in(*snapshot, *since), *with_times};
    auto slot = slots.take(bytes_about(*snapshot, asked));
    if (!slot) return slot.error();
    std::string text = fmt::format(
        R"({{"type":"FeatureCollection","frame_id":"map","units":"m","revision":{},"features":[)", snapshot->revision);
    const char* separator = "";
    for (const auto& robot : snapshot->robots) {
        text += separator;
        append_feature(text, robot, asked);
        separator = ",";
    }
    text += "]}";
    struct Path {
        std::shared_ptr<const void> slot;
        std::string text;
    };
    const auto path = std::make_shared<const Path>(Path{std::move(*slot), std::move(text)});
    return ok(kGeoJson, Body(std::shared_ptr<const std::string>(path, &path->text))).set("Cache-Control", kNotKept);
}

} // namespace scanloom::http
