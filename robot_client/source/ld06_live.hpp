#pragma once

#include "robot_client/source/ld06_capture.hpp"
#include "robot_client/source/ld06_device.hpp"
#include "robot_client/source/ld06_scan.hpp"
#include "robot_client/source/live_source.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace scanloom::robot {

struct Ld06LiveOptions {
    Ld06DeviceOptions device;
    Ld06ScanOptions scan;
    Ld06Poses poses;          ///< those known from the begin; their times are Unix time
    int pose_descriptor = -1; ///< where more poses come from (see pose_feed.hpp), owned from now on; -1: nowhere
    std::chrono::milliseconds pose_wait{500};       ///< a scan waits so long for the pose behind it, if more may come;
    std::chrono::milliseconds pose_age_max{500};    ///< then it takes the newest, if that is no older than this
    std::chrono::milliseconds pose_ahead_max{2000}; ///< a pose that comes may be so far ahead of this machine's clock
};

/// Scans that nobody asked for; of more the oldest are dropped.
inline constexpr std::size_t kScansWaitingMax = 64;

/// An LD06 that is read now: a scan for each turn that has a pose. Stamps are Unix time.
///
/// From the first next() on the sensor and the poses are read all the time, on that executor, whether a scan is asked
/// for or not: what is not fetched from a serial line in time is lost. People are told, once, of poses whose times are
/// more than a minute away from those of the scans.
class Ld06Live final : public LiveSource {
public:
    explicit Ld06Live(Ld06LiveOptions options);
    Ld06Live(const Ld06Live&) = delete;
    Ld06Live& operator=(const Ld06Live&) = delete;
    ~Ld06Live() override;

    /// Errors  those of read_ld06_device(); once it was stopped, kNotFound: not one of the scans had a pose.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

private:
    class State;

    std::shared_ptr<State> state_; ///< shared with what reads: that may end later than this
};

} // namespace scanloom::robot
