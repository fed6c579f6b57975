#include "tests/unit/core/slam/drive.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <future>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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

/// A lap of a corridor and a quarter, with odometry that drifts by metres.
const slam::Drive& lap() {
    static const slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

class ApiPosesTest : public ApiTest {
protected:
    void SetUp() override { create("a"); }

    /// Joins a robot with any poses.
    std::shared_ptr<Link> join_as(Poses poses, std::uint64_t awaited_seq, const std::string& session = "a") {
        const auto link = std::make_shared<Link>(awaited_seq);
        std::promise<void> joined;
        registry_.find(session)->join({.robot = "r1", .poses = poses}, link,
                                      [&joined](const Result<sessions::Joined>&) { joined.set_value(); });
        joined.get_future().wait();
        links_.push_back(link);
        return link;
    }

    /// Sends scans that fit nothing, after those of the lap.
    void carry_away() {
        constexpr std::size_t kScans = 25;
        const auto before = registry_.find("a")->snapshot()->robots.at(0).last_seq;
        std::mt19937 random(1);
        std::vector<Scan> scans;
        for (std::size_t n = before; n < before + kScans; ++n) {
            Scan scan{.seq = n + 1, .stamp = stamp_of(n), .ranges = lap().scans[0].ranges};
            for (auto& range : scan.ranges) range = 500 + static_cast<std::uint32_t>(random() % 10'000);
            scan.odometry = lap().odometry[before];
            scans.push_back(std::move(scan));
        }
        send(std::move(scans), Poses::kOdometry, "a");
    }

    /// Sends the scans of the lap that the session does not have, and waits until none of them is moving.
    void drive_lap(std::size_t end = lap().scans.size(), Poses poses = Poses::kOdometry,
                   const std::string& name = "a") {
        const auto session = registry_.find(name);
        const auto& robots = session->snapshot()->robots;
        std::vector<Scan> scans;
        for (std::size_t n = robots.empty() ? 0 : robots[0].last_seq; n < end; ++n) {
            Scan scan = lap().scans[n];
            scan.seq = n + 1;
            scan.stamp = stamp_of(n);
            scan.pose.reset();
            (poses == Poses::kMap ? scan.pose : scan.odometry) = lap().odometry[n];
            scans.push_back(std::move(scan));
        }
        send(std::move(scans), poses, name);
    }

    /// Sends scans of the robot, and waits until none of them is moving.
    void send(std::vector<Scan> scans, Poses poses, const std::string& name) {
        const auto session = registry_.find(name);
        const auto link = join_as(poses, scans.back().seq, name);
        session->submit(link, lap().laser, 0);
        session->submit(link, std::move(scans), 1);
        link->wait();
        EXPECT_EQ(get(fmt::format("/api/v1/sessions/{}/digest", name)).status, Status::ok);
    }

    static double stamp_of(std::size_t scan) { return 100.0 + static_cast<double>(scan) / 10.0; }

    boost::json::value localization() {
        return get_json("/api/v1/sessions/a").at("robots").as_array().at(0).at("localization");
    }

    std::map<std::string, std::vector<TumPose>> tum(const std::string& query = "") {
        const auto response = get("/api/v1/sessions/a/trajectory.tum" + query);
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), "text/plain; charset=utf-8");
        return read_tum(std::string(response.body.bytes()));
    }
};

TEST_F(ApiPosesTest, TumTrajectoryHasEstimatedPoseOfEachScan) {
    drive_lap();
    const auto robots = tum();
    ASSERT_EQ(robots.size(), 1U);
    const auto& poses = robots.at("r1");
    ASSERT_EQ(poses.size(), lap().scans.size());
    for (std::size_t n = 0; n < poses.size(); ++n) EXPECT_NEAR(poses[n].stamp, stamp_of(n), 1e-6);
    EXPECT_LT(slam::largest_error(lap(), [&](std::size_t n) { return poses[n].pose; }), 0.3);
}

