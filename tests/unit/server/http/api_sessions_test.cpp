#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/json/array.hpp>

/// Sessions over HTTP: creation, display, list, deletion; damaged and failed sessions.
namespace scanloom::http {
namespace {

TEST_F(ApiTest, CreatedSessionHasDefaultSettings) {
    const auto response = ask("POST", "/api/v1/sessions", R"({"name":"intel","cell_size":0.1})");
    EXPECT_EQ(response.status, Status::created);
    EXPECT_EQ(response.get("Location"), "/api/v1/sessions/intel");
    const auto shown = boost::json::parse(response.body.bytes());
    EXPECT_EQ(shown, get_json("/api/v1/sessions/intel"));
    EXPECT_EQ(shown.at("name"), "intel");
    EXPECT_THAT(std::string(shown.at("id").as_string()), testing::MatchesRegex("[0-9a-f]{16}-[0-9]+[.][0-9]+"));
    EXPECT_EQ(shown.at("created"), "2026-11-21T09:00:00Z");
    EXPECT_EQ(shown.at("revision"), 0);
    EXPECT_EQ(shown.at("config").at("cell_size"), 0.1);
    EXPECT_EQ(shown.at("config").at("p_occupied"), 0.9);
    EXPECT_EQ(shown.at("config").as_object().size(), mapping::config_fields().size());
    EXPECT_TRUE(shown.at("bounds").is_null());
    EXPECT_EQ(shown.at("robots"), boost::json::array{});
}

TEST_F(ApiTest, InvalidSessionFieldsAreNamed) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {R"({})", "name is missing"},
        {R"({"name":7})", "name is not a string"},
        {R"({"name":"a/b"})", "name"},
        {R"({"name":""})", "name"},
        {R"({"name":"a","cellsize":1})", "\"cellsize\""},
        {R"({"name":"a","cell_size":"1"})", "cell_size must be a number"},
        {R"({"name":"a","cell_size":0})", "cell_size"},
        {R"({"name":"a","cell_size":0.1,"cell_size":0.2})", "\"cell_size\" is given twice"},
        {R"({"name":"a","cell_size":-1e300})", "cell_size"},
        {R"({"name":"a","p_free":0.7})", "p_free"},
        {R"([])", "not an object"},
        {R"({"name")", "not JSON"},
    };
    for (const auto& [body, message] : cases) {
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", body), Status::bad_request), HasSubstr(message)) << body;
    }
    EXPECT_EQ(ask("POST", "/api/v1/sessions", R"({"name":"a","cell_size":1e999})").status, Status::bad_request);
    EXPECT_TRUE(registry_.list().empty());
}

TEST_F(ApiTest, SettingsOfWrongTypesAreNamedAndCreateNoSession) {
    const auto refuse = [&](const mapping::ConfigField& field, const char* value) {
        const auto body = R"({"name":"a",")" + std::string(field.name) + "\":" + value + "}";
        EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", body), Status::bad_request), testing::StartsWith(field.name))
            << body;
    };
    for (const auto& field : mapping::config_fields()) {
        const auto held = mapping::value_of(field, {});
        for (const char* value : {"null", "[]", "{}", "\"stone\"", "\"\"", "[0.5]", "\"0.5\""}) refuse(field, value);
        if (!std::holds_alternative<bool>(held)) refuse(field, "true");
        if (std::holds_alternative<std::int32_t>(held)) {
            for (const char* value : {"3.5", "1e30", "-4000000000", "0.0001"}) refuse(field, value);
        }
        if (std::holds_alternative<std::string_view>(held)) refuse(field, "1");
    }
    EXPECT_TRUE(registry_.list().empty());
    EXPECT_TRUE(get_json("/api/v1/sessions").at("sessions").as_array().empty()) << "no partial session exists";
}

