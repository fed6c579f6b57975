#include "server/foxglove/scene_messages.hpp"

#include "tests/support/class_map.hpp"

#include "foxglove/scene.pb.h"

#include <gmock/gmock.h>

namespace scanloom::foxglove {
namespace {

using testing::ElementsAre;

using Ends = std::vector<std::pair<double, double>>;

::foxglove::SceneEntity entity_of(const std::string& bytes) {
    ::foxglove::SceneUpdate update;
    EXPECT_TRUE(update.ParseFromString(bytes));
    EXPECT_EQ(update.entities_size(), 1);
    EXPECT_EQ(update.entities(0).frame_id(), "map");
    EXPECT_EQ(update.entities(0).timestamp().seconds(), 7);
    EXPECT_EQ(update.entities(0).timestamp().nanos(), 500'000'000);
    return update.entities(0);
}

Ends ends_of(const ::foxglove::LinePrimitive& lines) {
    EXPECT_EQ(lines.type(), ::foxglove::LinePrimitive::LINE_LIST);
    EXPECT_EQ(lines.pose().orientation().w(), 1.0);
    Ends ends;
    for (const auto& point : lines.points()) ends.emplace_back(point.x(), point.y());
    return ends;
}

TEST(SceneMessages, GoalsHaveTheNamesOfTheirRobots) {
    mapping::Snapshot maps;
    for (const char* name : {"a", "b"}) maps.robots.emplace_back().name = name;
    SessionView view;
    view.maps = std::make_shared<const mapping::Snapshot>(std::move(maps));
    view.guided = {{0, std::nullopt, {{1.0, 1.0}}}, {1, Point2{4.0, -5.0}, {}}};
    const auto entity = entity_of(goals_message(view, 7.5));
    ASSERT_EQ(entity.spheres_size(), 1);
    EXPECT_EQ(entity.spheres(0).pose().position().x(), 4.0);
    EXPECT_EQ(entity.spheres(0).pose().position().y(), -5.0);
    ASSERT_EQ(entity.texts_size(), 1);
    EXPECT_EQ(entity.texts(0).text(), "b");
}

TEST(SceneMessages, EdgesAreLinesByTheirKind) {
    localization::PoseGraphView graph;
    for (const double x : {0.0, 1.0, 2.0, 3.0}) graph.keyframes.push_back({0, {x, 0.0, 0.0}, x < 3.0});
    graph.keyframes.push_back({1, {4.0, 0.0, 0.0}, true});
    graph.edges = {{.from = 4, .to = 0}, // of a known map, which is no robot
                   {.from = 0, .to = 1},
                   {.from = 0, .to = 2, .is_robust = true, .weight = 0.9},
                   {.from = 1, .to = 2, .is_robust = true, .weight = 0.1},
                   {.from = 2, .to = 3}};
    const auto entity = entity_of(pose_graph_message(graph, 1, 7.5));
    ASSERT_EQ(entity.lines_size(), 3);
    EXPECT_EQ(ends_of(entity.lines(0)), (Ends{{0.0, 0.0}, {1.0, 0.0}})) << "the way, without what is not located";
    EXPECT_EQ(ends_of(entity.lines(1)), (Ends{{0.0, 0.0}, {2.0, 0.0}})) << "loops";
    EXPECT_EQ(ends_of(entity.lines(2)), (Ends{{1.0, 0.0}, {2.0, 0.0}})) << "switched off";
}

TEST(SceneMessages, FrontiersAreTheirCells) {
    mapping::Snapshot maps;
    maps.config.cell_size = 0.5;
    maps.classes = testing_support::drawn({"ffffffff", "........", "fff....."});
    const auto entity = entity_of(frontiers_message(maps, 7.5));
    ASSERT_EQ(entity.lines_size(), 1);
    const Ends ends = ends_of(entity.lines(0));
    ASSERT_EQ(ends.size(), 16U) << "three cells are too few";
    EXPECT_EQ(ends.front(), std::pair(0.0, 1.25));
    EXPECT_EQ(ends.back(), std::pair(4.0, 1.25));
}

} // namespace
} // namespace scanloom::foxglove
