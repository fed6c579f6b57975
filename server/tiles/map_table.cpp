#include "server/tiles/map_table.hpp"

#include "server/tiles/draw_cells.hpp"
#include "server/tiles/layer_style.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace scanloom::tiles {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory, as '<f4'");

bool is_probability(mapping::Layer layer) noexcept {
    return layer == mapping::Layer::kOccupancy || layer == mapping::Layer::kSonar;
}

/// Returns the header: magic, version 1.0, and a description padded so that the data start at a multiple of 64 bytes.
std::string npy_header(mapping::Layer layer, const MapFrame& frame) {
    constexpr std::size_t kAlignment = 64;
    constexpr std::size_t kBeforeText = 10; // magic, version, length of the text
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}",
                                   is_probability(layer) ? "<f4" : "|u1", frame.height(), frame.width());
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

std::int64_t npy_bytes_per_cell(mapping::Layer layer) noexcept { return is_probability(layer) ? sizeof(float) : 1; }

Bytes map_npy(const mapping::Snapshot& snapshot, mapping::Layer layer, const MapFrame& frame) {
    const auto header = npy_header(layer, frame);
    Bytes npy(header.begin(), header.end());
    if (!is_probability(layer)) {
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

} // namespace scanloom::tiles
