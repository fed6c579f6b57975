#pragma once

#include "common/scan/exclusions.hpp"
#include "common/scan/jump_filter.hpp"

#include <utility>

namespace scanloom {

/// How a scan of the log is used.
enum class ScanUse {
    kIntegrated,
    kJump,     ///< left out because of max_jump
    kExcluded, ///< left out because of an exclusion; max_jump ignores it
};

/// Decides which scans of a log are integrated. Every projection of the log uses it, so that maps, trajectories,
/// landmarks and exports contain the same scans.
class ScanFilter {
public:
    /// @param max_jump_m  metres; 0: off
    /// @param exclusions  not null
    explicit ScanFilter(double max_jump_m = 0.0, SharedExclusions exclusions = no_exclusions())
        : exclusions_(std::move(exclusions)), jumps_(max_jump_m) {}

    /// Returns whether the use of a scan depends on the scans before it.
    [[nodiscard]] bool depends_on_earlier_scans() const noexcept { return jumps_.is_on(); }

    /// Returns how the scan is used if it is the log's next one, in the entry with this revision.
    [[nodiscard]] ScanUse use_of(Revision revision, const ScanPose& scan) const noexcept;

    /// Adds the log's next scan, in the entry with this revision, and returns how it is used.
    ScanUse take(Revision revision, const ScanPose& scan);

    [[nodiscard]] const SharedExclusions& exclusions() const noexcept { return exclusions_; }
    [[nodiscard]] const JumpFilter& jumps() const noexcept { return jumps_; }
    [[nodiscard]] JumpFilter& jumps() noexcept { return jumps_; }

private:
    SharedExclusions exclusions_;
    JumpFilter jumps_;
};

} // namespace scanloom
