#pragma once

#include "common/error/error.hpp"
#include "common/files/file_descriptor.hpp"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <thread>
#include <vector>

namespace scanloom::robot {

/// Returns errno of a failed call as an error that names the file.
/// @param what  e.g. "cannot write"
[[nodiscard]] Error file_error(std::string_view what, const std::filesystem::path& file);

/// Syncs written files to the disk, at most once per second and on its own thread, because an SD card is slow. A killed
/// program loses none of its writes; a power failure may lose the last second or two.
class BackgroundSync {
public:
    using Handle = std::shared_ptr<const FileDescriptor>;
    using Job = std::function<void(const FileDescriptor&)>;

    /// @param sync    function that syncs one file; default: fdatasync
    /// @param period  time between two syncs
    explicit BackgroundSync(Job sync = {}, std::chrono::milliseconds period = std::chrono::seconds(1));

    /// Marks the file as written. It is kept open until it is synced.
    void wrote(const Handle& file);

private:
    void run(const std::stop_token& stop);

    Job sync_;
    std::chrono::milliseconds period_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::vector<Handle> written_; // files not synced yet; an earlier file is never written again
    std::jthread thread_;         // last: it uses the others
};

} // namespace scanloom::robot
