#pragma once

#include "common/geometry/pose2.hpp"
#include "server/tiles/bytes.hpp"
#include "server/tiles/extent.hpp"

#include <opencv2/core.hpp>

#include <span>

/// What pictures of clouds have in common: north is up, and each point has the size that shows it.
namespace scanloom::lab {

// blue, green, red
inline const cv::Scalar kFirstColour(190, 95, 0);
inline const cv::Scalar kSecondColour(0, 120, 235);
inline const cv::Scalar kPaleColour(200, 200, 200);
inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kWhite(255, 255, 255);
inline constexpr int kMark = 6; ///< pixels, radius of a place that is marked

/// What a picture of some clouds and of one more point shows: all of them, and a little around.
[[nodiscard]] tiles::Extent extent_around(const Point2& point, std::initializer_list<std::span<const Point2>> clouds);

/// A picture, or a part of it, that shows a part of the plane.
struct Panel {
    tiles::Extent part;
    double pixels_per_metre;
    int left; ///< column of its first pixel

    /// As large as fits.
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

/// A bar in the lower left corner, as long as it says: a round number of metres, at most a quarter of the panel's
/// width, but 1 m at least. To be drawn first, so that it hides nothing.
void draw_scale(cv::Mat& picture, const Panel& panel);

/// Throws std::runtime_error when OpenCV fails.
[[nodiscard]] tiles::Bytes png_of(const cv::Mat& picture);

} // namespace scanloom::lab
