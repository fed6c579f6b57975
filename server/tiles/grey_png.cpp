#include "server/tiles/grey_png.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <stdexcept>

namespace scanloom::tiles {
namespace {

constexpr int kCompression = 3; // beyond it files hardly shrink, and time grows fast

std::array<std::uint8_t, 256> make_greys() {
    std::array<std::uint8_t, 256> greys{};
    for (std::size_t percent = 0; percent < greys.size(); ++percent) {
        greys[percent] = grey_of(static_cast<Percent>(percent));
    }
    return greys;
}

} // namespace

Bytes grey_png(std::span<const Percent> pixels, std::int32_t width, std::int32_t height) {
    assert(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    static const auto greys = make_greys();
    cv::Mat image(height, width, CV_8UC1);
    std::transform(pixels.begin(), pixels.end(), image.begin<std::uint8_t>(),
                   [&](Percent percent) { return greys[percent]; });
    Bytes png;
    if (!cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, kCompression})) {
        throw std::runtime_error("OpenCV could not encode a PNG");
    }
    return png;
}

} // namespace scanloom::tiles
