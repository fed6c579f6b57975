#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string_view>
#include <utility>

/// The whole system on one thread: a simulated clock, network and disk, and the real parts of the programs on them.
namespace scanloom::simulation {

using Time = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

/// A clock that only events advance, and the source of all randomness. The same seed gives the same events in the same
/// order.
class World {
public:
    /// Receives each note() with its time in seconds since the start.
    using Listener = std::function<void(double seconds, std::string_view what, std::uint64_t number)>;

    explicit World(std::uint64_t seed, Listener listener = {}) : random_(seed), listener_(std::move(listener)) {}
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    [[nodiscard]] Time now() const noexcept { return now_; }

    /// Schedules an event. Events of the same moment run in the order in which they were scheduled.
    void at(Time time, std::function<void()> event) {
        events_.emplace(Moment{std::max(time, now_), ++planned_}, std::move(event));
    }
    void after(Duration delay, std::function<void()> event) { at(now_ + delay, std::move(event)); }

    /// Runs the next event. @return false if there is none until then
    bool step(Time until);

    /// Returns a uniform random number from 0 to `below` - 1. Pre: below > 0.
    [[nodiscard]] std::uint64_t draw(std::uint64_t below) { return random_() % below; }
    [[nodiscard]] bool chance(double probability) {
        return static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
    }
    [[nodiscard]] Duration between(Duration least, Duration most);

    /// Records an event, for the comparison of two runs of a seed.
    void note(std::string_view what, std::uint64_t number = 0);
    [[nodiscard]] std::uint64_t fingerprint() const noexcept { return fingerprint_; }

private:
    static constexpr Time kBeginning{std::chrono::hours(1)};
    using Moment = std::pair<Time, std::uint64_t>;

    std::mt19937_64 random_;
    const Listener listener_;
    Time now_ = kBeginning;
    std::uint64_t planned_ = 0;
    std::map<Moment, std::function<void()>> events_;
    std::uint64_t fingerprint_ = 0xcbf2'9ce4'8422'2325; // FNV-1a
};

} // namespace scanloom::simulation
