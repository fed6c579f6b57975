#include "server/foxglove/scene_messages.hpp"

#include "core/classify/frontiers.hpp"
#include "server/foxglove/log_time.hpp"
#include "server/foxglove/robot_messages.hpp"

#include "foxglove/scene.pb.h"

#include <cstdint>

namespace scanloom::foxglove {
namespace {

struct Rgb {
    double red, green, blue;
};

constexpr Rgb kGrey{0.5, 0.5, 0.5};
constexpr Rgb kBlue{0.12, 0.47, 0.71};
constexpr Rgb kOrange{1.0, 0.5, 0.05};
constexpr Rgb kRed{0.84, 0.15, 0.16};
constexpr Rgb kGreen{0.17, 0.63, 0.17};

void set(const Rgb& rgb, ::foxglove::Color& color) {
    color.set_r(rgb.red);
    color.set_g(rgb.green);
    color.set_b(rgb.blue);
    color.set_a(1.0);
}

void set(const Point2& place, ::foxglove::Pose& pose) {
    pose.mutable_position()->set_x(place.x);
    pose.mutable_position()->set_y(place.y);
    pose.mutable_orientation()->set_w(1.0);
}

::foxglove::SceneEntity& add_entity(const char* id, double stamp, ::foxglove::SceneUpdate& update) {
    ::foxglove::SceneEntity& entity = *update.add_entities();
    constexpr std::int64_t kSecond = 1'000'000'000; // nanoseconds
    const std::int64_t time = nanoseconds_of(stamp);
    entity.mutable_timestamp()->set_seconds(time / kSecond);
    entity.mutable_timestamp()->set_nanos(static_cast<std::int32_t>(time % kSecond));
    entity.set_frame_id(std::string(kMapFrame));
    entity.set_id(id);
    return entity;
}

void add_sphere(const Point2& place, double diameter, const Rgb& rgb, ::foxglove::SceneEntity& entity) {
    ::foxglove::SpherePrimitive& sphere = *entity.add_spheres();
    set(place, *sphere.mutable_pose());
    sphere.mutable_size()->set_x(diameter);
    sphere.mutable_size()->set_y(diameter);
    sphere.mutable_size()->set_z(diameter);
    set(rgb, *sphere.mutable_color());
}

::foxglove::LinePrimitive& add_lines(const Rgb& rgb, ::foxglove::SceneEntity& entity) {
    constexpr double kPixels = 2.0;
    ::foxglove::LinePrimitive& lines = *entity.add_lines();
    lines.set_type(::foxglove::LinePrimitive::LINE_LIST);
    set(Point2{0.0, 0.0}, *lines.mutable_pose());
    lines.set_thickness(kPixels);
    lines.set_scale_invariant(true);
    set(rgb, *lines.mutable_color());
    return lines;
}

void add_end(const Pose2& pose, ::foxglove::LinePrimitive& lines) {
    ::foxglove::Point3& point = *lines.add_points();
    point.set_x(pose.x);
    point.set_y(pose.y);
}

} // namespace

std::string landmarks_message(const landmarks::LandmarkView& landmarks, double stamp) {
    constexpr double kDiameter = 0.2; // metres
    ::foxglove::SceneUpdate update;
    ::foxglove::SceneEntity& entity = add_entity("landmarks", stamp, update);
    for (std::size_t n = 0; n < landmarks.size(); ++n) {
        add_sphere(landmarks[n].landmark.position, kDiameter, kOrange, entity);
    }
    return update.SerializeAsString();
}

std::string frontiers_message(const mapping::Snapshot& maps, double stamp) {
    const double cell_size = maps.config.cell_size;
    ::foxglove::SceneUpdate update;
    ::foxglove::SceneEntity& entity = add_entity("frontiers", stamp, update);
    ::foxglove::LinePrimitive& lines = add_lines(kGreen, entity);
    std::size_t shown = 0;
    for (const classify::Frontier& frontier : classify::find_frontiers(maps.classes, kFrontierCells)) {
        for (const grid::Cell& cell : frontier.cells) {
            if (shown++ == kFrontierCellsShown) return update.SerializeAsString();
            const double y = (cell.j + 0.5) * cell_size;
            add_end({cell.i * cell_size, y, 0.0}, lines);
            add_end({(cell.i + 1) * cell_size, y, 0.0}, lines);
        }
    }
    return update.SerializeAsString();
}

std::string goals_message(const SessionView& session, double stamp) {
    constexpr double kDiameter = 0.4;  // metres
    constexpr double kTextSize = 14.0; // pixels
    ::foxglove::SceneUpdate update;
    ::foxglove::SceneEntity& entity = add_entity("goals", stamp, update);
    for (const Guided& guided : session.guided) {
        if (!guided.goal) continue;
        add_sphere(*guided.goal, kDiameter, kGreen, entity);
        ::foxglove::TextPrimitive& text = *entity.add_texts();
        set(*guided.goal, *text.mutable_pose());
        text.set_billboard(true);
        text.set_font_size(kTextSize);
        text.set_scale_invariant(true);
        set(kGreen, *text.mutable_color());
        text.set_text(session.maps->robots[guided.robot].name);
    }
    return update.SerializeAsString();
}

std::string pose_graph_message(const localization::PoseGraphView& graph, std::size_t robots, double stamp) {
    const auto is_shown = [&](const auto& keyframe) { return keyframe.is_located && keyframe.robot < robots; };
    ::foxglove::SceneUpdate update;
    ::foxglove::SceneEntity& entity = add_entity("pose_graph", stamp, update);
    ::foxglove::LinePrimitive& way = add_lines(kGrey, entity);
    ::foxglove::LinePrimitive& loops = add_lines(kBlue, entity);
    ::foxglove::LinePrimitive& unused = add_lines(kRed, entity);
    for (const slam::Edge& edge : graph.edges) {
        const auto& from = graph.keyframes[edge.from];
        const auto& to = graph.keyframes[edge.to];
        if (!is_shown(from) || !is_shown(to)) continue;
        ::foxglove::LinePrimitive& lines = !edge.is_robust ? way : edge.weight < slam::kUsedWeight ? unused : loops;
        add_end(from.pose, lines);
        add_end(to.pose, lines);
    }
    return update.SerializeAsString();
}

} // namespace scanloom::foxglove
