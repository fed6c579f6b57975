#include "lab/landmark_picture.hpp"

#include "lab/cloud_panel.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace scanloom::lab {
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
