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

/// Bounds of one event, together about 450 KiB.
inline constexpr std::size_t kTilesMax = 2048;        ///< of a layer; if more changed, the event reports "everything"
inline constexpr std::size_t kScanPointsMax = 16'384; ///< of all robots; all scans are thinned by the same stride
inline constexpr std::size_t kTrailMax = 256;         ///< points of a robot
inline constexpr std::size_t kTrailsMax = 8'192;      ///< of all robots, with at least one point each
inline constexpr std::size_t kLandmarksMax = 1'024;

/// Event encoder of one viewer: creates events with the changes since its last event.
///
/// Each event is created from the newest state, and intermediate states are skipped. A client that applies every event
/// knows the state of the newest snapshot.
///
/// Keeps the last sent revision of each layer, and the last sent scan and trail point of each robot. Its memory depends
/// on the number of robots only.
/// Cost: an event takes time in proportion to the chunks and robots that changed since the last one.
class Narrator {
public:
    /// @param session  LiveEvent::session
    explicit Narrator(std::string session) : session_(std::move(session)) {}

    /// Sets the contents of the next events. A layer that was sent before continues at its last revision; the newest
    /// scans are sent again.
    void set_wishes(const Wishes& wishes);

    [[nodiscard]] bool wishes_for_landmarks() const noexcept { return wishes_.landmarks; }

    /// Returns whether the last event had no room for all landmarks. The next event adds more, even for an equal
    /// moment.
    [[nodiscard]] bool has_more() const noexcept { return told_landmarks_.following > 0; }

    /// Returns the next event; nullopt if nothing has changed.
    /// @param moment  of the same session in each call, and not older than in the call before
    [[nodiscard]] std::optional<wire::LiveEvent> next(const Moment& moment);

private:
    struct ToldRobot {
        bool known = false;
        bool connected = false;
        std::optional<double> body_radius;
        std::uint64_t scan_count = 0;
        std::size_t trail = 0; // points
        Revision scan = 0;     // last scan sent as points
    };

    struct ToldSession {
        Revision revision = 0;
        wire::LiveState state = wire::LiveState::kOk;
        std::uint64_t goals_revision = 0;

        friend bool operator==(const ToldSession&, const ToldSession&) = default;
    };

    struct ToldLandmarks {
        LandmarkPlace up_to;                // last landmark sent
        std::uint64_t following = 0;        // landmarks that did not fit into the last event
        std::optional<std::string> refused; // nullopt: no event contained landmarks yet
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
