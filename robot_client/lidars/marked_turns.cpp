#include "robot_client/lidars/marked_turns.hpp"

#include "common/scan/limits.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scanloom::robot {

void MarkedTurns::begin_turn(double arrival) {
    clock_.begin_turn(arrival);
    end_turn();
    is_given_ = true;
}

void MarkedTurns::add(const LidarBeam& beam) {
    const auto change = beam.step - last_step_.value_or(beam.step);
    travelled_ += static_cast<std::int64_t>(std::remainder(change, steps_per_turn_));
    last_step_ = beam.step;
    if (beams_.size() <= kBeamsMax) beams_.push_back(beam); // one point too many shows that the turn is too long
}

void MarkedTurns::end_turn() {
    auto beams = std::exchange(beams_, {});
    const bool is_lost = travelled_ > std::int64_t{steps_per_turn_} * 5 / 4; // more than the corrections of angles
    travelled_ = 0;
    last_step_.reset();
    if (!is_given_ || beams.empty()) return;
    if (is_lost || beams.size() > kBeamsMax) {
        ++(is_lost ? gaps_ : too_long_);
        return;
    }
    std::ranges::stable_sort(beams, {}, &LidarBeam::step);
    const auto is_same_step = [](const LidarBeam& a, const LidarBeam& b) { return a.step == b.step; };
    beams.erase(std::unique(beams.begin(), beams.end(), is_same_step), beams.end());
    const double turn = clock_.period().value_or(0.0);
    const double part = static_cast<double>(beams.back().step - beams.front().step) / steps_per_turn_;
    complete_.push_back({clock_.begun() - turn / 2.0, std::move(beams), turn * part});
    ++count_;
}

std::optional<LidarTurn> MarkedTurns::next() {
    if (complete_.empty()) return std::nullopt;
    LidarTurn turn = std::move(complete_.front());
    complete_.pop_front();
    return turn;
}

void MarkedTurns::restart() {
    clock_.restart();
    is_given_ = false;
    beams_.clear();
    last_step_.reset();
    travelled_ = 0;
}

} // namespace scanloom::robot
