#pragma once

#include "common/geometry/pose2.hpp"
#include "lab/landmark_comparison.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/map_image.hpp"

#include <opencv2/core.hpp>

#include <span>

/// Shared by pictures of point clouds: north is up, and each point is large enough to be visible.
namespace scanloom::lab {

// blue, green, red
inline const cv::Scalar kFirstColour(190, 95, 0);
inline const cv::Scalar kSecondColour(0, 120, 235);
inline const cv::Scalar kPaleColour(200, 200, 200);
inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline constexpr int kMark = 6; ///< pixels, radius of a marked place

/// Returns the extent of all clouds and the point, with a margin.
[[nodiscard]] tiles::Extent extent_around(const Point2& point, std::initializer_list<std::span<const Point2>> clouds);

/// A picture, or a part of one, that shows a part of the plane.
struct Panel {
    tiles::Extent part;
    double pixels_per_metre;
    int left; ///< column of its first pixel

    /// Returns the largest panel that fits.
    [[nodiscard]] static Panel fitting(const tiles::Extent& part, int width_max, int height_max);

    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    [[nodiscard]] cv::Point at(const Point2& point) const;
};

void draw_cloud(cv::Mat& picture, const Panel& panel, std::span<const Point2> points, const cv::Scalar& colour);

/// A disc with a black rim.
void draw_disc(cv::Mat& picture, const cv::Point& at, int radius, const cv::Scalar& colour);

/// A black cross.
void draw_sensor(cv::Mat& picture, const cv::Point& at);

/// Draws a scale bar in the lower left corner, labelled with its length: a round number of metres, at most a quarter of
/// the panel's width but at least 1 m. Draw it first, so that it hides nothing.
void draw_scale(cv::Mat& picture, const Panel& panel);

/// Throws std::runtime_error when OpenCV fails.
[[nodiscard]] tiles::Bytes png_of(const cv::Mat& picture);

/// Draws two captures of one frame as a PNG, at one scale: on the left the first capture in blue, on the right the
/// second in orange, each over the other one in a pale colour. Matched landmarks are filled discs of the capture's
/// colour with a black rim, joined across both panels by dashed lines; unmatched ones are red rings. The sensor is a
/// black cross.
/// Errors: throws std::runtime_error if OpenCV fails.
[[nodiscard]] tiles::Bytes comparison_png(const SeenLandmarks& first, const SeenLandmarks& second,
                                          std::span<const landmarks::Match> matches, const Point2& sensor);

} // namespace scanloom::lab
