#include "server/tiles/occupancy_percent.hpp"

#include <cmath>

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

} // namespace scanloom::tiles
