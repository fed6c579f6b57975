#pragma once

#include "tests/unit/server/http/api_fixture.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace scanloom::http {

/// A session 'a' with a scan of r1 at (0.5, 1.25): a wall around the robot at 3 m, with a sector without readings.
/// Frontiers are in that sector and behind the wall.
class ApiPlanningTest : public ApiTest {
protected:
    ApiPlanningTest() {
        create("a");
        stream("a", "r1", {scan_with_a_gap()});
    }

    static Scan scan_with_a_gap(double x = kX) {
        Scan taken = scan(1);
        taken.pose->x = x;
        taken.ranges.assign(181, 3'000);
        std::fill(taken.ranges.begin() + 100, taken.ranges.begin() + 130, kInvalidRange);
        return taken;
    }

    [[nodiscard]] std::shared_ptr<const mapping::Snapshot> maps() { return registry_.find("a")->snapshot(); }
    [[nodiscard]] double cell_size() { return maps()->config.cell_size; }

    boost::json::value frontiers(const std::string& query = "") {
        return get_json("/api/v1/sessions/a/frontiers.geojson" + (query.empty() ? "" : "?" + query));
    }

    Response post(const std::string& what, const std::string& body) {
        return ask("POST", "/api/v1/sessions/a/" + what, body);
    }
    boost::json::value post_json(const std::string& what, const std::string& body) {
        const auto response = post(what, body);
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), what.starts_with("goal") ? kJson : kGeoJson);
        return boost::json::parse(response.body.bytes());
    }
    void expect_bad(const std::string& what, const std::string& body, const std::string& beginning) {
        EXPECT_THAT(detail(post(what, body), Status::bad_request), StartsWith(beginning)) << body;
    }

    static double number(const boost::json::value& value) { return value.to_number<double>(); }

    static std::vector<Point2> points_of(const boost::json::value& line) {
        std::vector<Point2> points;
        for (const auto& point : line.at("coordinates").as_array())
            points.push_back({number(point.at(0)), number(point.at(1))});
        return points;
    }

    /// Returns the area of a GeoJSON MultiPolygon.
    static double area_of_polygons(const boost::json::value& geometry) {
        EXPECT_EQ(geometry.at("type"), "MultiPolygon");
        double area = 0.0;
        for (const auto& polygon : geometry.at("coordinates").as_array()) {
            for (const auto& ring : polygon.as_array()) area += area_of(ring);
        }
        return area;
    }

    static constexpr double kX = 0.5; // where the scan was taken
    static constexpr double kY = 1.25;

private:
    /// Returns the area of a ring; negative for a hole.
    static double area_of(const boost::json::value& ring) {
        double twice = 0.0;
        const auto& corners = ring.as_array();
        for (std::size_t n = 0; n + 1 < corners.size(); ++n) {
            twice += number(corners[n].at(0)) * number(corners[n + 1].at(1)) -
                     number(corners[n + 1].at(0)) * number(corners[n].at(1));
        }
        return 0.5 * twice;
    }
};

} // namespace scanloom::http
