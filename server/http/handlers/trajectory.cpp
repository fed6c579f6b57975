#include "server/http/handlers/trajectory.hpp"

#include "server/http/handlers/session_lookup.hpp"
#include "server/http/number.hpp"

#include <fmt/format.h>

#include <iterator>
#include <memory>
#include <string>
#include <utility>

namespace scanloom::http {
namespace {

/// Written straight into the text: a long path would be many times its size as JSON values.
/// Names are [A-Za-z0-9_-] and need no escapes; poses were checked to be finite.
void append_feature(std::string& text, const mapping::RobotState& robot, Revision since) {
    const auto& points = robot.trajectory;
    const std::size_t first = points.first_after(since);
    const std::size_t count = points.size() - first;
    fmt::format_to(std::back_inserter(text),
                   R"({{"type":"Feature","id":"{0}","properties":{{"robot":"{0}","points":{1}}},)"
                   R"("geometry":{{"type":"{2}","coordinates":[)",
                   robot.name, count, count < 2 ? "MultiPoint" : "LineString");
    for (std::size_t i = first; i < points.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{}[{},{}]", i == first ? "" : ",", rounded_metres(points[i].pose.x),
                       rounded_metres(points[i].pose.y));
    }
    text += "]}}";
}

std::size_t bytes_about(const mapping::Snapshot& snapshot, Revision since) {
    constexpr std::size_t kPointBytes = 24;
    std::size_t points = 0;
    for (const auto& robot : snapshot.robots) points += robot.trajectory.size() - robot.trajectory.first_after(since);
    return points * kPointBytes;
}

} // namespace

Result<Response> get_trajectory(const session::SessionRegistry& sessions, const AnswerSlots& slots, const Call& call) {
    if (auto known = call.query.check_only({"since"}); !known) return known.error();
    const auto since = since_parameter(call.query);
    if (!since) return since.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();

    const auto snapshot = (*session)->snapshot();
    const Revision after = since_in(*snapshot, *since);
    auto slot = slots.take(bytes_about(*snapshot, after));
    if (!slot) return slot.error();
    std::string text = fmt::format(
        R"({{"type":"FeatureCollection","frame_id":"map","units":"m","revision":{},"features":[)", snapshot->revision);
    const char* separator = "";
    for (const auto& robot : snapshot->robots) {
        text += separator;
        append_feature(text, robot, after);
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
