#include "server/tiles/png.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cassert>
#include <stdexcept>

namespace scanloom::tiles {
namespace {

constexpr int kCompression = 3; // beyond it files hardly shrink, and time grows fast

Bytes encoded(const cv::Mat& image) {
    Bytes png;
    if (!cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, kCompression})) {
        throw std::runtime_error("OpenCV could not encode a PNG");
    }
    return png;
}

} // namespace

Bytes png_of(std::span<const Code> codes, std::int32_t width, std::int32_t height, const LayerStyle& style) {
    assert(codes.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto colour = [&](Code code) { return style.palette[code]; };
    if (style.is_grey) {
        cv::Mat image(height, width, CV_8UC1);
        std::ranges::transform(codes, image.begin<std::uint8_t>(), [&](Code code) { return colour(code).red; });
        return encoded(image);
    }
    cv::Mat image(height, width, CV_8UC3);
    std::ranges::transform(codes, image.begin<cv::Vec3b>(), [&](Code code) {
        const auto [red, green, blue] = colour(code);
        return cv::Vec3b(blue, green, red);
    });
    return encoded(image);
}

} // namespace scanloom::tiles
