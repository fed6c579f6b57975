#pragma once

#include "common/wire/live.hpp"
#include "core/landmarks/landmark_map.hpp"
#include "core/mapping/layer.hpp"
#include "core/mapping/snapshot.hpp"

#include <array>
#include <bitset>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::live {

/// The landmarks of a session that were found so far. Immutable.
struct FoundLandmarks {
    landmarks::LandmarkState state;
    Revision revision = 0; ///< searched log entries
    std::string refused;   ///< why the search has ended with an error; empty: it has not
};

/// The state of a session from which an event is created.
struct SessionSnapshot {
    std::shared_ptr<const mapping::Snapshot> maps;
    std::vector<bool> connected; ///< by RobotIndex; robots beyond the end are not connected
    wire::LiveState state = wire::LiveState::kOk;
    std::string reason;                                        ///< when the state is not kOk
    std::uint64_t goals_revision = 0;                          ///< LiveEvent::goals_revision
    std::shared_ptr<const FoundLandmarks> landmarks = nullptr; ///< null: none yet, or not subscribed
};

/// The subscription of a viewer: the contents of its events.
struct Subscription {
    std::bitset<mapping::kLayers.size()> layers = ~std::bitset<mapping::kLayers.size()>(); ///< by mapping::Layer
    bool points = true;
    bool landmarks = false;
};

/// Returns the subscription that a request contains.
[[nodiscard]] Subscription subscription_of(const wire::LiveRequest& request) noexcept;

/// Sort key of a session's landmarks: by the revision at which they were last seen. A landmark that is seen again moves
/// behind all earlier ones.
struct LandmarkKey {
    Revision last = 0;    ///< MapLandmark::last
    std::uint64_t id = 0; ///< MapLandmark::id, plus one

    friend auto operator<=>(const LandmarkKey&, const LandmarkKey&) = default;
};

[[nodiscard]] inline LandmarkKey key_of(const landmarks::MapLandmark& landmark) noexcept {
    return {landmark.last, std::uint64_t{landmark.id} + 1};
}

/// New or changed landmarks.
struct LandmarkChanges {
    std::vector<const landmarks::MapLandmark*> first; ///< sorted by LandmarkKey; point into the view
    std::size_t following = 0;                        ///< number of further ones, not in `first`
};

/// Returns the first `most` landmarks after `sent`, and the number of the others.
/// Cost: proportional to the blocks of landmarks that changed since `sent`.
[[nodiscard]] LandmarkChanges changed_landmarks(const landmarks::LandmarkView& landmarks, LandmarkKey sent,
                                                std::size_t most);

/// Returns the end points of the beams that hit an obstacle.
///
/// @param scan  a scan that fits its sensor
/// @param stride  >= 1; the first hit and every `stride`-th one after it are returned
/// @return offsets from the position of the sensor, along the axes of the map frame
[[nodiscard]] wire::ScanPoints points_of(const mapping::IntegratedScan& scan, std::size_t stride);

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
/// Keeps the last sent revision of each layer, and the last sent scan and trail point of each robot. When the poses of
/// earlier scans were corrected, it sends all robots again. Its memory depends on the number of robots only.
/// Cost: an event takes time in proportion to the chunks and robots that changed since the last one.
class EventEncoder {
public:
    /// @param session  LiveEvent::session
    explicit EventEncoder(std::string session) : session_(std::move(session)) {}

    /// Sets the contents of the next events. A layer that was sent before continues at its last revision; the newest
    /// scans are sent again.
    void set_subscription(const Subscription& subscription);

    [[nodiscard]] bool subscribes_to_landmarks() const noexcept { return subscription_.landmarks; }

    /// Returns whether the last event had no room for all landmarks. The next event adds more, even for an equal
    /// snapshot.
    [[nodiscard]] bool has_more() const noexcept { return sent_landmarks_.following > 0; }

    /// Returns the next event; nullopt if nothing has changed.
    /// @param snapshot  of the same session in each call, and not older than in the call before
    [[nodiscard]] std::optional<wire::LiveEvent> next(const SessionSnapshot& snapshot);

private:
    struct SentRobot {
        bool known = false;
        bool connected = false;
        std::optional<double> body_radius;
        std::uint64_t scan_count = 0;
        std::size_t trail = 0; // points
        Revision scan = 0;     // last scan sent as points
        std::optional<wire::LiveLocalization> localization;
    };

    struct SentSession {
        Revision revision = 0;
        wire::LiveState state = wire::LiveState::kOk;
        std::uint64_t goals_revision = 0;
        Revision poses_corrected = 0;
        std::uint64_t moving_scans = 0;

        friend bool operator==(const SentSession&, const SentSession&) = default;
    };

    struct SentLandmarks {
        LandmarkKey up_to;                  // last landmark sent
        std::uint64_t following = 0;        // landmarks that did not fit into the last event
        std::optional<std::string> refused; // nullopt: no event contained landmarks yet
    };

    void add_tiles(const mapping::Snapshot& maps, wire::LiveEvent& event);
    void add_robots(const SessionSnapshot& snapshot, wire::LiveEvent& event);
    void add_landmarks(const SessionSnapshot& snapshot, wire::LiveEvent& event);
    [[nodiscard]] bool has_changed(const mapping::RobotState& robot, bool connected, const SentRobot& sent) const;
    [[nodiscard]] bool shows_scan(const mapping::RobotState& robot, const SentRobot& sent) const;
    [[nodiscard]] std::size_t stride_for(const mapping::Snapshot& maps) const;

    std::string session_;
    Subscription subscription_;
    std::optional<SentSession> sent_;
    std::array<Revision, mapping::kLayers.size()> sent_layers_{};
    std::vector<SentRobot> sent_robots_;
    SentLandmarks sent_landmarks_;
};

} // namespace scanloom::live
