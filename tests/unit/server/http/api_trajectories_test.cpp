#include "tests/unit/server/http/api_poses_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

/// Trajectories and pose graphs as files.
namespace scanloom::http {
namespace {

/// A pose of a line of trajectory.tum.
struct TumPose {
    double stamp = 0.0; // seconds
    Pose2 pose;         // T_map_robot
};

/// Parses trajectory.tum.
std::map<std::string, std::vector<TumPose>> read_tum(const std::string& text) {
    std::map<std::string, std::vector<TumPose>> robots;
    std::vector<TumPose>* robot = nullptr;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("# robot ")) {
            robot = &robots[line.substr(8)];
            continue;
        }
        std::istringstream values(line);
        TumPose at;
        double z = 0.0;
        double qx = 0.0;
        double qy = 0.0;
        double qz = 0.0;
        double qw = 0.0;
        values >> at.stamp >> at.pose.x >> at.pose.y >> z >> qx >> qy >> qz >> qw;
        EXPECT_TRUE(values && values.eof() && robot != nullptr) << line;
        EXPECT_EQ(std::tie(z, qx, qy), std::tuple(0.0, 0.0, 0.0)) << line;
        EXPECT_NEAR(std::hypot(qz, qw), 1.0, 1e-6) << line;
        at.pose.yaw = 2.0 * std::atan2(qz, qw);
        robot->push_back(at);
    }
    return robots;
}

class ApiTrajectoriesTest : public ApiPosesTest {
protected:
    std::map<std::string, std::vector<TumPose>> tum(const std::string& query = "") {
        const auto response = get("/api/v1/sessions/a/trajectory.tum" + query);
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), "text/plain; charset=utf-8");
        return read_tum(std::string(response.body.bytes()));
    }
};

TEST_F(ApiTrajectoriesTest, TumTrajectoryHasEstimatedPoseOfEachScan) {
    drive_lap();
    const auto robots = tum();
    ASSERT_EQ(robots.size(), 1U);
    const auto& poses = robots.at("r1");
    ASSERT_EQ(poses.size(), lap().scans.size());
    for (std::size_t n = 0; n < poses.size(); ++n) EXPECT_NEAR(poses[n].stamp, stamp_of(n), 1e-6);
    EXPECT_LT(slam::largest_error(lap(), [&](std::size_t n) { return poses[n].pose; }), 0.3);
}

TEST_F(ApiTrajectoriesTest, OnlineTrajectoryHasPosesAsFirstEstimated) {
    drive_lap();
    const auto newest = tum("?robot=r1").at("r1");
    const auto online = tum("?robot=r1&as=online").at("r1");
    ASSERT_EQ(online.size(), newest.size());
    double largest = 0.0;
    for (std::size_t n = 0; n < online.size(); ++n) {
        EXPECT_EQ(online[n].stamp, newest[n].stamp);
        largest =
            std::max(largest, std::hypot(online[n].pose.x - newest[n].pose.x, online[n].pose.y - newest[n].pose.y));
    }
    EXPECT_GT(largest, 0.05) << "the end of the lap corrects its poses";
}

TEST_F(ApiTrajectoriesTest, TumTrajectoryLeavesOutExcludedScans) {
    drive_lap(40);
    ASSERT_EQ(ask("POST", "/api/v1/sessions/a/exclude", R"({"robot": "r1", "from": "seq:11", "to": "seq:20"})").status,
              Status::created);
    for (const char* query : {"", "?as=online"}) {
        const auto poses = tum(query).at("r1");
        ASSERT_EQ(poses.size(), 30U) << query;
        EXPECT_NEAR(poses[9].stamp, stamp_of(9), 1e-6);
        EXPECT_NEAR(poses[10].stamp, stamp_of(20), 1e-6);
    }
}

TEST_F(ApiTrajectoriesTest, TumTrajectoryOfRobotThatSendsPosesHasThese) {
    stream("a", "r1", {scan(1), scan(2)});
    stream("a", "r2", {scan(1)});
    const auto both = tum();
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both.at("r2").size(), 1U);
    const auto one = tum("?robot=r1");
    ASSERT_EQ(one.size(), 1U);
    ASSERT_EQ(one.at("r1").size(), 2U);
    for (const std::uint64_t seq : {1U, 2U}) {
        const auto& at = one.at("r1")[seq - 1];
        EXPECT_EQ(at.stamp, scan(seq).stamp);
        EXPECT_EQ(at.pose, *scan(seq).pose);
    }
    EXPECT_EQ(tum("?as=online").at("r1").size(), 2U);
    EXPECT_THAT(get_json("/api/v1/sessions/a/pose_graph.geojson").at("features").as_array(), testing::IsEmpty());
}

