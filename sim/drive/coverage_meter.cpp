#include "sim/drive/coverage_meter.hpp"

#include "sim/drive/behaviour.hpp"

#include <cmath>

namespace scanloom::robot {
namespace {

/// Calls visit(Spot) for the free cells whose centres are within the body's radius of a point.
template <class Visit>
void for_cells_under(const Ground& ground, const Point2& position, Visit&& visit) {
    const Spot centre = ground.spot_of(position);
    const auto reach = static_cast<std::int32_t>(std::ceil(kBodyRadius / ground.plan().cell_size));
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            const Spot spot{centre.x + dx, centre.y + dy};
            if (!ground.is_free(spot) || norm(ground.centre_of(spot) - position) > kBodyRadius) continue;
            visit(spot);
        }
    }
}

} // namespace

CoverageMeter::CoverageMeter(const Ground& ground, const std::vector<std::uint8_t>& places)
    : left_(places.size()), cell_m2_(ground.plan().cell_size * ground.plan().cell_size) {
    for (std::int32_t y = 0; y < ground.plan().height; ++y) {
        for (std::int32_t x = 0; x < ground.plan().width; ++x) {
            if (places[ground.index_of({x, y})] == 0) continue;
            for_cells_under(ground, ground.centre_of({x, y}), [&](Spot spot) {
                reachable_ += left_[ground.index_of(spot)] == 0 ? 1 : 0;
                left_[ground.index_of(spot)] = 1;
            });
        }
    }
}

void CoverageMeter::pass(const Ground& ground, const Point2& position) {
    for_cells_under(ground, position, [&](Spot spot) {
        passed_ += left_[ground.index_of(spot)];
        left_[ground.index_of(spot)] = 0;
    });
}

double CoverageMeter::share() const noexcept {
    return reachable_ == 0 ? 1.0 : static_cast<double>(passed_) / static_cast<double>(reachable_);
}

} // namespace scanloom::robot
