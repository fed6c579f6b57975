#include "lab/cluster_loads.hpp"

#include <algorithm>

namespace scanloom::lab::cluster {

Loads::Loads(std::size_t machines, double most, Time from)
    : robots_(machines, 0), machines_(machines), most_(most), from_(from) {}

void Loads::add(std::size_t machine, std::int64_t robots, Time now) {
    advance(now);
    robots_[machine] += robots;
    Machine& changed = machines_[machine];
    const bool is_over = static_cast<double>(robots_[machine]) > most_;
    if (is_over && !changed.is_over) changed.since = now;
    if (!is_over && changed.is_over) end_overload(changed, now);
    changed.is_over = is_over;
}

void Loads::finish(Time now) {
    advance(now);
    for (Machine& machine : machines_) {
        if (machine.is_over) end_overload(machine, now);
        if (machine.was_over) ++overload_.machines;
    }
}

std::int64_t Loads::fullest() const { return std::ranges::max(robots_); }

double Loads::fullest_mean() const noexcept {
    const Time time = now_ - from_;
    return time > Time(0) ? robot_seconds_ / in_seconds(time) : 0.0;
}

/// Changes at the same moment are one change: only what stays for a time counts.
void Loads::advance(Time now) {
    const Time begin = std::max(now_, from_);
    now_ = now;
    if (now <= begin) return;
    const std::int64_t fullest_now = fullest();
    fullest_ever_ = std::max(fullest_ever_, fullest_now);
    robot_seconds_ += static_cast<double>(fullest_now) * in_seconds(now - begin);
}

void Loads::end_overload(Machine& machine, Time now) {
    const Time begin = std::max(machine.since, from_);
    if (now <= begin) return;
    machine.was_over = true;
    overload_.total += now - begin;
    overload_.longest = std::max(overload_.longest, now - begin);
}

} // namespace scanloom::lab::cluster
