#pragma once

#include "robot_client/sources/ld06_capture.hpp"
#include "robot_client/sources/ld06_device.hpp"
#include "robot_client/sources/ld06_turns.hpp"
#include "robot_client/sources/live_source.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace scanloom::robot {

struct Ld06LiveOptions {
    Ld06DeviceOptions device;
    Ld06ScanOptions scan;
    Ld06Poses poses;          ///< known from the start; their times are Unix time
    int pose_descriptor = -1; ///< source of further poses (see pose_feed.hpp), owned by the reader; -1: none
    std::chrono::milliseconds pose_wait{500};       ///< how long a scan waits for the pose after it, if more may come;
    std::chrono::milliseconds pose_age_max{500};    ///< then it takes the newest pose if that is no older than this
    std::chrono::milliseconds pose_ahead_max{2000}; ///< largest lead of a received pose over this machine's clock
};

/// Most scans that wait for next(); beyond that the oldest are dropped.
inline constexpr std::size_t kScansWaitingMax = 64;

/// An LD06 that is read live: one scan for each turn that has a pose. Stamps are Unix time.
///
/// From the first next() on, the sensor and the poses are read continuously on that executor, whether or not next() is
/// called: bytes that are not read from a serial line in time are lost. Poses whose times are more than a minute away
/// from those of the scans are reported once.
class Ld06Live final : public LiveSource {
public:
    explicit Ld06Live(Ld06LiveOptions options);
    Ld06Live(const Ld06Live&) = delete;
    Ld06Live& operator=(const Ld06Live&) = delete;
    ~Ld06Live() override;

    /// Errors: those of read_ld06_device(); after stop(), kNotFound if no scan had a pose.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

private:
    class State;

    std::shared_ptr<State> state_; ///< shared with the reading coroutines, which may end later
};

} // namespace scanloom::robot
