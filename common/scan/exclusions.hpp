#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace scanloom {

struct Exclusion {
    ScansExcluded excluded;
    Revision since = 0;  ///< its log entry; it covers scans of earlier entries only
    Revision lifted = 0; ///< log entry that lifted it; 0: it is in effect

    friend bool operator==(const Exclusion&, const Exclusion&) = default;
};

/// All exclusions of a session's log, up to one of its entries.
class Exclusions {
public:
    static constexpr std::size_t kMost = 1000; ///< in effect at a time

    /// Checks whether the entry can follow.
    /// Errors  kMalformed: the id is not above all earlier ones; it names no exclusion that is in effect.
    [[nodiscard]] Result<> check(const ScansExcluded& excluded) const;
    [[nodiscard]] Result<> check(const ExclusionLifted& lifted) const;

    /// Adds the entry of that revision. Errors  those of check().
    [[nodiscard]] Result<> add(Revision revision, const ScansExcluded& excluded);
    [[nodiscard]] Result<> add(Revision revision, const ExclusionLifted& lifted);

    /// Whether an exclusion that is in effect covers the scan of that log entry.
    [[nodiscard]] bool cover(Revision revision, const ScanPose& scan) const noexcept;

    /// The revision of the newest entry that was added; 0 if there is none.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// Those of the log up to that revision.
    [[nodiscard]] Exclusions as_of(Revision revision) const;

    /// By rising id, lifted ones included.
    [[nodiscard]] const std::vector<Exclusion>& all() const noexcept { return all_; }
    [[nodiscard]] std::size_t count_in_effect() const noexcept;

    friend bool operator==(const Exclusions&, const Exclusions&) = default;

private:
    std::vector<Exclusion> all_;
    Revision revision_ = 0;
};

/// Shared by a session and its snapshots; never null.
using SharedExclusions = std::shared_ptr<const Exclusions>;

[[nodiscard]] SharedExclusions no_exclusions();

} // namespace scanloom
