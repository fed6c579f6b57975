#include "server/http/lane.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

namespace scanloom::http {
namespace {

TEST(Lane, FollowsFromTheRequest) {
    const std::string session = "/api/v1/sessions/s";
    const std::vector<std::tuple<std::string, std::string, Lane>> rows = {
        {"GET", "/", Lane::kAtOnce},
        {"GET", "/livez", Lane::kAtOnce},
        {"GET", "/readyz", Lane::kAtOnce},
        {"GET", "/openapi.json", Lane::kAtOnce},
        {"POST", "/api/v1/login", Lane::kAtOnce},
        {"GET", "/no/such/path", Lane::kAtOnce},
        {"GET", "not a target", Lane::kAtOnce},
        {"GET", "/metrics", Lane::kTelling},
        // Whole maps do not hold up their parts.
        {"GET", session + "/digest", Lane::kSurvey},
        {"GET", session + "/map.png", Lane::kSurvey},
        {"GET", session + "/map.csv", Lane::kSurvey},
        {"GET", session + "/map.npy", Lane::kSurvey},
        {"GET", session + "/map.pgm?bbox=0,0,1,1", Lane::kSurvey},
        {"GET", session + "/map.png?weave=0123456789abcdef", Lane::kSurvey},
        {"GET", session + "/difference?weave=0", Lane::kSurvey},
        {"GET", session + "/difference.png?with=0", Lane::kSurvey},
        {"GET", session + "/trajectory.geojson", Lane::kPaths},
        {"GET", session + "/trajectory.geojson?since=3&times=true", Lane::kPaths},
        {"GET", session + "/landmarks.geojson", Lane::kPaths},
        {"GET", session + "/points.csv", Lane::kPaths},
        {"GET", session + "/log?format=clf", Lane::kLog},
        {"GET", session, Lane::kServing},
        {"GET", session + "/map.yaml", Lane::kServing},
        {"GET", session + "/changes?since=3", Lane::kServing},
        {"GET", session + "/goals.geojson", Lane::kServing},
        {"GET", session + "/tiles/occupancy.json", Lane::kServing},
        {"GET", session + "/tiles/occupancy/5/0/0.png", Lane::kServing},
        {"GET", session + "/tiles/occupancy/9/256/255.bin", Lane::kServing},
        {"GET", session + "/tiles/occupancy/x/0/0.png", Lane::kServing},
        {"GET", "/api/v1/sessions", Lane::kServing},
        {"GET", "/api/v1/backups", Lane::kServing},
        // Maps that have to be made first hold up no other.
        {"GET", session + "/digest?cell_size=0.1", Lane::kWeaving},
        {"GET", session + "/map.png?until=12", Lane::kWeaving},
        {"GET", session + "/map.yaml?ray_model=traversal", Lane::kWeaving},
        {"GET", session + "/map.npy?layer=himm&himm_increment=4", Lane::kWeaving},
        {"GET", session + "/map.csv?class_source=himm", Lane::kWeaving},
        {"POST", session + "/weave", Lane::kServing}, // which only begins
        {"GET", session + "/frontiers.geojson?robot=r", Lane::kPlanning},
        {"GET", session + "/goal?robot=r", Lane::kServing},
        {"POST", session + "/goal", Lane::kPlanning},
        {"POST", session + "/plan", Lane::kPlanning},
        {"POST", session + "/coverage?weave=0123456789abcdef", Lane::kPlanning},
        // What waits for the disk.
        {"POST", session + "/import", Lane::kImporting},
        {"POST", "/api/v1/sessions", Lane::kChanging},
        {"DELETE", session, Lane::kChanging},
        {"POST", "/api/v1/backups", Lane::kChanging},
    };
    for (const auto& [method, target, lane] : rows) {
        EXPECT_EQ(lane_of({.method = method, .target = target}), lane) << method << " " << target;
    }
}

} // namespace
} // namespace scanloom::http
