#include "server/tiles/png_reader.hpp"

#include "common/ros_map/pgm.hpp"

#include <opencv2/imgproc.hpp>
#include <spng.h>

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace scanloom::tiles {
namespace {

struct FreeDecoder {
    void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
};

Error damaged_png() { return {Errc::kMalformed, "the map's image is damaged: it cannot be decoded to its end"}; }

/// Decodes all pixels. @return empty if the image is damaged
Bytes decode(spng_ctx* context, int format) {
    std::size_t size = 0;
    if (spng_decoded_image_size(context, format, &size) != 0) return {};
    Bytes pixels(size);
    const bool is_decoded = spng_decode_image(context, pixels.data(), size, format, 0) == 0;
    return is_decoded ? pixels : Bytes();
}

} // namespace

Result<GreyImage> read_png(std::span<const std::uint8_t> png) {
    const std::unique_ptr<spng_ctx, FreeDecoder> context(spng_ctx_new(0));
    if (!context) throw std::bad_alloc();
    spng_ihdr header{};
    if (spng_set_png_buffer(context.get(), png.data(), png.size()) != 0 || spng_get_ihdr(context.get(), &header) != 0) {
        return damaged_png();
    }
    if (auto fits = check_ros_image_size(header.width, header.height); !fits) return fits.error();
    const bool is_grey = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE && header.bit_depth <= 8;
    GreyImage image{header.width, header.height, decode(context.get(), is_grey ? SPNG_FMT_G8 : SPNG_FMT_RGB8)};
    if (image.pixels.empty()) return damaged_png();
    if (is_grey) return image;
    const cv::Size size(static_cast<int>(image.width), static_cast<int>(image.height));
    Bytes grey(std::size_t{image.width} * image.height);
    cv::Mat from(size, CV_8UC3, image.pixels.data());
    cv::Mat to(size, CV_8UC1, grey.data());
    cv::cvtColor(from, to, cv::COLOR_RGB2GRAY);
    image.pixels = std::move(grey);
    return image;
}

} // namespace scanloom::tiles
