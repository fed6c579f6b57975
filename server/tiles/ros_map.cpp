#include "server/tiles/ros_map.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "server/classify/cell_class.hpp"
#include "server/tiles/layer_style.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace scanloom::tiles {
namespace {

std::uint8_t grey_of_percent(Percent percent, const mapping::MapConfig& config) noexcept {
    constexpr double kRounding = 1e-9; // 100 * 0.29 is less than 29 in floating point
    if (percent > 100) return kRosGreyUnknown;
    if (percent <= 100.0 * config.class_p_free + kRounding) return kRosGreyFree;
    return percent >= 100.0 * config.class_p_occupied - kRounding ? kRosGreyOccupied : kRosGreyUnknown;
}

std::uint8_t grey_of_count(mapping::HimmCount count, const mapping::MapConfig& config) noexcept {
    if (count <= config.class_himm_free) return kRosGreyFree;
    return count >= config.class_himm_occupied && count <= mapping::kHimmMax ? kRosGreyOccupied : kRosGreyUnknown;
}

std::uint8_t grey_of_class(classify::CellClass cell) noexcept {
    switch (cell) {
    case classify::CellClass::kFree:
    case classify::CellClass::kDanger: return kRosGreyFree;
    case classify::CellClass::kOccupied: return kRosGreyOccupied;
    case classify::CellClass::kUnexplored:
    case classify::CellClass::kFrontier: break;
    }
    return kRosGreyUnknown;
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
    const auto header = ros_pgm_header(frame.pixels_wide(), static_cast<std::size_t>(frame.height()), frame.cell_size);
    Bytes pgm;
    pgm.reserve(header.size() + image.codes.size());
    pgm.assign(header.begin(), header.end());
    std::ranges::transform(image.codes, std::back_inserter(pgm), [&](Code code) { return greys[code]; });
    return pgm;
}

std::string map_yaml(const MapFrame& frame) {
    const auto origin = frame.origin();
    return ros_yaml("map.pgm", frame.cell_size, origin.x, origin.y);
}

} // namespace scanloom::tiles
