#include "server/http/lane.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

Lane lane(std::string method, std::string target) {
    return lane_of({.method = std::move(method), .target = std::move(target)});
}

TEST(Lane, WhatNeedsNothingIsAnsweredAtOnce) {
    for (const char* target : {"/", "/livez", "/readyz", "/openapi.json", "/no/such/path", "not a target"}) {
        EXPECT_EQ(lane("GET", target), Lane::kAtOnce) << target;
    }
}

TEST(Lane, WholeMapsDoNotHoldUpParts) {
    const std::string session = "/api/v1/sessions/s";
    for (const char* whole : {"/digest", "/map.png", "/map.csv", "/map.npy", "/map.pgm?bbox=0,0,1,1",
                              "/difference?weave=0", "/difference.png?with=0"}) {
        EXPECT_EQ(lane("GET", session + whole), Lane::kSurvey) << whole;
    }
    for (const char* path : {"/trajectory.geojson", "/trajectory.geojson?since=3&times=true"}) {
        EXPECT_EQ(lane("GET", session + path), Lane::kPaths) << path;
    }
    EXPECT_EQ(lane("GET", session + "/log?format=clf"), Lane::kLog);
    for (const char* part :
         {"", "/map.yaml", "/changes?since=3", "/goals.geojson", "/tiles/occupancy.json", "/tiles/occupancy/5/0/0.png",
          "/tiles/occupancy/9/256/255.bin", "/tiles/occupancy/x/0/0.png"}) {
        EXPECT_EQ(lane("GET", session + part), Lane::kServing) << part;
    }
}

TEST(Lane, WhatIsToBeWovenFirstHoldsUpNothing) {
    const std::string session = "/api/v1/sessions/s";
    for (const char* anew : {"/digest?cell_size=0.1", "/map.png?until=12", "/map.yaml?ray_model=traversal",
                             "/map.npy?layer=himm&himm_increment=4", "/map.csv?class_source=himm"}) {
        EXPECT_EQ(lane("GET", session + anew), Lane::kWeaving) << anew;
    }
    EXPECT_EQ(lane("POST", session + "/weave"), Lane::kServing) << "which only begins";
    EXPECT_EQ(lane("GET", session + "/map.png?weave=0123456789abcdef"), Lane::kSurvey) << "which is done or is not";
}

TEST(Lane, SearchesHoldUpNothingElse) {
    const std::string session = "/api/v1/sessions/s";
    EXPECT_EQ(lane("GET", session + "/frontiers.geojson?robot=r"), Lane::kPlanning);
    EXPECT_EQ(lane("GET", session + "/goal?robot=r"), Lane::kPlanning);
    EXPECT_EQ(lane("POST", session + "/plan"), Lane::kPlanning);
    EXPECT_EQ(lane("POST", session + "/coverage?weave=0123456789abcdef"), Lane::kPlanning);
}

TEST(Lane, WhatWaitsForTheDiskOrTheSystemHasItsOwn) {
    EXPECT_EQ(lane("POST", "/api/v1/sessions"), Lane::kChanging);
    EXPECT_EQ(lane("DELETE", "/api/v1/sessions/s"), Lane::kChanging);
    EXPECT_EQ(lane("POST", "/api/v1/backups"), Lane::kChanging);
    EXPECT_EQ(lane("GET", "/api/v1/backups"), Lane::kServing);
    EXPECT_EQ(lane("GET", "/api/v1/sessions"), Lane::kServing);
    EXPECT_EQ(lane("GET", "/metrics"), Lane::kTelling);
}

} // namespace
} // namespace scanloom::http
