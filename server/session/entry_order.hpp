#pragma once

#include "common/error/error.hpp"
#include "common/scan/exclusions.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace scanloom::session {

/// Whether entries can follow each other in a log, without weaving anything: refuses what Projection::fold() refuses,
/// in the same words.
class EntryOrder {
public:
    struct Robot {
        std::string name;
        std::string source;
        std::uint64_t last_seq = 0;
        std::set<std::uint32_t> sensors;
    };

    /// The next entry. Errors  kMalformed: it cannot follow; it is left out.
    [[nodiscard]] Result<> add(const LogEntry& entry);

    /// Of the last entry.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// By RobotIndex.
    [[nodiscard]] const std::vector<Robot>& robots() const noexcept { return robots_; }

    [[nodiscard]] const Exclusions& exclusions() const noexcept { return exclusions_; }

private:
    [[nodiscard]] Result<> check(const RobotJoined& joined);
    [[nodiscard]] Result<> check(const SensorDescribed& described);
    [[nodiscard]] Result<> check(const ScanTaken& taken);
    [[nodiscard]] Result<> check(const MapPatch& patch);
    [[nodiscard]] Result<> check(const ScansExcluded& excluded);
    [[nodiscard]] Result<> check(const ExclusionLifted& lifted);
    [[nodiscard]] Error misplaced(const std::string& what) const;

    Revision revision_ = 0;
    std::vector<Robot> robots_;
    Exclusions exclusions_;
};

} // namespace scanloom::session
