#include "server/tiles/layer_style.hpp"

#include "core/classify/cell_class.hpp"
#include "core/mapping/laser_chunk.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace scanloom::tiles {
namespace {

template <class Table, class Make>
Table make_table(Make&& make) {
    Table table;
    for (std::size_t bits = 0; bits < table.size(); ++bits) {
        table[bits] = make(static_cast<mapping::LogOdds>(static_cast<std::uint16_t>(bits)));
    }
    return table;
}

Percent percent_of(mapping::LogOdds cell) {
    if (cell == mapping::kUnknownLogOdds) return kUnknownPercent;
    return static_cast<Percent>(std::lround(100.0 * mapping::probability_of(cell)));
}

} // namespace

const PercentTable& percent_table() {
    static const auto table = make_table<PercentTable>(percent_of);
    return table;
}

const SalienceTable& salience_table() {
    static const auto table =
        make_table<SalienceTable>([](mapping::LogOdds cell) { return salience_of(percent_of(cell)); });
    return table;
}

namespace {

using classify::CellClass;

constexpr Colour grey(std::uint8_t value) noexcept { return {value, value, value}; }

/// Returns the style of a layer whose codes are ordered by salience_of(). Codes that no cell has look like unknown.
template <class SalienceOf, class ColourOf>
LayerStyle make_style(Code unknown, Code code_max, SalienceOf&& salience_of_code, ColourOf&& colour_of_code) {
    LayerStyle style{};
    style.unknown = unknown;
    style.code.fill(unknown);
    for (std::size_t code = 0; code < 256; ++code) {
        const bool is_used = code <= code_max && code != unknown;
        const Salience salience = is_used ? salience_of_code(static_cast<Code>(code)) : kUnknownSalience;
        style.salience[code] = salience;
        if (is_used) style.code[salience] = static_cast<Code>(code);
        style.palette[code] = colour_of_code(is_used ? static_cast<Code>(code) : unknown);
    }
    style.is_grey = std::ranges::all_of(style.palette, [](Colour c) { return c.red == c.green && c.green == c.blue; });
    return style;
}

LayerStyle probability_style() {
    return make_style(kUnknownPercent, 100, salience_of, [](Code percent) { return grey(grey_of(percent)); });
}

LayerStyle himm_style() {
    constexpr int kStep = 255 / mapping::kHimmMax;
    return make_style(
        mapping::kUnseenHimm, mapping::kHimmMax, [](Code count) { return static_cast<Salience>(count + 1); },
        [](Code count) {
            return grey(count == mapping::kUnseenHimm ? kUnknownGrey : static_cast<std::uint8_t>(255 - kStep * count));
        });
}

Salience salience_of_class(Code code) noexcept {
    switch (static_cast<CellClass>(code)) {
    case CellClass::kOccupied: return 4;
    case CellClass::kDanger: return 3;
    case CellClass::kFrontier: return 2;
    case CellClass::kFree: return 1;
    case CellClass::kUnexplored: break;
    }
    return kUnknownSalience;
}

Colour colour_of_class(Code code) noexcept {
    switch (static_cast<CellClass>(code)) {
    case CellClass::kOccupied: return {67, 40, 24};
    case CellClass::kDanger: return {217, 72, 56};
    case CellClass::kFrontier: return {46, 160, 67};
    case CellClass::kFree: return {255, 249, 214};
    case CellClass::kUnexplored: break;
    }
    return grey(kUnknownGrey);
}

LayerStyle class_style() {
    return make_style(static_cast<Code>(CellClass::kUnexplored), static_cast<Code>(CellClass::kDanger),
                      salience_of_class, colour_of_class);
}

} // namespace

const LayerStyle& style_of(mapping::Layer layer) {
    static const LayerStyle probability = probability_style();
    static const LayerStyle himm = himm_style();
    static const LayerStyle classes = class_style();
    switch (layer) {
    case mapping::Layer::kHimm: return himm;
    case mapping::Layer::kClassification: return classes;
    case mapping::Layer::kOccupancy:
    case mapping::Layer::kSonar: return probability;
    }
    std::abort(); // each layer has a case
}

} // namespace scanloom::tiles