TEST_F(ApiPosesTest, OnlineTrajectoryHasPosesAsFirstEstimated) {
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

TEST_F(ApiPosesTest, TumTrajectoryLeavesOutExcludedScans) {
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

TEST_F(ApiPosesTest, TumTrajectoryOfRobotThatSendsPosesHasThese) {
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

TEST_F(ApiPosesTest, TrajectoryOfUnknownRobotOrEstimateIsRefused) {
    stream("a", 1);
    const std::string tum = "/api/v1/sessions/a/trajectory.tum";
    EXPECT_THAT(detail(get(tum + "?robot=r7"), Status::not_found), HasSubstr("r7"));
    EXPECT_THAT(detail(get(tum + "?as=first"), Status::bad_request), HasSubstr("online is possible"));
}

TEST_F(ApiPosesTest, KittiTrajectoryHasThePosesOfTheTumTrajectory) {
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

TEST_F(ApiPosesTest, G2oHasTheKeyframesAndUsedEdgesOfThePoseGraph) {
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

TEST_F(ApiPosesTest, PoseGraphHasKeyframesAndTheirEdges) {
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

TEST_F(ApiPosesTest, OperatorSaysWhereARobotIs) {
    const std::string path = "/api/v1/sessions/a/relocalize";
    stream("a", "r1", {scan(1)});
    EXPECT_THAT(detail(ask("POST", path, R"({"robot": "r1", "near": [1, 2]})"), Status::conflict),
                HasSubstr("robot 'r1' sends its poses (--poses map)"));
    EXPECT_THAT(detail(ask("POST", path, R"({"robot": "r7", "near": [1, 2]})"), Status::not_found), HasSubstr("r7"));
    EXPECT_THAT(detail(ask("POST", path, R"({"robot": "r1"})"), Status::bad_request), HasSubstr("near is missing"));
    EXPECT_THAT(detail(ask("POST", path, R"({"robot": "r1", "near": [1, 2], "radius": 0})"), Status::bad_request),
                HasSubstr("radius is 0; give metres, above 0"));
    EXPECT_THAT(detail(ask("POST", path, R"({"robot": "r1", "near": [1, 2], "yaw": 0})"), Status::bad_request),
                HasSubstr("yaw"));
}

TEST_F(ApiPosesTest, RobotIsSearchedForWhereAnOperatorSays) {
    drive_lap(40);
    const auto before = get_json("/api/v1/sessions/a").at("revision").to_number<std::uint64_t>();
    const auto response = ask("POST", "/api/v1/sessions/a/relocalize", R"({"robot": "r1", "near": [3.5, -2]})");
    EXPECT_EQ(response.status, Status::accepted);
    EXPECT_EQ(boost::json::parse(response.body.bytes()),
              boost::json::parse(R"({"robot": "r1", "near": [3.5, -2], "radius": 10})"));
    drive_lap(41); // its scan is appended after the entry
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("revision"), before + 2) << "it is an entry of the log";
}

TEST_F(ApiPosesTest, MapsOfEarlierMomentsHaveThePosesOfThenOrOfNow) {
    drive_lap(lap().scans.size() * 4 / 5); // before the loop closes
    const std::string path = "/api/v1/sessions/a/";
    const auto then = get_json(path + "digest");
    const auto revision = then.at("revision").to_number<Revision>();
    drive_lap();
    const auto layers_of = [&](const std::string& query) {
        return get_json(fmt::format("{}digest?until={}", path, query)).at("layers");
    };
    EXPECT_EQ(layers_of(fmt::to_string(revision)), then.at("layers"));
    EXPECT_EQ(layers_of(fmt::format("{}&poses=then", revision)), then.at("layers"));
    EXPECT_EQ(layers_of(fmt::format("{}s", stamp_of(lap().scans.size() * 4 / 5 - 1))), then.at("layers"));
    const auto now = layers_of(fmt::format("{}&poses=now", revision));
    EXPECT_NE(now, then.at("layers"));
    const auto job = ask("POST", path + "weave", fmt::format(R"({{"until": {}, "poses": "now"}})", revision));
    EXPECT_EQ(boost::json::parse(job.body.bytes()).at("poses"), "now");
    const auto newest = ask("POST", path + "weave", R"({"cell_size": 0.1})");
    EXPECT_EQ(boost::json::parse(newest.body.bytes()).at("poses"), "now") << "it has no end";
    EXPECT_THAT(detail(get(path + "digest?until=9&poses=old"), Status::bad_request), HasSubstr("then and now"));
    EXPECT_THAT(detail(ask("POST", path + "weave", R"({"poses": 1})"), Status::bad_request), HasSubstr("poses"));
}

TEST_F(ApiPosesTest, OperatorHasThePosesOfARecordingEstimated) {
    drive_lap();
    create("b");
    drive_lap(lap().scans.size(), Poses::kMap, "b");
    const std::string path = "/api/v1/sessions/b/";
    const auto of = [&](const std::string& session) { return get_json("/api/v1/sessions/" + session + "/digest"); };
    const auto exclusion = R"({"robot": "r1", "from": "seq:1", "to": "seq:5"})";
    for (const char* session : {"a", "b"}) {
        ASSERT_EQ(ask("POST", fmt::format("/api/v1/sessions/{}/exclude", session), exclusion).status, Status::created);
    }
    ASSERT_NE(of("b").at("layers"), of("a").at("layers"));
    registry_.load("b").value();
    join_as(Poses::kMap, 1, "b");
    EXPECT_THAT(detail(ask("POST", path + "estimate", "{}"), Status::conflict), HasSubstr("robot 'r1' is connected"));
    std::promise<void> left;
    registry_.find("b")->leave(links_.back());
    registry_.find("b")->read_poses([&](const auto&) { left.set_value(); });
    left.get_future().wait();

    const auto response = ask("POST", path + "estimate", R"({"poses": "odometry"})");
    ASSERT_EQ(response.status, Status::accepted) << response.body.bytes();
    EXPECT_EQ(of("b").at("layers"), of("a").at("layers"));
    EXPECT_EQ(get(path + "trajectory.tum").body.bytes(), get("/api/v1/sessions/a/trajectory.tum").body.bytes());
    EXPECT_EQ(get(path + "log").body.bytes().size(), get("/api/v1/sessions/a/log").body.bytes().size());
    const auto revision = get_json("/api/v1/sessions/b").at("revision");
    EXPECT_EQ(ask("POST", path + "estimate", "{}").status, Status::accepted) << "again";
    EXPECT_EQ(of("b").at("layers"), of("a").at("layers"));
    EXPECT_EQ(get_json("/api/v1/sessions/b").at("revision"), revision);
    EXPECT_THAT(detail(ask("POST", path + "estimate", R"({"poses": "map"})"), Status::bad_request),
                HasSubstr(R"(poses is "map"; it can only be "odometry")"));
    EXPECT_EQ(ask("POST", "/api/v1/sessions/c/estimate", "{}").status, Status::not_found);
}

TEST_F(ApiPosesTest, OperatorTurnsLocalizeOnlyModeOn) {
    drive_lap(40);
    const auto session = [&] { return get_json("/api/v1/sessions/a"); };
    EXPECT_EQ(session().at("localize_only"), false);
    const auto response = ask("POST", "/api/v1/sessions/a/mode", R"({"localize_only": true})");
    EXPECT_EQ(response.status, Status::accepted);
    EXPECT_EQ(boost::json::parse(response.body.bytes()), boost::json::parse(R"({"localize_only": true})"));
    drive_lap(41); // its scan is appended after the entry
    EXPECT_EQ(session().at("localize_only"), true);
    for (const auto& [body, said] : {std::pair(R"({})", "localize_only is missing"),
                                     std::pair(R"({"localize_only": 1})", "localize_only is neither true nor false"),
                                     std::pair(R"({"localize_only": true, "a": 1})", "a")}) {
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions/a/mode", body), Status::bad_request), HasSubstr(said));
    }
}

TEST_F(ApiPosesTest, SessionBeginsInLocalizeOnlyMode) {
    const auto made = ask("POST", "/api/v1/sessions", R"({"name": "fixed", "localize_only": true})");
    EXPECT_EQ(made.status, Status::created);
    EXPECT_EQ(get_json("/api/v1/sessions/fixed").at("localize_only"), true);
    EXPECT_EQ(get_json("/api/v1/sessions/fixed").at("revision"), 1) << "it is an entry of the log";
    stream("fixed", "r1", {scan(1)});
    EXPECT_EQ(get_json("/api/v1/sessions/fixed").at("bounds"), nullptr);
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", R"({"name": "b", "localize_only": 1})"), Status::bad_request),
                HasSubstr("localize_only is neither true nor false"));
}

TEST_F(ApiPosesTest, SessionShowsWhetherPosesAreGiven) {
    stream("a", 1);
    EXPECT_EQ(localization().at("poses"), "map");
    EXPECT_EQ(localization().at("state"), "given");
}

TEST_F(ApiPosesTest, SessionShowsRobotWithoutScansAsUnlocated) {
    join_as(Poses::kNone, 1);
    EXPECT_EQ(localization().at("poses"), "none");
    EXPECT_EQ(localization().at("state"), "unlocated");
}

TEST_F(ApiPosesTest, ALostRobotHoldsNoGoal) {
    const std::string path = "/api/v1/sessions/a/goal";
    const std::string request = R"({"robot": "r1", "body_radius": 0.1})";
    drive_lap(60);
    ASSERT_EQ(ask("POST", path, request).status, Status::ok);
    EXPECT_EQ(get_json(path + "?robot=r1").at("goal").is_null(), false);
    carry_away();
    EXPECT_EQ(localization().at("state"), "lost");
    EXPECT_THAT(detail(ask("POST", path, request), Status::conflict), HasSubstr("'r1' is not known: it is lost"));
    EXPECT_TRUE(get_json(path + "?robot=r1").at("goal").is_null());
    EXPECT_THAT(
        detail(ask("POST", "/api/v1/sessions/a/plan", R"({"from": {"robot": "r1"}, "to": [1, 0]})"), Status::conflict),
        HasSubstr("it is lost"));
    EXPECT_THAT(std::string(get("/metrics").body.bytes()), HasSubstr("\nscanloom_robots_lost 1\n"));
}

TEST_F(ApiPosesTest, MapsAndTrajectoriesFollowCorrectedPoses) {
    drive_lap();
    const auto session = get_json("/api/v1/sessions/a");
    EXPECT_EQ(session.at("moving_scans"), 0);
    const auto& known = session.at("robots").as_array().at(0).at("localization");
    EXPECT_EQ(known.at("poses"), "odometry");
    EXPECT_EQ(known.at("state"), "tracking");
    EXPECT_GT(known.at("inliers").to_number<double>(), 0.7);
    EXPECT_GT(known.at("sigma_m").to_number<double>(), 0.0);
    EXPECT_GT(known.at("sigma_rad").to_number<double>(), 0.0);
    EXPECT_GT(known.at("loops").to_number<int>(), 0);
    EXPECT_EQ(known.at("unplaced"), 0);

    const auto maps = registry_.find("a")->snapshot();
    EXPECT_EQ(maps->robots.at(0).newest_scan->scan.pose, maps->robots.at(0).pose);
    const auto path = get_json("/api/v1/sessions/a/trajectory.geojson");
    EXPECT_EQ(path.at("poses_corrected").to_number<Revision>(), maps->scan_poses.corrected());
    const auto metrics = std::string(get("/metrics").body.bytes());
    EXPECT_THAT(metrics, testing::ContainsRegex("\nscanloom_loops_accepted_total [1-9]"));
    EXPECT_THAT(metrics, testing::ContainsRegex("\nscanloom_loop_matches_total [1-9]"));
    EXPECT_THAT(metrics, testing::ContainsRegex("\nscanloom_loops_refused_total.reason=\"stretch\". [1-9]"));
    EXPECT_THAT(metrics, testing::ContainsRegex("\nscanloom_loop_jump_metres_count [1-9]"));
    EXPECT_THAT(metrics, testing::ContainsRegex("\nscanloom_maps_corrected_total [1-9]"));
    EXPECT_THAT(metrics, HasSubstr("\nscanloom_moving_scans 0\n"));
    EXPECT_THAT(metrics, HasSubstr("\nscanloom_robots_lost 0\n"));
    EXPECT_THAT(metrics, HasSubstr("\nscanloom_scans_unplaced_total 0\n"));
}

} // namespace
} // namespace scanloom::http
