#include "lab/located_picture.hpp"

#include "lab/cloud_panel.hpp"

#include <vector>

namespace scanloom::lab {
namespace {

constexpr int kSizeMax = 900; // pixels

} // namespace

tiles::Bytes located_png(const robot::MappedWorld& scene, const Pose2& T_map_found) {
    std::vector<Point2> map;
    std::vector<Point2> places;
    for (const auto& [from, points] : scene.map) {
        places.push_back(from);
        for (const PointMm& point : points) map.push_back(in_metres(point));
    }
    std::vector<Point2> view;
    for (const Point2& point : scene.seen) view.push_back(transform(T_map_found, point));
    const Point2 sensor{T_map_found.x, T_map_found.y};

    const Panel panel = Panel::fitting(extent_around(sensor, {map, places, view}), kSizeMax, kSizeMax);
    cv::Mat picture(panel.height(), panel.width(), CV_8UC3, kWhite);
    draw_scale(picture, panel);
    draw_cloud(picture, panel, map, kFirstColour);
    draw_cloud(picture, panel, view, kSecondColour);
    for (const Point2& place : places) draw_disc(picture, panel.at(place), kMark, kFirstColour);
    draw_sensor(picture, panel.at(sensor));
    return png_of(picture);
}

} // namespace scanloom::lab
