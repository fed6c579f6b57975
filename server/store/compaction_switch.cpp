#include "server/store/compaction_switch.hpp"

namespace scanloom::store {

void CompactionSwitch::update(std::uint64_t free_bytes) {
    if (is_stopped_) return;
    if (!is_paused_ && free_bytes < pause_below_) set(true);
    if (is_paused_ && free_bytes >= pause_below_ + pause_below_ / 8) set(false);
}

void CompactionSwitch::stop() {
    is_stopped_ = true;
    set(true);
}

void CompactionSwitch::set(bool paused) {
    const auto status = database_.SetOptions({{"disable_auto_compactions", paused ? "true" : "false"}});
    if (status.ok()) is_paused_ = paused; // otherwise the next update retries
}

} // namespace scanloom::store
