#pragma once

#include "core/mapping/snapshot.hpp"
#include "server/tiles/tile.hpp"

#include "scanloom/v1/live.pb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::testing_support {

/// The state of a viewer that read every event sent to it and has no other data. Parses the wire format without the
/// code under test.
class LiveReplay {
public:
    struct Robot {
        std::string name;
        bool connected = false;
        std::uint64_t scan_count = 0;
        std::uint64_t last_seq = 0;
        double stamp = 0.0;
        bool has_pose = false;
        Pose2 pose;
        std::map<std::uint64_t, std::pair<std::int64_t, std::int64_t>> trail; // millimetres, by the point's number
        v1::ScanPoints scan;
        v1::RobotLocalization localization;
    };
    using Tiles = std::map<std::uint32_t, Revision>; // by 512 y + x

    void take(std::string_view message) {
        v1::LiveEvent event;
        if (!event.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
            throw std::runtime_error("this is no LiveEvent");
        }
        take(event);
    }

    void take(const v1::LiveEvent& event) {
        EXPECT_GE(event.revision(), last.revision());
        if (event.poses_corrected() != last.poses_corrected()) {
            for (auto& [index, robot] : robots) robot.trail.clear();
        }
        for (const auto& changes : event.tiles()) take(changes, event.revision());
        for (const auto& robot : event.robots()) take(robot);
        if (event.has_landmarks()) take(event.landmarks());
        last = event;
        ++events;
    }

    /// Fails the test if this state differs from the snapshot.
    void expect_equal_to(const mapping::Snapshot& maps, const std::vector<bool>& connected) const {
        EXPECT_EQ(last.revision(), maps.revision);
        EXPECT_EQ(last.counters().chunks(), maps.chunk_count);
        for (const mapping::Layer layer : mapping::kLayers) {
            const auto number = static_cast<int>(layer_number(layer));
            if (everything.contains(number)) continue;
            Tiles expected;
            for (const auto& [key, revision] : tiles::changed_tiles(maps, layer, 0)) {
                if (key.zoom == 9) expected[512 * key.y + key.x] = revision;
            }
            const auto known = tiles.find(number);
            EXPECT_EQ(known == tiles.end() ? Tiles() : known->second, expected) << mapping::name_of(layer);
        }
        ASSERT_EQ(robots.size(), maps.robots.size());
        for (std::size_t n = 0; n < maps.robots.size(); ++n) {
            expect_equal(robots.at(static_cast<std::uint32_t>(n)), maps.robots[n]);
            EXPECT_EQ(robots.at(static_cast<std::uint32_t>(n)).connected, n < connected.size() && connected[n]);
        }
    }

    v1::LiveEvent last;
    int events = 0;
    std::map<int, Tiles> tiles; // by v1::Layer
    std::set<int> everything;   // layers in which too many tiles changed at once
    std::map<std::uint32_t, Robot> robots;
    std::map<std::uint32_t, v1::LiveLandmark> landmarks; // by id
    v1::LandmarkChanges last_landmarks;

private:
    static v1::Layer layer_number(mapping::Layer layer) {
        switch (layer) {
        case mapping::Layer::kHimm: return v1::LAYER_HIMM;
        case mapping::Layer::kSonar: return v1::LAYER_SONAR;
        case mapping::Layer::kClassification: return v1::LAYER_CLASSIFICATION;
        default: return v1::LAYER_OCCUPANCY;
        }
    }

    void take(const v1::TileChanges& changes, Revision now) {
        if (changes.everything()) everything.insert(changes.layer());
        ASSERT_EQ(changes.tiles_size(), changes.revisions_size());
        for (int n = 0; n < changes.tiles_size(); ++n) {
            EXPECT_LE(changes.revisions(n), now);
            if (n > 0) {
                EXPECT_LT(changes.tiles(n - 1), changes.tiles(n));
            }
            tiles[changes.layer()][changes.tiles(n)] = changes.revisions(n);
        }
    }

    void take(const v1::LandmarkChanges& changes) {
        EXPECT_GE(changes.revision(), last_landmarks.revision());
        for (const auto& landmark : changes.landmarks()) landmarks[landmark.id()] = landmark;
        last_landmarks = changes;
    }

    void take(const v1::RobotUpdate& update) {
        Robot& robot = robots[update.robot()];
        robot.name = update.name();
        robot.connected = update.connected();
        robot.scan_count = update.scan_count();
        robot.last_seq = update.last_seq();
        robot.stamp = update.stamp();
        robot.has_pose = update.has_pose();
        robot.pose = {update.pose().x(), update.pose().y(), update.pose().yaw()};
        std::int64_t x = 0;
        std::int64_t y = 0;
        for (int n = 0; n + 1 < update.trail_size(); n += 2) {
            x += update.trail(n);
            y += update.trail(n + 1);
            robot.trail[update.trail_from() + static_cast<std::uint64_t>(n / 2)] = {x, y};
        }
        if (update.has_scan()) robot.scan = update.scan();
        robot.localization = update.localization();
    }

    static void expect_equal(const Robot& robot, const mapping::RobotState& state) {
        EXPECT_EQ(robot.name, state.name);
        EXPECT_EQ(robot.scan_count, state.scan_count);
        EXPECT_EQ(robot.last_seq, state.last_seq);
        EXPECT_EQ(robot.stamp, state.stamp);
        ASSERT_EQ(robot.has_pose, state.pose.has_value());
        if (state.pose) {
            EXPECT_EQ(robot.pose, *state.pose);
        }
        if (state.trajectory.size() > 0) {
            EXPECT_EQ(robot.trail.rbegin()->first + 1, state.trajectory.size());
        }
        for (const auto& [number, point] : robot.trail) {
            if (number < state.trajectory.begin()) continue;
            EXPECT_NEAR(static_cast<double>(point.first) / 1000.0, state.trajectory[number].pose.x, 0.0005);
            EXPECT_NEAR(static_cast<double>(point.second) / 1000.0, state.trajectory[number].pose.y, 0.0005);
        }
        if (state.newest_scan) {
            EXPECT_EQ(robot.scan.stamp(), state.newest_scan->scan.stamp);
            const Pose2 origin = compose(*state.newest_scan->scan.pose, state.newest_scan->sensor->mount);
            EXPECT_EQ(robot.scan.origin().x(), origin.x);
            EXPECT_EQ(robot.scan.origin().y(), origin.y);
        }
    }
};

} // namespace scanloom::testing_support
