#include "server/http/handlers/handlers.hpp"

#include "server/http/geojson.hpp"
#include "server/http/handlers/parameters.hpp"
#include "server/sessions/stored_trajectories.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::http {
namespace {

/// Selects points of each robot and their properties other than the position.
struct TrajectoryParameters {
    Revision since = 0;
    bool with_times = false;
};

std::optional<bool> parse_bool(std::string_view text) {
    return text == "true" || text == "false" ? std::optional(text == "true") : std::nullopt;
}

/// The selected points of a robot: first those read from the log, then those in memory.
class Points {
public:
    /// Selects the points in memory after `since`, up to `until`.
    Points(const std::vector<mapping::TrajectoryPoint>& old, const mapping::TrajectoryView& kept, Revision since,
           Revision until)
        : old_(old), kept_(kept), first_kept_(kept.first_after(since)), end_kept_(kept.first_after(until)) {}

    [[nodiscard]] std::size_t size() const noexcept { return old_.size() + end_kept_ - first_kept_; }

    template <class Visit>
    void visit(Visit&& visit) const {
        for (const auto& point : old_) visit(point);
        for (std::size_t n = first_kept_; n < end_kept_; ++n) visit(kept_[n]);
    }

private:
    const std::vector<mapping::TrajectoryPoint>& old_;
    const mapping::TrajectoryView& kept_;
    std::size_t first_kept_;
    std::size_t end_kept_;
};

/// Appends `[...]`, where `append` writes each point.
template <class Append>
void append_list(std::string& text, const Points& points, Append&& append) {
    text += '[';
    points.visit([&, is_first = true](const mapping::TrajectoryPoint& point) mutable {
        if (!std::exchange(is_first, false)) text += ',';
        append(point);
    });
    text += ']';
}

double rounded_radians(double radians) {
    constexpr double kPerRadian = 1e4;
    return std::round(radians * kPerRadian) / kPerRadian + 0.0; // -0.0 + 0.0 is 0.0
}

void append_times(std::string& text, const Points& points) {
    const auto append_all = [&](std::string_view name, auto value) {
        fmt::format_to(std::back_inserter(text), R"(,"{}":)", name);
        append_list(text, points,
                    [&](const auto& point) { fmt::format_to(std::back_inserter(text), "{}", value(point)); });
    };
    append_all("revisions", [](const auto& point) { return point.revision; });
    append_all("stamps", [](const auto& point) { return point.stamp; });
    append_all("yaws", [](const auto& point) { return rounded_radians(point.pose.yaw); });
}

/// Written as text, because JSON values of a long trajectory would need many times its memory. Names are [A-Za-z0-9_-]
/// and need no escapes. Poses and stamps are known to be finite.
void append_feature(std::string& text, const std::string& robot, const Points& points, bool with_times) {
    fmt::format_to(std::back_inserter(text),
                   R"({{"type":"Feature","id":"{0}","properties":{{"robot":"{0}","points":{1})", robot, points.size());
    if (with_times) append_times(text, points);
    fmt::format_to(std::back_inserter(text), R"(}},"geometry":{{"type":"{}","coordinates":)",
                   points.size() < 2 ? "MultiPoint" : "LineString");
    append_list(text, points, [&](const auto& point) {
        fmt::format_to(std::back_inserter(text), "[{},{}]", rounded_metres(point.pose.x), rounded_metres(point.pose.y));
    });
    text += "}}";
}

std::size_t bytes_about(const mapping::Snapshot& snapshot, const TrajectoryParameters& asked) {
    const std::size_t point_bytes = asked.with_times ? 60 : 24;
    const std::size_t old = sessions::count_old_points(snapshot, asked.since);
    std::size_t points = old;
    for (const auto& robot : snapshot.robots)
        points += robot.trajectory.size() - robot.trajectory.first_after(asked.since);
    return std::min(points, sessions::kTrajectoryPointsMax) * point_bytes +
           std::min(old, sessions::kTrajectoryPointsMax) * sizeof(mapping::TrajectoryPoint);
}

} // namespace

Result<Response> get_trajectory(Context& context) {
    const auto since = since_parameter(context.query);
    if (!since) return since.error();
    const auto with_times = parameter(context.query, "times", false, parse_bool, "true or false is needed");
    if (!with_times) return with_times.error();
    const auto& session = context.session;
    const auto snapshot = session->snapshot();
    const TrajectoryParameters asked{since_in(*snapshot, *since), *with_times};
    auto permit = context.services.responses.take(bytes_about(*snapshot, asked));
    if (!permit) return permit.error();
    const auto old = sessions::read_old_paths(context.services.log, session->info().id, *snapshot, asked.since,
                                              [&] { return !context.services.sessions.is_draining(); });
    if (!old) return old.error();
    std::string text = fmt::format(
        R"({{"type":"FeatureCollection","frame_id":"map","units":"m","revision":{},"poses_corrected":{},"features":[)",
        old->until, snapshot->scan_poses.corrected());
    const char* separator = "";
    for (std::size_t n = 0; n < snapshot->robots.size(); ++n) {
        const auto& robot = snapshot->robots[n];
        text += std::exchange(separator, ",");
        append_feature(text, robot.name, {old->robots[n], robot.trajectory, asked.since, old->until}, asked.with_times);
    }
    text += "]}";
    return ok_text(kGeoJson, std::move(*permit), std::move(text));
}

} // namespace scanloom::http
