#include "server/http/routes.hpp"

#include "server/http/target.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace scanloom::http {
namespace {

template <class... Columns>
concept IsRow = requires(Columns... columns) {
    Route{columns...};
};

using Parameters = std::span<const std::string_view>;
static_assert(IsRow<Method, std::string_view, std::string_view, Access, WorkClass, Sessions, Parameters, Handler>);
static_assert(!IsRow<Method, std::string_view, std::string_view, Access, WorkClass, Sessions, Parameters>,
              "a row without a handler does not compile");
static_assert(!std::is_default_constructible_v<Handler>);

std::variant<Match, NoSuchPath, MethodNotAllowed> route(std::string_view method, std::string_view path) {
    return find_route(routes(), method, parse_target(path).value().segments);
}

/// Returns a path that the pattern matches: the value of each variable is its name.
std::string example_of(std::string_view pattern) {
    std::string path(pattern);
    std::erase_if(path, [](char c) { return c == '{' || c == '}'; });
    return path;
}

TEST(Routes, EachIsFoundByItsPath) {
    for (const auto& entry : routes()) {
        const auto found = route(name_of(entry.method), example_of(entry.path));
        const auto* match = std::get_if<Match>(&found);
        ASSERT_NE(match, nullptr) << entry.path;
        EXPECT_EQ(&match->route, &entry) << entry.path;
    }
}

TEST(Routes, ConcernASessionOnlyIfThePathNamesIt) {
    for (const auto& entry : routes()) {
        const bool names_it = entry.path.find("{session}") != std::string_view::npos;
        EXPECT_EQ(is_about_one_session(entry.access), names_it) << entry.path;
        EXPECT_TRUE(names_it || entry.sessions != Sessions::kLoaded) << entry.path;
        EXPECT_TRUE(!names_it || entry.sessions != Sessions::kUnused) << entry.path;
    }
}

TEST(Routes, HaveTheClassOfTheirWork) {
    const std::string session = "/api/v1/sessions/s";
    const std::vector<std::tuple<std::string, std::string, WorkClass>> rows = {
        {"GET", "/", WorkClass::kIo},
        {"GET", "/livez", WorkClass::kIo},
        {"GET", "/readyz", WorkClass::kIo},
        {"GET", "/openapi.json", WorkClass::kIo},
        {"POST", "/api/v1/login", WorkClass::kIo},
        {"GET", "/metrics", WorkClass::kMetrics},
        // Requests for whole maps do not delay tiles.
        {"GET", session + "/digest", WorkClass::kWholeMaps},
        {"GET", session + "/map.png", WorkClass::kWholeMaps},
        {"GET", session + "/map.csv", WorkClass::kWholeMaps},
        {"GET", session + "/map.npy", WorkClass::kWholeMaps},
        {"GET", session + "/map.pgm?bbox=0,0,1,1", WorkClass::kWholeMaps},
        {"GET", session + "/map.png?weave=0123456789abcdef", WorkClass::kWholeMaps},
        {"GET", session + "/difference?weave=0", WorkClass::kWholeMaps},
        {"GET", session + "/difference.png?with=0", WorkClass::kWholeMaps},
        {"GET", session + "/trajectory.geojson", WorkClass::kLogReading},
        {"GET", session + "/trajectory.geojson?since=3&times=true", WorkClass::kLogReading},
        {"GET", session + "/landmarks.geojson", WorkClass::kLogReading},
        {"GET", session + "/points.csv", WorkClass::kLogReading},
        {"GET", session + "/log?format=clf", WorkClass::kLogExport},
        {"GET", session, WorkClass::kQueries},
        {"GET", session + "/map.yaml", WorkClass::kQueries},
        {"GET", session + "/changes?since=3", WorkClass::kQueries},
        {"GET", session + "/goals.geojson", WorkClass::kQueries},
        {"GET", session + "/tiles/occupancy.json", WorkClass::kQueries},
        {"GET", session + "/tiles/occupancy/5/0/0.png", WorkClass::kIo},
        {"GET", session + "/tiles/occupancy/9/256/255.bin", WorkClass::kIo},
        {"GET", session + "/tiles/occupancy/x/0/0.png", WorkClass::kIo},
        {"GET", "/api/v1/sessions", WorkClass::kQueries},
        {"POST", "/api/v1/node/drain", WorkClass::kQueries},
        {"GET", "/api/v1/backups", WorkClass::kQueries},
        {"POST", session + "/weave", WorkClass::kQueries}, // which only starts a job
        {"GET", session + "/frontiers.geojson?robot=r", WorkClass::kPlanning},
        {"GET", session + "/goal?robot=r", WorkClass::kQueries},
        {"POST", session + "/goal", WorkClass::kPlanning},
        {"POST", session + "/plan", WorkClass::kPlanning},
        {"POST", session + "/coverage?weave=0123456789abcdef", WorkClass::kPlanning},
        // Operations that wait for the disk.
        {"POST", session + "/import", WorkClass::kImport},
        {"POST", "/api/v1/sessions", WorkClass::kStore},
        {"DELETE", session, WorkClass::kStore},
        {"POST", "/api/v1/backups", WorkClass::kStore},
    };
    for (const auto& [method, target, work] : rows) {
        EXPECT_EQ(std::get<Match>(route(method, target)).route.work, work) << method << " " << target;
    }
}

TEST(Routes, UnknownPathsAreNotFoundForAnyMethod) {
    for (const auto* path : {"/api", "/api/v1/sessions/", "/api/v1/sessions/a/b", "/livez/", "//livez", "/LIVEZ", "/a",
                             "/assets/", "/assets/a/b"}) {
        EXPECT_TRUE(std::holds_alternative<NoSuchPath>(route("GET", path))) << path;
        EXPECT_TRUE(std::holds_alternative<NoSuchPath>(route("PUT", path))) << path;
    }
}

TEST(Routes, WrongMethodReturnsTheAllowedOnes) {
    EXPECT_EQ(std::get<MethodNotAllowed>(route("PUT", "/api/v1/sessions")).allow, "GET, HEAD, POST");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("POST", "/api/v1/sessions/a")).allow, "GET, HEAD, DELETE");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("OPTIONS", "/livez")).allow, "GET, HEAD");
    EXPECT_EQ(std::get<MethodNotAllowed>(route("get", "/livez")).allow, "GET, HEAD");
}

} // namespace
} // namespace scanloom::http
