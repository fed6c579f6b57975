#include "lab/landmark_picture.hpp"

#include "server/tiles/extent.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace scanloom::lab {
namespace {

// blue, green, red
const cv::Scalar kFirstColour(190, 95, 0);
const cv::Scalar kSecondColour(0, 120, 235);
const cv::Scalar kPaleColour(200, 200, 200);
const cv::Scalar kMatchColour(90, 90, 90);
const cv::Scalar kUnmatchedColour(40, 30, 210);
const cv::Scalar kBlack(0, 0, 0);
constexpr int kPanelWidth = 600; // pixels
constexpr int kPanelHeightMax = 900;
constexpr int kGap = 12;
constexpr int kMark = 6;        // radius of a landmark
constexpr double kDash = 7.0;   // pixels, of a dash and of what is between two
constexpr double kMargin = 0.3; // metres around what is seen

tiles::Extent extent_of(const SeenLandmarks& first, const SeenLandmarks& second, const Point2& sensor) {
    tiles::Extent extent{sensor.x(), sensor.y(), sensor.x(), sensor.y()};
    for (const auto* seen : {&first, &second}) {
        for (const Point2& point : seen->points) {
            extent.min_x = std::min(extent.min_x, point.x());
            extent.min_y = std::min(extent.min_y, point.y());
            extent.max_x = std::max(extent.max_x, point.x());
            extent.max_y = std::max(extent.max_y, point.y());
        }
    }
    return {extent.min_x - kMargin, extent.min_y - kMargin, extent.max_x + kMargin, extent.max_y + kMargin};
}

/// One half of the picture.
struct Panel {
    tiles::Extent part;
    double pixels_per_metre;
    int left; ///< column of its first pixel

    [[nodiscard]] cv::Point at(const Point2& point) const {
        return {left + static_cast<int>(std::floor((point.x() - part.min_x) * pixels_per_metre)),
                static_cast<int>(std::floor((part.max_y - point.y()) * pixels_per_metre))};
    }
};

void draw_cloud(cv::Mat& picture, const Panel& panel, std::span<const Point2> points, const cv::Scalar& colour) {
    for (const Point2& point : points) {
        const cv::Point at = panel.at(point);
        cv::rectangle(picture, at, at + cv::Point(1, 1), colour, cv::FILLED);
    }
}

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
            cv::circle(picture, at, kMark, colour, cv::FILLED, cv::LINE_AA);
            cv::circle(picture, at, kMark, kBlack, 1, cv::LINE_AA);
        } else {
            cv::circle(picture, at, kMark + 1, kUnmatchedColour, 3, cv::LINE_AA);
        }
    }
}

} // namespace

tiles::Bytes comparison_png(const SeenLandmarks& first, const SeenLandmarks& second,
                            std::span<const landmarks::Match> matches, const Point2& sensor) {
    const tiles::Extent part = extent_of(first, second, sensor);
    const double scale = std::min(kPanelWidth / (part.max_x - part.min_x), kPanelHeightMax / (part.max_y - part.min_y));
    const int width = static_cast<int>(std::ceil((part.max_x - part.min_x) * scale));
    const int height = static_cast<int>(std::ceil((part.max_y - part.min_y) * scale));
    const Panel left{part, scale, 0};
    const Panel right{part, scale, width + kGap};
    cv::Mat picture(height, 2 * width + kGap, CV_8UC3, cv::Scalar(255, 255, 255));
    picture.colRange(width, width + kGap).setTo(kPaleColour);
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
    for (const Panel& panel : {left, right}) {
        cv::drawMarker(picture, panel.at(sensor), kBlack, cv::MARKER_CROSS, 4 * kMark, 3);
    }
    tiles::Bytes png;
    if (!cv::imencode(".png", picture, png, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        throw std::runtime_error("OpenCV could not encode a PNG");
    }
    return png;
}

} // namespace scanloom::lab
