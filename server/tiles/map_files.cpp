#include "server/tiles/map_files.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "core/classify/cell_class.hpp"
#include "server/tiles/layer_style.hpp"
#include "server/tiles/map_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

namespace scanloom::tiles {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory, as '<f4'");

/// Returns the header: magic, version 1.0, and a description padded so that the data start at a multiple of 64 bytes.
std::string npy_header(mapping::Layer layer, const MapFrame& frame) {
    constexpr std::size_t kAlignment = 64;
    constexpr std::size_t kBeforeText = 10; // magic, version, length of the text
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                   mapping::is_probability(layer) ? "<f4" : "|u1", frame.height(), frame.width());
    const std::size_t unpadded = kBeforeText + text.size() + 1;
    text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
    text += '\n';
    std::string header = "\x93NUMPY";
    header += '\1';
    header += '\0';
    header += static_cast<char>(text.size() & 0xFF);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

struct ProbabilityOf {
    float operator()(mapping::LogOdds cell) const noexcept {
        return mapping::is_known(cell) ? static_cast<float>(mapping::probability_of(cell))
                                       : std::numeric_limits<float>::quiet_NaN();
    }
    float operator()(auto) const noexcept { return 0.0F; } // other layers: not called
};

} // namespace

std::string map_csv(const MapImage& image) {
    std::array<std::string, 256> texts;
    for (int code = 0; code < 256; ++code)
        texts[static_cast<std::size_t>(code)] = std::to_string(code == 255 ? -1 : code);
    std::string csv;
    csv.reserve(image.codes.size() * 3);
    const auto width = static_cast<std::size_t>(image.frame.width());
    for (std::size_t n = 0; n < image.codes.size(); ++n) {
        csv += texts[image.codes[n]];
        csv += (n + 1) % width == 0 ? '\n' : ',';
    }
    return csv;
}

std::int64_t npy_bytes_per_cell(mapping::Layer layer) noexcept {
    return mapping::is_probability(layer) ? sizeof(float) : 1;
}

Bytes map_npy(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame) {
    const auto header = npy_header(layer, frame);
    Bytes npy(header.begin(), header.end());
    if (!mapping::is_probability(layer)) {
        const auto image = render_map(snapshot, layer, frame);
        npy.insert(npy.end(), image.codes.begin(), image.codes.end());
        return npy;
    }
    std::vector<float> cells(frame.pixels(), std::numeric_limits<float>::quiet_NaN());
    draw_cells(snapshot, layer, frame, std::span(cells), ProbabilityOf{});
    npy.resize(header.size() + cells.size() * sizeof(float));
    std::memcpy(npy.data() + header.size(), cells.data(), cells.size() * sizeof(float));
    return npy;
}

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

std::vector<std::int8_t> occupancy_grid(const MapImage& image, const mapping::MapConfig& config) {
    const auto greys = greys_of(image.layer, config);
    const auto cell_of = [&](Code code) -> std::int8_t {
        return greys[code] == kRosGreyFree ? 0 : greys[code] == kRosGreyOccupied ? 100 : -1;
    };
    const std::size_t width = image.frame.pixels_wide();
    std::vector<std::int8_t> cells;
    cells.reserve(image.codes.size());
    for (auto row_end = image.codes.end(); row_end != image.codes.begin();
         row_end -= static_cast<std::ptrdiff_t>(width)) {
        std::transform(row_end - static_cast<std::ptrdiff_t>(width), row_end, std::back_inserter(cells), cell_of);
    }
    return cells;
}

std::string map_yaml(const MapFrame& frame) {
    const auto origin = frame.origin();
    return ros_yaml("map.pgm", frame.cell_size, origin.x, origin.y);
}

std::string world_file(const MapFrame& frame) {
    const auto origin = frame.origin(); // the lower left corner
    const double left = origin.x + 0.5 * frame.cell_size;
    const double top = origin.y + (static_cast<double>(frame.height()) - 0.5) * frame.cell_size;
    return fmt::format("{0:.9g}\n0\n0\n-{0:.9g}\n{1:.9g}\n{2:.9g}\n", frame.cell_size, left, top);
}

} // namespace scanloom::tiles
