#pragma once

#include "common/wire/live.hpp"
#include "server/live/core/landmark_news.hpp"
#include "server/live/core/moment.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::live {

/// What one event holds at most: some 450 KiB, whatever the session is.
inline constexpr std::size_t kTilesMax = 2048;        ///< of a layer; of more it is said that everything changed
inline constexpr std::size_t kScanPointsMax = 16'384; ///< of all robots; more scans are thinned out alike
inline constexpr std::size_t kTrailMax = 256;         ///< points of a robot
inline constexpr std::size_t kTrailsMax = 8'192;      ///< of all robots, but for one each
inline constexpr std::size_t kLandmarksMax = 1'024;

/// Tells one viewer what is new to it, each time from the newest state: what came in between is skipped, and whoever
/// takes in every event knows all the same what the newest snapshot shows.
///
/// Remembers what the viewer was told: for each layer up to which revision, for each robot up to which scan and which
/// point of its trail. That follows the number of robots, not what happens.
/// Cost    of an event: the chunks and robots that changed since the last.
class Narrator {
public:
    /// `session` as LiveEvent::session.
    explicit Narrator(std::string session) : session_(std::move(session)) {}

    /// What is told from now on. A layer that was told before goes on from there; scans are told anew.
    void set_wishes(const Wishes& wishes);

    [[nodiscard]] bool wishes_for_landmarks() const noexcept { return wishes_.landmarks; }

    /// Whether more is to be told than the last event had place for: the next one goes on, also at the same moment.
    [[nodiscard]] bool has_more() const noexcept { return told_landmarks_.following > 0; }

    /// Nothing when there is nothing new.
    /// Pre  every moment is of the same session, and no older than the one before.
    [[nodiscard]] std::optional<wire::LiveEvent> next(const Moment& moment);

private:
    struct ToldRobot {
        bool known = false;
        bool connected = false;
        std::optional<double> body_radius;
        std::uint64_t scan_count = 0;
        std::size_t trail = 0; // points
        Revision scan = 0;     // shown as points
    };

    struct ToldSession {
        Revision revision = 0;
        wire::LiveState state = wire::LiveState::kOk;
        std::uint64_t goals_revision = 0;

        friend bool operator==(const ToldSession&, const ToldSession&) = default;
    };

    struct ToldLandmarks {
        LandmarkPlace up_to;                // those up to there
        std::uint64_t following = 0;        // that the last event had no place for
        std::optional<std::string> refused; // nothing: no event was about landmarks yet
    };

    void tell_tiles(const mapping::Snapshot& maps, wire::LiveEvent& event);
    void tell_robots(const Moment& moment, wire::LiveEvent& event);
    void tell_landmarks(const Moment& moment, wire::LiveEvent& event);
    [[nodiscard]] bool is_news(const mapping::RobotState& robot, bool connected, const ToldRobot& told) const;
    [[nodiscard]] bool shows_scan(const mapping::RobotState& robot, const ToldRobot& told) const;
    [[nodiscard]] std::size_t stride_for(const mapping::Snapshot& maps) const;

    std::string session_;
    Wishes wishes_;
    std::optional<ToldSession> told_;
    std::array<Revision, mapping::kLayers.size()> told_layers_{};
    std::vector<ToldRobot> told_robots_;
    ToldLandmarks told_landmarks_;
};

} // namespace scanloom::live
