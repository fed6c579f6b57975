#pragma once

#include "common/error/error.hpp"
#include "common/scan/log_entry.hpp"
#include "core/localization/localized_projection.hpp"
#include "core/mapping/projection.hpp"
#include "server/sessions/map_correction.hpp"
#include "server/sessions/published_maps.hpp"

#include <memory>
#include <vector>

namespace scanloom::sessions {

/// The maps of a session: the projection of its log, and what is published of it.
///
/// Threads: published() may be used by any thread, everything else by one thread at a time.
class SessionMaps {
public:
    /// Publishes the maps of the projection.
    /// Throws std::bad_alloc if memory runs out.
    explicit SessionMaps(localization::LocalizedProjection maps);

    [[nodiscard]] const mapping::Projection& projection() const noexcept { return maps_.projection(); }
    [[nodiscard]] const localization::LocalizedProjection& localized() const noexcept { return maps_; }
    [[nodiscard]] const PublishedMaps& published() const noexcept { return published_; }

    /// Lets the maps follow corrected poses at the entry MapsCorrected with the same `as_of`.
    /// @param correction  that has applied all but some hundred entries
    void set_correction(std::shared_ptr<MapCorrection> correction) { correction_ = std::move(correction); }

    /// Applies the next entry, or a part of it; see LocalizedProjection::apply(). A MapsCorrected entry replaces the
    /// maps by those of set_correction().
    /// @param entry  when it is applied and is an integrated scan, its readings have been moved to the maps: only the
    ///               sequence number is left for the caller
    /// @param work  budget, reduced by the work that was done
    /// @return whether the entry is completely applied
    /// Errors: kOverloaded if memory runs out, which must not affect other sessions; those of Projection::apply(),
    ///         which are program errors because RobotSequencer checks the entries; those of
    ///         MapCorrection::apply_up_to().
    [[nodiscard]] Result<bool> apply(LogEntry& entry, double& work);

    /// Withdraws the published maps, so that apply() changes them in place; see PublishedMaps::withdraw(). publish()
    /// must follow.
    [[nodiscard]] bool withdraw() { return published_.withdraw(); }

    /// Publishes the maps.
    /// Errors: kOverloaded if memory runs out; readers then get the previous maps, or empty ones if those were
    ///         withdrawn.
    [[nodiscard]] Result<> publish();

private:
    [[nodiscard]] Result<> correct();
    void move_newest_scans();

    localization::LocalizedProjection maps_;
    std::shared_ptr<MapCorrection> correction_; // null: none waits for its entry
    /// By RobotIndex: the newest scan of each sensor, the newest one last.
    std::vector<std::vector<std::shared_ptr<const mapping::IntegratedScan>>> newest_scans_;
    PublishedMaps published_;
};

} // namespace scanloom::sessions
