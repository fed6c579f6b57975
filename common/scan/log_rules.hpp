#pragma once

#include "common/error/error.hpp"
#include "common/scan/exclusions.hpp"
#include "common/scan/log_entry.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace scanloom {

/// A sensor as a log entry described it. The description is shared, never changed.
struct KnownSensor {
    Revision revision = 0; ///< of that entry, or of a checkpoint after it
    std::shared_ptr<const Sensor> sensor;
};

/// A robot as the entries of a log describe it, up to one of them.
struct LoggedRobot {
    std::string name;
    std::string source;                           ///< RobotJoined::source
    std::optional<double> body_radius;            ///< RobotJoined::body_radius
    std::uint64_t last_seq = 0;                   ///< of its newest scan; 0: it has none
    std::map<std::uint32_t, KnownSensor> sensors; ///< by id

    /// Whether it may join again with that source: all scans of a robot are of one source.
    [[nodiscard]] bool accepts(const std::string& other_source) const {
        return last_seq == 0 || source == other_source;
    }

    [[nodiscard]] bool is_next(std::uint64_t seq) const noexcept { return seq == last_seq + 1; }

    /// Null: it has described no such sensor.
    [[nodiscard]] const KnownSensor* find_sensor(std::uint32_t id) const noexcept {
        const auto found = sensors.find(id);
        return found == sensors.end() ? nullptr : &found->second;
    }
};

/// Decides which entry may follow which in a session's log, and holds what that depends on.
class LogRules {
public:
    LogRules() = default;

    /// After the entry of that revision, as a checkpoint stores it.
    LogRules(Revision revision, std::vector<LoggedRobot> robots, Exclusions exclusions)
        : revision_(revision), robots_(std::move(robots)), exclusions_(std::move(exclusions)) {}

    /// Checks whether the entry can be the next one.
    /// Errors  kMalformed: it cannot, which only happens in a damaged log.
    [[nodiscard]] Result<> check(const LogEntry& entry) const;

    /// Adds the next entry. Pre  check() accepts it.
    void apply(const LogEntry& entry);

    /// check(), and where that succeeds apply().
    [[nodiscard]] Result<> add(const LogEntry& entry);

    /// Of the newest entry.
    [[nodiscard]] Revision revision() const noexcept { return revision_; }

    /// By RobotIndex.
    [[nodiscard]] const std::vector<LoggedRobot>& robots() const noexcept { return robots_; }

    [[nodiscard]] const Exclusions& exclusions() const noexcept { return exclusions_; }

private:
    [[nodiscard]] Result<> check_body(const RobotJoined& joined) const;
    [[nodiscard]] Result<> check_body(const SensorDescribed& described) const;
    [[nodiscard]] Result<> check_body(const ScanTaken& taken) const;
    [[nodiscard]] Result<> check_body(const MapPatch& patch) const;
    [[nodiscard]] Result<> check_body(const ScansExcluded& excluded) const;
    [[nodiscard]] Result<> check_body(const ExclusionLifted& lifted) const;
    void apply_body(const RobotJoined& joined);
    void apply_body(const SensorDescribed& described);
    void apply_body(const ScanTaken& taken);
    void apply_body(const MapPatch& patch);
    void apply_body(const ScansExcluded& excluded);
    void apply_body(const ExclusionLifted& lifted);

    Revision revision_ = 0;
    std::vector<LoggedRobot> robots_;
    Exclusions exclusions_;
};

} // namespace scanloom
