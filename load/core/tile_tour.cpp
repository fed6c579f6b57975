#include "load/core/tile_tour.hpp"

#include <array>
#include <utility>

namespace scanloom::load {
namespace {

constexpr std::array<const char*, 2> kLayers{"occupancy", "classification"}; ///< the layers that the viewer shows first

} // namespace

TileTour::TileTour(double rate, Micros first)
    : period_(static_cast<Micros>(static_cast<double>(kSecond) / rate)), turn_(first) {}

TileTour::Step TileTour::next() {
    const std::string layer = kLayers[round_ % kLayers.size()];
    if (requested_ == tiles_.size()) return {layer, true, {}, turn_};
    turn_ += period_;
    Step step{layer, false, tiles_[requested_++], turn_};
    if (requested_ == tiles_.size()) ++round_;
    return step;
}

void TileTour::listed(std::vector<TilePlace> tiles) {
    tiles_ = std::move(tiles);
    requested_ = 0;
    if (!tiles_.empty()) return;
    turn_ += period_;
    ++round_;
}

} // namespace scanloom::load
