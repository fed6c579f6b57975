#include "common/ros_map/pgm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace scanloom {
namespace {

constexpr std::string_view kWhiteSpace = " \t\n\v\f\r"; // independent of the locale

Error malformed(std::string_view what) { return {Errc::kMalformed, fmt::format("the map's image {}", what)}; }

std::string_view text_of(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Removes a number, and the white space and comments before it, from the front of `rest`.
std::optional<std::int64_t> take_number(std::string_view& rest) {
    for (;;) {
        rest.remove_prefix(std::min(rest.find_first_not_of(kWhiteSpace), rest.size()));
        if (!rest.starts_with('#')) break;
        rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
    }
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{}) return std::nullopt;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return value;
}

/// Reads the pixels of a PGM in order, from the top left.
class Pixels {
public:
    /// Errors: those of read_ros_pgm().
    static Result<Pixels> open(std::string_view file) {
        if (!file.starts_with("P2") && !file.starts_with("P5")) return malformed("is not a PGM (P2 or P5)");
        Pixels pixels;
        pixels.is_plain_ = file[1] == '2';
        pixels.rest_ = file.substr(2);
        const auto width = take_number(pixels.rest_);
        const auto height = width ? take_number(pixels.rest_) : std::nullopt;
        const auto white = height ? take_number(pixels.rest_) : std::nullopt;
        if (!white) return malformed("is damaged: a PGM begins with its width, its height and its highest grey");
        if (auto ok = check_ros_image_size(*width, *height); !ok) return ok.error();
        if (*white < 1 || *white > 65535) {
            return malformed(fmt::format("has a highest grey (maxval) of {}; 1 to 65535 are possible", *white));
        }
        pixels.width_ = static_cast<std::size_t>(*width);
        pixels.height_ = static_cast<std::size_t>(*height);
        pixels.white_ = static_cast<std::uint16_t>(*white);
        if (auto ok = pixels.skip_to_first(); !ok) return ok.error();
        return pixels;
    }

    [[nodiscard]] std::size_t width() const noexcept { return width_; }
    [[nodiscard]] std::size_t height() const noexcept { return height_; }
    [[nodiscard]] std::uint16_t white() const noexcept { return white_; }

    /// Reads the next row, from the top. Precondition: a row is left.
    Result<> read_row(std::span<std::uint16_t> greys) {
        for (std::uint16_t& grey : greys) {
            const auto value = is_plain_ ? take_number(rest_) : take_bytes();
            if (!value) return malformed("is damaged: it ends before its last pixel");
            if (*value < 0 || *value > white_) {
                return malformed(
                    fmt::format("is damaged: it has a grey of {}, not from 0 to its highest of {}", *value, white_));
            }
            grey = static_cast<std::uint16_t>(*value);
        }
        return {};
    }

private:
    /// Errors: kMalformed if the file is shorter than its header says, detected before memory is allocated for it.
    Result<> skip_to_first() {
        if (is_plain_) { // at least a digit and a space per pixel
            if (rest_.size() < 2 * width_ * height_) return malformed("is damaged: it ends before its last pixel");
            return {};
        }
        if (rest_.empty() || kWhiteSpace.find(rest_.front()) == std::string_view::npos) {
            return malformed("is damaged: a white space belongs before its pixels");
        }
        rest_.remove_prefix(1);
        if (rest_.size() < width_ * height_ * bytes()) return malformed("is damaged: it ends before its last pixel");
        return {};
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return white_ > 255 ? 2 : 1; }

    std::optional<std::int64_t> take_bytes() {
        std::int64_t value = 0;
        for (const char byte : rest_.substr(0, bytes())) value = value << 8 | static_cast<std::uint8_t>(byte);
        rest_.remove_prefix(bytes());
        return value;
    }

    std::string_view rest_;
    std::size_t width_ = 0;
    std::size_t height_ = 0;
    std::uint16_t white_ = 255;
    bool is_plain_ = false;
};

} // namespace

Result<> check_ros_image_size(std::int64_t width, std::int64_t height) {
    if (width <= 0 || height <= 0) return malformed(fmt::format("is damaged: it has {} x {} pixels", width, height));
    if (width > kRosImageSideMax || height > kRosImageSideMax || width * height > kRosImagePixelsMax) {
        return Error{Errc::kTooLarge, fmt::format("the map's image has {} x {} pixels, more than {}", width, height,
                                                  kRosImagePixelsMax)};
    }
    return {};
}

Result<MapCells> read_ros_pgm(const RosMapDescription& map, std::span<const std::uint8_t> image) {
    auto pixels = Pixels::open(text_of(image));
    if (!pixels) return pixels.error();
    const auto cell_of = cells_of_greys(map, pixels->white());
    const std::size_t width = pixels->width();
    MapCells read{width, std::vector<MapCell>(width * pixels->height())};
    std::vector<std::uint16_t> greys(width);
    for (std::size_t row = pixels->height(); row-- > 0;) {
        if (auto done = pixels->read_row(greys); !done) return done.error();
        std::ranges::transform(greys, read.cells.begin() + static_cast<std::ptrdiff_t>(row * width),
                               [&](std::uint16_t grey) { return cell_of[grey]; });
    }
    return read;
}

std::string ros_pgm_header(std::size_t width, std::size_t height, double resolution) {
    return fmt::format("P5\n# CREATOR: Scanloom {:.3f} m/pix\n{} {}\n255\n", resolution, width, height);
}

} // namespace scanloom