TEST_F(ApiTest, AllSettingsAreReturnedAsGiven) {
    const std::string config = R"({"ray_model":"bresenham","accumulate":true,"hit_radius":0.2,"drop_no_return":true,)"
                               R"("cell_size":0.1,"p_occupied":0.8,"p_free":0.2,"p_prior":0.4,"p_min":0.01,)"
                               R"("p_max":0.99,"obstacle_thickness":0.3,"beam_aperture":0.02,"himm_increment":4,)"
                               R"("himm_decrement":2,"himm_obstacle_thickness":0.25,"himm_beam_aperture":0.03,)"
                               R"("sonar_obstacle_thickness":0.6,"sonar_beam_aperture":0.4,)"
                               R"("sonar_p_occupied_max":0.9,"sonar_p_min":0.02,"sonar_p_max":0.95,)"
                               R"("class_source":"himm","class_p_occupied":0.7,"class_p_free":0.3,)"
                               R"("class_himm_occupied":9,"class_himm_free":3,"danger_cells":5,"danger_radius":0.4,)"
                               R"("max_jump":1.5})";
    const auto wanted = boost::json::parse(config).as_object();
    ASSERT_EQ(wanted.size(), mapping::config_fields().size());
    const auto response = ask("POST", "/api/v1/sessions", R"({"name":"a",)" + config.substr(1));
    ASSERT_EQ(response.status, Status::created) << response.body.bytes();
    const auto shown = get_json("/api/v1/sessions/a").at("config").as_object();
    for (const auto& [name, value] : wanted) EXPECT_EQ(shown.at(name), value) << name;
}

TEST_F(ApiTest, OtherContentTypesAreRefused) {
    Request request{
        .method = "POST", .target = "/api/v1/sessions", .content_type = "text/plain", .body = R"({"name":"a"})"};
    EXPECT_THAT(detail(answer(api_, request), Status::unsupported_media_type), HasSubstr("application/json"));
    request.content_type = "application/json; charset=utf-8";
    EXPECT_EQ(answer(api_, request).status, Status::created);
}

TEST_F(ApiTest, FailedStoreMakesAllSessionsFailed) {
    create("lab");
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    EXPECT_THAT(detail(ask("POST", "/api/v1/sessions", R"({"name":"a"})"), Status::service_unavailable),
                HasSubstr("disk is full"));
    for (const auto& shown : {get_json("/api/v1/sessions/lab"), get_json("/api/v1/sessions").at("sessions").at(0)}) {
        EXPECT_EQ(shown.at("state"), "failed") << "although no robot has sent a scan since then";
        EXPECT_THAT(std::string(shown.at("reason").as_string()), HasSubstr("disk is full"));
    }
}

TEST_F(ApiTest, SessionsAreListedInPages) {
    for (const auto* name : {"c", "a", "b"}) create(name);
    const auto first = get_json("/api/v1/sessions?limit=2");
    ASSERT_EQ(first.at("sessions").as_array().size(), 2U);
    EXPECT_EQ(first.at("sessions").at(0).at("name"), "a");
    EXPECT_EQ(first.at("next"), "b");
    const auto last = get_json("/api/v1/sessions?limit=2&after=b");
    ASSERT_EQ(last.at("sessions").as_array().size(), 1U);
    EXPECT_EQ(last.at("sessions").at(0).at("name"), "c");
    EXPECT_TRUE(last.at("next").is_null());
    EXPECT_TRUE(get_json("/api/v1/sessions?after=zz").at("sessions").as_array().empty());
    EXPECT_TRUE(get_json("/api/v1/sessions").at("next").is_null());
}

TEST_F(ApiTest, InvalidPageParametersAreNamed) {
    for (const auto* query : {"limit=0", "limit=1001", "limit=x", "limit=", "limit=-1", "limit=18446744073709551616"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions?{}", query)), Status::bad_request),
                    StartsWith("limit is"));
    }
    EXPECT_THAT(detail(get("/api/v1/sessions?after=a%20b"), Status::bad_request), StartsWith("after is"));
    EXPECT_THAT(detail(get("/api/v1/sessions?page=2"), Status::bad_request), HasSubstr("\"page\""));
}

TEST_F(ApiTest, StreamingRobotIsListed) {
    create("a");
    stream("a", 3);
    const auto shown = get_json("/api/v1/sessions/a");
    EXPECT_EQ(shown.at("scans"), 3);
    EXPECT_EQ(shown.at("revision"), 5); // plus the entries of the robot and its sensor
    const boost::json::object given{{"poses", "map"},   {"state", "given"}, {"inliers", 0},
                                    {"sigma_m", 0},     {"sigma_rad", 0},   {"loops", 0},
                                    {"corrections", 0}, {"unplaced", 0},    {"mount_yaw_error", nullptr}};
    EXPECT_EQ(shown.at("robots"), (boost::json::array{{{"name", "r1"},
                                                       {"connected", true},
                                                       {"scans", 3},
                                                       {"jumps", 0},
                                                       {"excluded", 0},
                                                       {"last_seq", 3},
                                                       {"stamp", 103},
                                                       {"pose", {{"x", 1.5}, {"y", 1.25}, {"yaw", 0}}},
                                                       {"localization", given},
                                                       {"body_radius", nullptr}}}));
    EXPECT_NEAR(shown.at("bounds").at("max_x").to_number<double>(), 3.5, 0.2);
    EXPECT_NEAR(shown.at("bounds").at("min_y").to_number<double>(), -0.75, 0.2);
}

