#include "tests/unit/server/http/api_poses_fixture.hpp"

/// Estimated poses: what operators change, and what sessions show.
namespace scanloom::http {
namespace {

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
