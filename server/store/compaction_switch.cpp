#include "server/store/compaction_switch.hpp"

namespace scanloom::store {

void CompactionSwitch::update(std::uint64_t free_bytes) {
    const std::lock_guard lock(mutex_);
    if (is_stopped_) return;
    if (!is_paused_ && free_bytes < pause_below_) set(true);
    if (is_paused_ && free_bytes >= pause_below_ + pause_below_ / 8) set(false);
}

void CompactionSwitch::stop() {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
    set(true);
}

void CompactionSwitch::set(bool paused) {
    is_paused_ = paused;
    const auto status = database_.SetOptions({{"disable_auto_compactions", paused ? "true" : "false"}});
    status.PermitUncheckedError(); // if it fails, compactions go on or pause a little longer
}

} // namespace scanloom::store