TEST_F(ApiTest, ScansBeyondMaxJumpAreCountedAndOnlyInTheLog) {
    ASSERT_EQ(ask("POST", "/api/v1/sessions", R"({"name":"a","max_jump":2})").status, Status::created);
    Scan stray = scan(3);
    stray.pose->x = 450.0;
    stream("a", "r", {scan(1), scan(2), stray, scan(4)});
    const auto session = get_json("/api/v1/sessions/a");
    EXPECT_EQ(session.at("scans"), 3);
    EXPECT_LT(session.at("bounds").at("max_x").to_number<double>(), 10.0);
    const auto& robot = session.at("robots").at(0);
    EXPECT_EQ(robot.at("scans"), 3);
    EXPECT_EQ(robot.at("jumps"), 1);
    EXPECT_EQ(robot.at("last_seq"), 4);
    EXPECT_THAT(std::string(get("/metrics").body.bytes()), HasSubstr("scanloom_scans_jumped_total 1\n"));
    const auto path = get_json("/api/v1/sessions/a/trajectory.geojson").at("features").at(0).at("geometry");
    EXPECT_EQ(path.at("coordinates").as_array().size(), 3U);
    const std::string digest = "/api/v1/sessions/a/digest?layer=occupancy";
    EXPECT_EQ(get(digest + "&max_jump=2").body.bytes(), get(digest).body.bytes());
    EXPECT_NE(get(digest + "&max_jump=0").body.bytes(), get(digest).body.bytes());
}

TEST_F(ApiTest, BodyRadiusOfARobotIsReturned) {
    create("a");
    join("a", "r1", 1, 0.25);
    EXPECT_EQ(get_json("/api/v1/sessions/a").at("robots").at(0).at("body_radius"), 0.25);
}

TEST_F(ApiTest, UnknownSessionIsNotFoundOnEveryRoute) {
    for (const auto* path : {"", "/tiles/occupancy/0/0/0.png", "/tiles/occupancy/0/0/0.bin", "/tiles/occupancy.json",
                             "/changes", "/map.png", "/map.pgm", "/map.yaml", "/map.csv", "/map.npy", "/digest",
                             "/difference?with=0", "/difference.png?with=0", "/trajectory.geojson"}) {
        EXPECT_THAT(detail(get(fmt::format("/api/v1/sessions/missing{}", path)), Status::not_found),
                    HasSubstr("there is no session 'missing'"));
    }
    for (const auto* name : {"missing",
                             "%23"
                             "12",
                             "%FFmis%22sing"}) {
        const auto target = fmt::format("/api/v1/sessions/{}", name);
        EXPECT_EQ(detail(ask("DELETE", target), Status::not_found), detail(get(target), Status::not_found));
    }
}

TEST_F(ApiTest, DamagedSessionIsReported) {
    ASSERT_TRUE(log_.create_session("no record of a session"));
    sessions::SessionRegistry registry(log_, {pool_.get_executor(), [] { return 0.0; }});
    ASSERT_TRUE(registry.recover());
    ASSERT_EQ(registry.damaged().size(), 1U);
    const auto name = registry.damaged().begin()->first; // "#" and its id
    TestApi api(registry, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {});
    api.set_recovered();
    const auto path = "/api/v1/sessions/%23" + name.substr(1);
    for (const auto* rest : {"", "/changes", "/map.png", "/tiles/occupancy/0/0/0.png"}) {
        const auto response = answer(api, {.target = path + rest});
        EXPECT_THAT(detail(response, Status::internal_server_error), HasSubstr("could not be recovered"));
        EXPECT_EQ(response.get("Retry-After"), "") << "a retry does not help";
    }
    EXPECT_EQ(answer(api, {.method = "DELETE", .target = path}).status, Status::no_content);
    EXPECT_EQ(answer(api, {.target = path}).status, Status::not_found);
}

