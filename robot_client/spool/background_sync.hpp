#pragma once

#include "robot_client/spool/file_handle.hpp"

#include <boost/asio/thread_pool.hpp>

#include <atomic>
#include <chrono>

namespace scanloom::robot {

/// Has the disk keep what was written, once a second at most and on a thread of its own: an SD card takes its time. A
/// killed program loses nothing of what it wrote; of a power cut the last second or two may be lost.
class BackgroundSync {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds kPeriod{1};

    ~BackgroundSync() { thread_.join(); }

    /// Something was written to the file. Thread: one.
    void wrote(const FileHandle& file, Time now);

private:
    boost::asio::thread_pool thread_{1};
    std::atomic<bool> busy_ = false;
    Time next_{};
};

} // namespace scanloom::robot
