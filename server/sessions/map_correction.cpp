#include "server/sessions/map_correction.hpp"

#include "common/wire/log_codec.hpp"
#include "server/sessions/recovery.hpp"

#include <cmath>
#include <new>
#include <string_view>

namespace scanloom::sessions {
namespace {

// In the unit of Reach::work.
constexpr double kReadWork = 1e3; // of reading an entry
constexpr double kUnbounded = 1e15;

} // namespace

Result<> MapCorrection::apply_up_to(Revision target, double& work, const std::atomic<bool>& stop) {
    const auto add = [&](Revision revision, std::string_view bytes) -> store::Visited {
        if (stop) return Error{Errc::kShuttingDown, "stopped"};
        auto entry = wire::decode_entry(bytes);
        if (!entry) return damaged_entry(revision, entry.error());
        poses_.place(*entry);
        double left = kUnbounded;
        const auto applied = projection_.apply(*entry, left);
        if (!applied) return applied.error();
        work -= kReadWork + kUnbounded - left;
        return revision >= target || work <= 0.0 ? store::Visit::kStop : store::Visit::kContinue;
    };
    if (revision() >= target) return {};
    try {
        return log_.read(session_, revision(), add);
    } catch (const std::bad_alloc&) {
        return Error{Errc::kOverloaded, "there is no memory left to correct the maps"};
    }
}

Result<> correct_as_announced(store::ScanLog& log, store::SessionId session, localization::LocalizedProjection& maps,
                              const std::atomic<bool>& stop) {
    const Revision as_of = maps.poses().corrected();
    if (!maps.is_outdated() || maps.announced() != as_of) return {};
    MapCorrection correction(log, session, maps.projection(), maps.poses().in_maps(), as_of);
    double work = HUGE_VAL;
    if (auto applied = correction.apply_up_to(maps.projection().revision(), work, stop); !applied) return applied;
    maps.replace(std::move(correction).take(), as_of);
    return {};
}

} // namespace scanloom::sessions
