#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace scanloom {

/// An exclusion with the log entries that added and lifted it.
struct Exclusion {
    ScansExcluded excluded;
    Revision since = 0;  ///< log entry that added it; it covers scans of earlier entries only
    Revision lifted = 0; ///< log entry that lifted it; 0: in effect

    friend bool operator==(const Exclusion&, const Exclusion&) = default;
};

/// The exclusions of a session's log up to one of its entries.
class Exclusions {
public:
    static constexpr std::size_t kMost = 1000; ///< largest number in effect at a time; add() does not check it

    /// Checks whether the entry can follow.
    /// Errors: kMalformed if its id is not greater than all earlier ones.
    [[nodiscard]] Result<> check(const ScansExcluded& excluded) const;

    /// Checks whether the entry can follow.
    /// Errors: kMalformed if no exclusion with its id is in effect.
    [[nodiscard]] Result<> check(const ExclusionLifted& lifted) const;

    /// Adds the log entry with this revision.
    /// Errors: those of check().
    [[nodiscard]] Result<> add(Revision revision, const ScansExcluded& excluded);

    /// Adds the log entry with this revision.
    /// Errors: those of check().
    [[nodiscard]] Result<> add(Revision revision, const ExclusionLifted& lifted);

    /// Returns whether an exclusion in effect covers the scan, which is the log entry with this revision.
    [[nodiscard]] bool cover(Revision revision, const ScanPose& scan) const noexcept;

    /// Returns the revision of the newest added entry; 0 if there is none.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Returns the exclusions of the log up to and including this revision.
    [[nodiscard]] Exclusions as_of(Revision revision) const;

    /// Returns all exclusions by rising id, including those that were lifted.
    [[nodiscard]] const std::vector<Exclusion>& all() const noexcept { return all_; }
    [[nodiscard]] std::size_t count_in_effect() const noexcept;

    friend bool operator==(const Exclusions&, const Exclusions&) = default;

private:
    std::vector<Exclusion> all_;
    Revision revision_ = 0;
};

/// Shared by a session and its snapshots; never null.
using SharedExclusions = std::shared_ptr<const Exclusions>;

/// Returns an empty set of exclusions.
[[nodiscard]] SharedExclusions no_exclusions();

} // namespace scanloom
