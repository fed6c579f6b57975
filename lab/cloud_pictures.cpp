#include "lab/cloud_pictures.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace scanloom::lab {
namespace {

constexpr double kMargin = 0.3; // metres around the content

} // namespace

tiles::Extent extent_around(const Point2& point, std::initializer_list<std::span<const Point2>> clouds) {
    tiles::Extent extent{point.x, point.y, point.x, point.y};
    for (const auto cloud : clouds) {
        for (const Point2& other : cloud) {
            extent.min_x = std::min(extent.min_x, other.x);
            extent.min_y = std::min(extent.min_y, other.y);
            extent.max_x = std::max(extent.max_x, other.x);
            extent.max_y = std::max(extent.max_y, other.y);
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
    return {left + static_cast<int>(std::floor((point.x - part.min_x) * pixels_per_metre)),
            static_cast<int>(std::floor((part.max_y - point.y) * pixels_per_metre))};
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

void draw_scale(cv::Mat& picture, const Panel& panel) {
    constexpr int kInset = 10;
    constexpr int kThick = 3;
    constexpr auto kFont = cv::FONT_HERSHEY_SIMPLEX;
    constexpr double kFontScale = 0.5;
    double metres = 1.0;
    for (const double longer : {2.0, 5.0, 10.0, 20.0, 50.0}) {
        if (longer * panel.pixels_per_metre <= panel.width() / 4.0) metres = longer;
    }
    const std::string text = fmt::format("{:g} m", metres);
    int below = 0;
    cv::getTextSize(text, kFont, kFontScale, 1, &below);
    const int length = static_cast<int>(std::lround(metres * panel.pixels_per_metre));
    const cv::Point begin(panel.left + kInset, panel.height() - kInset);
    const cv::Point above(begin.x, begin.y - kThick - below);
    cv::line(picture, begin, begin + cv::Point(length, 0), kBlack, kThick);
    cv::putText(picture, text, above, kFont, kFontScale, kBlack, 1, cv::LINE_AA);
}

tiles::Bytes png_of(const cv::Mat& picture) {
    tiles::Bytes png;
    if (!cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        throw std::runtime_error("OpenCV could not encode a PNG");
    }
    return png;
}

namespace {

// blue, green, red
const cv::Scalar kMatchColour(90, 90, 90);
const cv::Scalar kUnmatchedColour(40, 30, 210);
constexpr int kPanelWidth = 600; // pixels
constexpr int kPanelHeightMax = 900;
constexpr int kPanelGap = 12;
constexpr double kDash = 7.0; // pixels, length of a dash and of a gap

void draw_dashed(cv::Mat& picture, const cv::Point& from, const cv::Point& to) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const auto at = [&](double along) {
        const double share = std::min(along / length, 1.0);
        return cv::Point(static_cast<int>(std::lround(from.x + share * (to.x - from.x))),
                         static_cast<int>(std::lround(from.y + share * (to.y - from.y))));
    };
    for (double along = 0.0; along < length; along += 2.0 * kDash) {
        cv::line(picture, at(along), at(along + kDash), kMatchColour, 1, cv::LINE_AA);
    }
}

void draw_landmarks(cv::Mat& picture, const Panel& panel, const SeenLandmarks& seen, const std::vector<bool>& matched,
                    const cv::Scalar& colour) {
    for (std::size_t n = 0; n < matched.size(); ++n) {
        const cv::Point at = panel.at(seen.survey.landmarks[n].position);
        if (matched[n]) {
            draw_disc(picture, at, kMark, colour);
        } else {
            cv::circle(picture, at, kMark + 1, kUnmatchedColour, 3, cv::LINE_AA);
        }
    }
}

} // namespace

tiles::Bytes comparison_png(const SeenLandmarks& first, const SeenLandmarks& second,
                            std::span<const landmarks::Match> matches, const Point2& sensor) {
    const Panel left =
        Panel::fitting(extent_around(sensor, {first.points, second.points}), kPanelWidth, kPanelHeightMax);
    const int width = left.width();
    Panel right = left;
    right.left = width + kPanelGap;
    cv::Mat picture(left.height(), 2 * width + kPanelGap, CV_8UC3, kWhite);
    picture.colRange(width, width + kPanelGap).setTo(kPaleColour);
    for (const Panel& panel : {left, right}) draw_scale(picture, panel);
    draw_cloud(picture, left, second.points, kPaleColour);
    draw_cloud(picture, right, first.points, kPaleColour);

    std::vector<bool> matched_first(first.survey.landmarks.size(), false);
    std::vector<bool> matched_second(second.survey.landmarks.size(), false);
    for (const auto& match : matches) {
        matched_first[match.first] = matched_second[match.second] = true;
        draw_dashed(picture, left.at(first.survey.landmarks[match.first].position),
                    right.at(second.survey.landmarks[match.second].position));
    }
    draw_cloud(picture, left, first.points, kFirstColour);
    draw_cloud(picture, right, second.points, kSecondColour);
    draw_landmarks(picture, left, first, matched_first, kFirstColour);
    draw_landmarks(picture, right, second, matched_second, kSecondColour);
    for (const Panel& panel : {left, right}) draw_sensor(picture, panel.at(sensor));
    return png_of(picture);
}

} // namespace scanloom::lab
