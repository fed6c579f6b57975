#include "server/tiles/ros_map.hpp"

#include "server/classify/cell_class.hpp"
#include "server/tiles/layer_style.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

namespace scanloom::tiles {
namespace {

constexpr std::uint8_t kFree = 254;
constexpr std::uint8_t kOccupied = 0;
constexpr std::uint8_t kNeither = 205;

std::uint8_t grey_of_percent(Percent percent, const mapping::MapConfig& config) noexcept {
    constexpr double kRounding = 1e-9;  // 100 * 0.29 is less than 29
    if (percent > 100) return kNeither; // unknown
    if (percent <= 100.0 * config.class_p_free + kRounding) return kFree;
    return percent >= 100.0 * config.class_p_occupied - kRounding ? kOccupied : kNeither;
}

std::uint8_t grey_of_count(mapping::HimmCount count, const mapping::MapConfig& config) noexcept {
    if (count <= config.class_himm_free) return kFree;
    return count >= config.class_himm_occupied && count <= mapping::kHimmMax ? kOccupied : kNeither;
}

std::uint8_t grey_of_class(classify::CellClass cell) noexcept {
    switch (cell) {
    case classify::CellClass::kFree:
    case classify::CellClass::kDanger: return kFree;
    case classify::CellClass::kOccupied: return kOccupied;
    case classify::CellClass::kUnexplored:
    case classify::CellClass::kFrontier: break;
    }
    return kNeither;
}

std::array<std::uint8_t, 256> greys_of(mapping::Layer layer, const mapping::MapConfig& config) {
    std::array<std::uint8_t, 256> greys{};
    for (std::size_t code = 0; code < greys.size(); ++code) {
        const auto value = static_cast<Code>(code);
        switch (layer) {
        case mapping::Layer::kHimm: greys[code] = grey_of_count(value, config); break;
        case mapping::Layer::kClassification:
            greys[code] = grey_of_class(static_cast<classify::CellClass>(value));
            break;
        case mapping::Layer::kOccupancy:
        case mapping::Layer::kSonar: greys[code] = grey_of_percent(value, config); break;
        }
    }
    return greys;
}

} // namespace

Bytes map_pgm(const MapImage& image, const mapping::MapConfig& config) {
    const auto greys = greys_of(image.layer, config);
    const auto& frame = image.frame;
    const auto header = fmt::format("P5\n# CREATOR: Scanloom {:.3f} m/pix\n{} {}\n255\n", frame.cell_size,
                                    frame.width(), frame.height());
    Bytes pgm;
    pgm.reserve(header.size() + image.codes.size());
    pgm.assign(header.begin(), header.end());
    std::ranges::transform(image.codes, std::back_inserter(pgm), [&](Code code) { return greys[code]; });
    return pgm;
}

std::string map_yaml(const MapFrame& frame) {
    // 15 digits drop the last bits' noise of cell * cell_size: -5.05, not -5.050000000000001.
    // Unknown is p = 50 / 255 = 0.19608 to those who load it: just above free_thresh.
    const auto origin = frame.origin();
    return fmt::format("image: map.pgm\n"
                       "mode: trinary\n"
                       "resolution: {:.15g}\n"
                       "origin: [{:.15g}, {:.15g}, 0]\n"
                       "negate: 0\n"
                       "occupied_thresh: 0.65\n"
                       "free_thresh: 0.196\n",
                       frame.cell_size, origin.x(), origin.y());
}

} // namespace scanloom::tiles
