#include "tests/fault/simulation/world.hpp"

namespace scanloom::simulation {

bool World::step(Time until) {
    if (events_.empty() || events_.begin()->first.first > until) return false;
    auto next = events_.extract(events_.begin());
    now_ = next.key().first;
    next.mapped()();
    return true;
}

Duration World::between(Duration least, Duration most) {
    return least + Duration(static_cast<Duration::rep>(draw(static_cast<std::uint64_t>((most - least).count()) + 1)));
}

void World::note(std::string_view what, std::uint64_t number) {
    if (listener_) listener_(std::chrono::duration<double>(now_ - kBeginning).count(), what, number);
    const auto mix = [this](std::uint64_t byte) { fingerprint_ = (fingerprint_ ^ byte) * 0x100'0000'01b3; };
    for (const char letter : what) mix(static_cast<unsigned char>(letter));
    for (int shift = 0; shift < 64; shift += 8) mix(number >> shift & 0xff);
    for (int shift = 0; shift < 64; shift += 8)
        mix(static_cast<std::uint64_t>(now_.time_since_epoch().count()) >> shift & 0xff);
}

} // namespace scanloom::simulation
