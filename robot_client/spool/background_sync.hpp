#pragma once

#include "robot_client/spool/file_handle.hpp"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace scanloom::robot {

/// Has the disk keep what was written, once a second at most and on a thread of its own: an SD card takes its time. A
/// killed program loses nothing of what it wrote; of a power cut the last second or two may be lost.
class BackgroundSync {
public:
    using Handle = std::shared_ptr<const FileHandle>;
    using Job = std::function<void(const FileHandle&)>;

    /// @param sync    what asks the disk; fdatasync
    /// @param period  between two times
    explicit BackgroundSync(Job sync = {}, std::chrono::milliseconds period = std::chrono::seconds(1));

    /// Something was written to the file. It is held open until that is synced.
    void wrote(const Handle& file);

private:
    void run(const std::stop_token& stop);

    Job sync_;
    std::chrono::milliseconds period_;
    std::mutex mutex_;
    std::condition_variable_any news_;
    std::vector<Handle> written_; // and not synced yet; nobody goes back to an earlier file
    std::jthread thread_;         // last: it uses the others
};

} // namespace scanloom::robot
