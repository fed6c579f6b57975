#include "lab/cloud_panel.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace scanloom::lab {
namespace {

constexpr double kMargin = 0.3; // metres around what is seen

} // namespace

tiles::Extent extent_around(const Point2& point, std::initializer_list<std::span<const Point2>> clouds) {
    tiles::Extent extent{point.x(), point.y(), point.x(), point.y()};
    for (const auto cloud : clouds) {
        for (const Point2& other : cloud) {
            extent.min_x = std::min(extent.min_x, other.x());
            extent.min_y = std::min(extent.min_y, other.y());
            extent.max_x = std::max(extent.max_x, other.x());
            extent.max_y = std::max(extent.max_y, other.y());
        }
    }
    return {extent.min_x - kMargin, extent.min_y - kMargin, extent.max_x + kMargin, extent.max_y + kMargin};
}

Panel Panel::fitting(const tiles::Extent& part, int width_max, int height_max) {
    return {part, std::min(width_max / (part.max_x - part.min_x), height_max / (part.max_y - part.min_y)), 0};
}

int Panel::width() const { return static_cast<int>(std::ceil((part.max_x - part.min_x) * pixels_per_metre)); }
int Panel::height() const { return static_cast<int>(std::ceil((part.max_y - part.min_y) * pixels_per_metre)); }

cv::Point Panel::at(const Point2& point) const {
    return {left + static_cast<int>(std::floor((point.x() - part.min_x) * pixels_per_metre)),
            static_cast<int>(std::floor((part.max_y - point.y()) * pixels_per_metre))};
}

void draw_cloud(cv::Mat& picture, const Panel& panel, std::span<const Point2> points, const cv::Scalar& colour) {
    for (const Point2& point : points) {
        const cv::Point at = panel.at(point);
        cv::rectangle(picture, at, at + cv::Point(1, 1), colour, cv::FILLED);
    }
}

void draw_disc(cv::Mat& picture, const cv::Point& at, int radius, const cv::Scalar& colour) {
    cv::circle(picture, at, radius, colour, cv::FILLED, cv::LINE_AA);
    cv::circle(picture, at, radius, kBlack, 1, cv::LINE_AA);
}

void draw_sensor(cv::Mat& picture, const cv::Point& at) {
    cv::drawMarker(picture, at, kBlack, cv::MARKER_CROSS, 4 * kMark, 3);
}

tiles::Bytes png_of(const cv::Mat& picture) {
    tiles::Bytes png;
    if (!cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        throw std::runtime_error("OpenCV could not encode a PNG");
    }
    return png;
}

} // namespace scanloom::lab
