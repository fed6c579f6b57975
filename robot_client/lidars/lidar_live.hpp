#pragma once

#include "common/scan/poses.hpp"
#include "robot_client/lidars/lidar_driver.hpp"
#include "robot_client/lidars/lidar_reader.hpp"
#include "robot_client/lidars/lidar_scan.hpp"
#include "robot_client/sources/live_source.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace scanloom::robot {

struct LidarLiveOptions {
    LidarReaderOptions device;
    std::unique_ptr<LidarDriver> driver; ///< of that device; never null
    Poses kind = Poses::kMap;            ///< what the robot's poses are
    LidarPoses poses;                    ///< known from the start; their times are Unix time
    int pose_descriptor = -1;            ///< source of further poses (see pose_feed.hpp), owned by the reader; -1: none
    std::chrono::milliseconds pose_wait{500};       ///< how long a scan waits for the pose after it, if more may come;
    std::chrono::milliseconds pose_age_max{500};    ///< then it takes the newest pose if that is no older than this
    std::chrono::milliseconds pose_ahead_max{2000}; ///< largest lead of a received pose over this machine's clock
};

/// Most scans that wait for next(); beyond that the oldest are dropped.
inline constexpr std::size_t kScansWaitingMax = 64;

/// A lidar that is read live: each scan of its driver that has a pose. Stamps are Unix time.
///
/// From the first next() on, the sensor and the poses are read continuously on that executor, whether or not next() is
/// called: bytes that are not read from a serial line in time are lost. Poses whose times are more than a minute away
/// from those of the scans are reported once.
class LidarLive final : public LiveSource {
public:
    explicit LidarLive(LidarLiveOptions options);
    LidarLive(const LidarLive&) = delete;
    LidarLive& operator=(const LidarLive&) = delete;
    ~LidarLive() override;

    /// Errors: those of read_lidar(); after stop(), kNotFound if no scan had a pose.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

private:
    class State;

    std::shared_ptr<State> state_; ///< shared with the reading coroutines, which may end later
};

} // namespace scanloom::robot