TEST_F(ApiTrajectoriesTest, TrajectoryOfUnknownRobotOrEstimateIsRefused) {
    stream("a", 1);
    const std::string tum = "/api/v1/sessions/a/trajectory.tum";
    EXPECT_THAT(detail(get(tum + "?robot=r7"), Status::not_found), HasSubstr("r7"));
    EXPECT_THAT(detail(get(tum + "?as=first"), Status::bad_request), HasSubstr("online is possible"));
}

TEST_F(ApiTrajectoriesTest, KittiTrajectoryHasThePosesOfTheTumTrajectory) {
    stream("a", "r1", {scan(1), scan(2)});
    const std::string path = "/api/v1/sessions/a/trajectory.kitti";
    const std::string text(get(path).body.bytes());
    std::istringstream values(text);
    const auto robots = tum();
    for (const auto& [stamp, pose] : robots.at("r1")) {
        double m[12] = {};
        for (double& value : m) values >> value;
        EXPECT_NEAR(m[3], pose.x, 1e-6);
        EXPECT_NEAR(m[7], pose.y, 1e-6);
        EXPECT_NEAR(std::atan2(m[4], m[0]), pose.yaw, 1e-6);
    }
    EXPECT_FALSE(values >> std::ws && values.peek() != EOF);
    stream("a", "r2", {scan(1)});
    EXPECT_THAT(detail(get(path), Status::bad_request), HasSubstr("request one at a time"));
    EXPECT_EQ(get(path + "?robot=r1").body.bytes(), text);
}

TEST_F(ApiTrajectoriesTest, G2oHasTheKeyframesAndUsedEdgesOfThePoseGraph) {
    drive_lap();
    const auto graph = get_json("/api/v1/sessions/a/pose_graph.geojson");
    std::map<std::string, int> expected;
    for (const auto& feature : graph.at("features").as_array()) {
        const auto& of = feature.at("properties").as_object();
        if (!of.contains("is_used")) ++expected["VERTEX_SE2"];
        if (of.contains("is_used") && of.at("is_used").as_bool()) ++expected["EDGE_SE2"];
    }
    std::map<std::string, int> found;
    std::istringstream lines(std::string(get("/api/v1/sessions/a/pose_graph.g2o").body.bytes()));
    for (std::string line; std::getline(lines, line);) ++found[line.substr(0, line.find(' '))];
    EXPECT_EQ(found, expected);
}

TEST_F(ApiTrajectoriesTest, PoseGraphHasKeyframesAndTheirEdges) {
    drive_lap();
    const auto graph = get_json("/api/v1/sessions/a/pose_graph.geojson");
    std::map<std::string, int> kinds;
    for (const auto& feature : graph.at("features").as_array()) {
        const auto& of = feature.at("properties");
        const std::string kind(of.at("kind").as_string());
        ++kinds[kind];
        EXPECT_EQ(of.at("robot"), "r1");
        const bool is_keyframe = kind == "keyframe";
        EXPECT_EQ(feature.at("geometry").at("type"), is_keyframe ? "Point" : "LineString");
        if (is_keyframe) {
            EXPECT_EQ(of.at("keyframe").to_number<int>(), kinds[kind] - 1);
            continue;
        }
        EXPECT_LT(of.at("from").to_number<int>(), kinds["keyframe"]);
        EXPECT_LT(of.at("to").to_number<int>(), kinds["keyframe"]);
        if (of.at("is_used").as_bool()) {
            EXPECT_LT(of.at("residual").to_number<double>(), 0.3);
        }
    }
    EXPECT_GE(kinds["keyframe"], 100) << "each 0.8 m or 0.4 radians";
    EXPECT_EQ(kinds["match"], kinds["keyframe"] - 1) << "each follows from another";
    EXPECT_GT(kinds["loop"], 0) << "at the end of the lap";
}

} // namespace
} // namespace scanloom::http
