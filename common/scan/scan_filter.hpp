#pragma once

#include "common/scan/exclusions.hpp"
#include "common/scan/jump_filter.hpp"

#include <utility>

namespace scanloom {

/// What becomes of a scan of the log.
enum class ScanUse {
    kIntegrated,
    kJump,     ///< left out by max_jump
    kExcluded, ///< left out by an exclusion; max_jump does not see it
};

/// Decides which scans of a log are integrated. All that is computed from the log asks it, so that maps, paths,
/// landmarks and exports hold the same scans.
class ScanFilter {
public:
    /// @param max_jump_m  metres; 0: off
    explicit ScanFilter(double max_jump_m = 0.0, SharedExclusions exclusions = no_exclusions())
        : exclusions_(std::move(exclusions)), jumps_(max_jump_m) {}

    /// Whether what becomes of a scan depends on the scans before it.
    [[nodiscard]] bool depends_on_earlier_scans() const noexcept { return jumps_.is_on(); }

    /// What becomes of the scan if it is the log's next one, in the entry of that revision.
    [[nodiscard]] ScanUse use_of(Revision revision, const ScanPose& scan) const noexcept;

    /// Adds the log's next scan. @return use_of() it
    ScanUse take(Revision revision, const ScanPose& scan);

    [[nodiscard]] const SharedExclusions& exclusions() const noexcept { return exclusions_; }
    [[nodiscard]] const JumpFilter& jumps() const noexcept { return jumps_; }
    [[nodiscard]] JumpFilter& jumps() noexcept { return jumps_; }

private:
    SharedExclusions exclusions_;
    JumpFilter jumps_;
};

} // namespace scanloom