TEST_F(ApiTest, DamagedSessionsAreListedAndOthersAreServed) {
    create("a");
    ASSERT_TRUE(log_.create_session("no record of a session"));
    sessions::SessionRegistry registry(log_, {pool_.get_executor(), [] { return 0.0; }});
    ASSERT_TRUE(registry.recover());
    TestApi api(registry, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {});
    api.set_recovered();
    const auto json = [&](std::string target) {
        const auto response = answer(api, {.target = std::move(target)});
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        return boost::json::parse(response.body.bytes());
    };
    const auto all = json("/api/v1/sessions");
    ASSERT_EQ(all.at("sessions").as_array().size(), 2U);
    const auto damaged = all.at("sessions").at(0);
    EXPECT_EQ(damaged.at("name"), "#2");
    EXPECT_EQ(damaged.at("state"), "damaged");
    EXPECT_FALSE(damaged.at("reason").as_string().empty());
    EXPECT_EQ(all.at("sessions").at(1).at("name"), "a");
    EXPECT_EQ(all.at("sessions").at(1).at("state"), "ok");

    const auto first = json("/api/v1/sessions?limit=1");
    EXPECT_EQ(first.at("next"), damaged.at("name"));
    const auto rest =
        json("/api/v1/sessions?after=%23" + std::string(std::string_view(damaged.at("name").as_string()).substr(1)));
    EXPECT_EQ(rest.at("sessions").at(0).at("name"), "a");
    EXPECT_EQ(json("/readyz").at("damaged"), boost::json::array{damaged});
    registry.drain();
}

TEST_F(ApiTest, FailedSessionHasAReasonAndServesItsMap) {
    create("a");
    create("b");
    stream("a", 1);
    EXPECT_EQ(get_json("/readyz").at("failed"), boost::json::array{});
    EXPECT_FALSE(get_json("/api/v1/sessions/a").as_object().contains("reason"));
    log_.fail_from_next_change({Errc::kStoreFailed, "the disk is full"});
    registry_.find("a")->submit(links_[0], {scan(2)}, 1);
    links_[0]->wait_for_failure();
    const auto shown = get_json("/api/v1/sessions/a");
    EXPECT_EQ(shown.at("state"), "failed");
    EXPECT_EQ(shown.at("reason"), "the disk is full");
    EXPECT_EQ(shown.at("scans"), 1);
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(0), shown);
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(1).at("state"), "failed") << "the store takes no scans";
    EXPECT_EQ(get("/api/v1/sessions/a/map.png").status, Status::ok);
    EXPECT_THAT(std::string(get("/metrics").body.bytes()), HasSubstr("scanloom_sessions_failed 1\n"));

    log_.reopen(); // as if the cause were not the store
    EXPECT_EQ(get_json("/api/v1/sessions").at("sessions").at(1).at("state"), "ok");
    EXPECT_EQ(get_json("/readyz").at("failed"),
              (boost::json::array{{{"name", "a"}, {"state", "failed"}, {"reason", "the disk is full"}}}));
}

TEST_F(ApiTest, CarmenLogOfASessionWithSonarsIsRefusedBeforeItBegins) {
    create("a");
    stream("a", 4);
    EXPECT_EQ(get("/api/v1/sessions/a/log?format=clf").status, Status::ok);
    Sensor ring = laser();
    ring.id = 3;
    ring.kind = SensorKind::kSonar;
    ring.aperture = 0.5;
    Scan echo = scan(5);
    echo.sensor = ring.id;
    const auto session = registry_.find("a");
    const auto link = join("a", "r1", echo.seq);
    session->submit(link, ring, 0);
    session->submit(link, {echo}, 1);
    link->wait();
    EXPECT_THAT(detail(get("/api/v1/sessions/a/log?format=clf"), Status::conflict), HasSubstr("scans of sonars"));
    const std::string mcap = log("a", "?format=mcap");
    const std::string_view magic("\x89MCAP0\r\n", 8);
    EXPECT_TRUE(mcap.starts_with(magic) && mcap.ends_with(magic));
    EXPECT_THAT(mcap, HasSubstr("/map")) << "the summary names the topics";
    EXPECT_THAT(mcap, HasSubstr("/r1/scan_3"));
    EXPECT_THAT(detail(get("/api/v1/sessions/a/log?format=bag"), Status::bad_request),
                HasSubstr("clf, mcap and protobuf"));
}

} // namespace
} // namespace scanloom::http
