#pragma once

#include "common/scan/log_entry.hpp"
#include "server/sessions/backlog.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <optional>
#include <variant>

namespace scanloom::sessions {

/// When a session writes its checkpoints. They bound the work that a restart repeats.
class CheckpointSchedule {
public:
    /// @param stored  revision of the stored checkpoint, if there is one
    CheckpointSchedule(store::SessionId session, std::optional<Revision> stored)
        : every_(entries_between(session)), stored_(stored), tried_(stored.value_or(0)) {}

    /// Counts an entry that was applied to the maps.
    void count(const PendingEntry& applied) {
        work_ += applied.reach.work;
        if (std::holds_alternative<SensorDescribed>(*applied.entry)) described_ += applied.bytes;
    }

    /// Returns whether a checkpoint should be written. After a failed one, the next is due as late as after a stored
    /// one.
    /// @param now  revision of the maps
    /// @param is_growing  whether a checkpoint is in proportion to the log, as the state of the estimation is. Then the
    ///                    log must have grown by a quarter, so that all checkpoints together are, too
    [[nodiscard]] bool is_due(Revision now, bool is_growing = false) const noexcept {
        if (writing_) return false;
        const Revision grown = now - tried_;
        const bool has_grown = !is_growing || grown >= tried_ / 4;
        return described_ >= kDescribed || (has_grown && (grown >= every_ || work_ >= kWork));
    }

    /// Returns whether the maps are newer than the stored checkpoint.
    [[nodiscard]] bool is_outdated(Revision now) const noexcept { return now > stored_.value_or(0); }

    /// Returns whether a checkpoint is being written: begin() was called, and end() not yet.
    [[nodiscard]] bool is_writing() const noexcept { return writing_; }

    /// Begins a checkpoint.
    /// @param now  revision of the maps
    /// @return revision of the stored one
    std::optional<Revision> begin(Revision now) noexcept {
        writing_ = true;
        tried_ = now;
        work_ = 0.0;
        described_ = 0;
        return stored_;
    }

    /// Ends a checkpoint.
    /// @param stored  its revision; after a failure that of the previous one
    void end(std::optional<Revision> stored) noexcept {
        writing_ = false;
        stored_ = stored;
    }

private:
    static constexpr double kWork = 1e10;                           // in the unit of Reach::work
    static constexpr std::size_t kDescribed = std::size_t{4} << 20; // bytes: bounds a checkpoint's last piece

    /// Returns 4096 to 1.5 times as many, depending on the session. With one number for all, sessions that started
    /// together would always write at the same time.
    static constexpr Revision entries_between(store::SessionId session) noexcept {
        constexpr Revision kEntries = 4096;
        return kEntries + (session - 1) * 0x9E37'79B9 % (kEntries / 2); // Fibonacci hashing
    }

    Revision every_;
    std::optional<Revision> stored_;
    Revision tried_;            // revision of the checkpoint that began last, even if it failed
    double work_ = 0.0;         // applied since the last checkpoint began
    std::size_t described_ = 0; // bytes of sensor descriptions applied since then
    bool writing_ = false;
};

} // namespace scanloom::sessions
