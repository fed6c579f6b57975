#include "tests/support/room_scans.hpp"
#include "tests/unit/server/http/api_fixture.hpp"

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

namespace scanloom::http {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

/// Two robots that drive around in a room with furniture, one after the other.
class ApiPointsTest : public ApiTest {
protected:
    void SetUp() override {
        create("a");
        for (const char* robot : {"r1", "r2"}) {
            const auto session = registry_.find("a");
            const auto round = testing_support::room_scans(60);
            const auto link = join("a", robot, round.size());
            session->submit(link, testing_support::reference_laser(), 0);
            session->submit(link, round, 1);
            link->wait();
        }
    }

    std::vector<std::vector<std::string>> lines(const std::string& query = "") {
        const auto response = get("/api/v1/sessions/a/points.csv" + (query.empty() ? "" : "?" + query));
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), "text/csv");
        std::vector<std::vector<std::string>> split_lines;
        std::vector<std::string> all;
        const std::string text(response.body.bytes());
        boost::split(all, text, boost::is_any_of("\n"));
        all.pop_back();
        for (const auto& line : all) boost::split(split_lines.emplace_back(), line, boost::is_any_of(","));
        EXPECT_THAT(split_lines.front(), ElementsAre("angle", "distance", "x", "y", "seen", "robot", "revision"));
        split_lines.erase(split_lines.begin());
        return split_lines;
    }

    std::size_t seen_in_all(const std::vector<std::vector<std::string>>& points) {
        std::size_t seen = 0;
        for (const auto& point : points) seen += std::stoul(point[4]);
        return seen;
    }
};

class ApiPointsTrials : public ApiPointsTest {};

TEST_F(ApiPointsTest, CloudContainsAllObservedPoints) {
    const auto apart = lines("threshold=0");
    const auto fused = lines();
    EXPECT_LT(fused.size(), apart.size());
    EXPECT_EQ(seen_in_all(fused), seen_in_all(apart));
    EXPECT_GT(fused.size(), 1000U);
    for (const auto& point : fused) {
        ASSERT_THAT(point, SizeIs(7));
        EXPECT_LE(std::abs(std::stod(point[2])), 5.01) << "in the room";
        EXPECT_LE(std::abs(std::stod(point[3])), 5.01);
        EXPECT_LE(std::stod(point[1]), 5.01) << "within the range of the laser";
    }
}

TEST_F(ApiPointsTest, RobotAndRevisionsFilterPoints) {
    const auto all = seen_in_all(lines());
    EXPECT_EQ(seen_in_all(lines("robot=r1")) + seen_in_all(lines("robot=r2")), all);
    for (const auto& point : lines("robot=r2")) EXPECT_EQ(point[5], "r2");
    EXPECT_EQ(seen_in_all(lines("until=80")) + seen_in_all(lines("since=80")), all);
    for (const auto& point : lines("since=30&until=50")) {
        EXPECT_GT(std::stoi(point[6]), 30);
        EXPECT_LE(std::stoi(point[6]), 50);
    }
    EXPECT_THAT(lines("until=0"), SizeIs(0));
}

/// Also if a capture of a stationary robot has many scans while a capture of another robot begins and ends.
TEST_F(ApiPointsTrials, ConsecutivePartsContainEachCaptureOnce) {
    create("stand");
    const auto session = registry_.find("stand");
    auto standing = testing_support::room_scans(44); // the log ends in the middle of the last capture
    for (std::size_t n = 0; n < standing.size(); ++n) {
        if (n % 20 != 0) standing[n] = standing[n - 1];
        standing[n].seq = n + 1;
        standing[n].stamp = static_cast<double>(n);
    }
    for (const char* robot : {"r1", "r2"}) {
        const auto link = join("stand", robot, standing.size());
        session->submit(link, testing_support::reference_laser(), 0);
        session->submit(link, standing, 1);
        link->wait();
    }
    const auto seen = [&](const std::string& query) {
        const std::string text(get("/api/v1/sessions/stand/points.csv" + query).body.bytes());
        std::vector<std::string> all;
        boost::split(all, text, boost::is_any_of("\n"));
        std::size_t sum = 0;
        for (std::size_t n = 1; n + 1 < all.size(); ++n) {
            std::vector<std::string> fields;
            boost::split(fields, all[n], boost::is_any_of(","));
            sum += std::stoul(fields[4]);
        }
        return sum;
    };
    const auto whole = seen("");
    EXPECT_GT(whole, 20'000U);
    const auto newest = session->snapshot()->revision;
    for (Revision at = 0; at <= newest; ++at) {
        const auto revision = std::to_string(at);
        EXPECT_EQ(seen("?until=" + revision) + seen("?since=" + revision), whole) << at;
    }
    EXPECT_EQ(seen("?since=1000"), 0U);
    // Repeated requests for new points also return each capture once: the current capture ends later.
    const auto ended = seen("?until=" + std::to_string(newest));
    EXPECT_LT(ended, whole);
    const auto link = join("stand", "r3", 1);
    session->submit(link, testing_support::reference_laser(), 0);
    session->submit(link, {testing_support::room_scans(1)}, 1);
    link->wait();
    EXPECT_EQ(ended + seen("?since=" + std::to_string(newest)), seen(""));
}

TEST_F(ApiPointsTest, PcdHasThePointsOfThePly) {
    const auto points_of = [&](const std::string& file, std::string_view end_of_header) {
        const std::string text(get("/api/v1/sessions/a/points." + file).body.bytes());
        return text.substr(text.find(end_of_header) + end_of_header.size());
    };
    EXPECT_EQ(points_of("pcd", "DATA ascii\n"), points_of("ply", "end_header\n"));
}

TEST_F(ApiPointsTest, PlyHasThePointsOfTheCsv) {
    const auto response = get("/api/v1/sessions/a/points.ply");
    EXPECT_EQ(response.get("Content-Type"), "model/ply");
    EXPECT_THAT(std::string(response.body.bytes()), StartsWith("ply\nformat ascii 1.0\n"));
    EXPECT_THAT(std::string(response.body.bytes()), HasSubstr(fmt::format("element vertex {}\n", lines().size())));
}

TEST_F(ApiPointsTest, SessionWithoutScansHasNone) {
    create("b");
    EXPECT_EQ(get("/api/v1/sessions/b/points.csv").body.bytes(), "angle,distance,x,y,seen,robot,revision\n");
}

TEST_F(ApiPointsTest, InvalidParametersAreNamed) {
    const std::string path = "/api/v1/sessions/a/points.csv?";
    for (const auto& [query, what] : {
             std::pair{"threshold=-1", "threshold is \"-1\"; metres from 0 to 1 are needed"},
             std::pair{"threshold=nan", "threshold is \"nan\""},
             std::pair{"threshold=2", "threshold is \"2\""},
             std::pair{"until=now", "until is \"now\"; a revision is needed"},
             std::pair{"since=-1", "since is \"-1\""},
             std::pair{"colour=red", "the parameter \"colour\" is unknown"},
         }) {
        EXPECT_THAT(detail(get(path + query), Status::bad_request), HasSubstr(what));
    }
    EXPECT_THAT(detail(get(path + "robot=r9"), Status::not_found), HasSubstr("robot is \"r9\""));
}

} // namespace
} // namespace scanloom::http
