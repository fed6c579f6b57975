#include "robot_client/spool/synced_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include <unistd.h>

namespace scanloom::robot {

Error file_error(std::string_view what, const std::filesystem::path& file) {
    return {Errc::kStoreFailed, fmt::format("{} {}: {}", what, file.string(), std::strerror(errno))};
}

BackgroundSync::BackgroundSync(Job sync, std::chrono::milliseconds period)
    : sync_(std::move(sync)), period_(period), thread_([this](const std::stop_token& stop) { run(stop); }) {
    if (!sync_) sync_ = [](const FileDescriptor& file) { ::fdatasync(file.get()); }; // the next write reports failures
}

void BackgroundSync::wrote(const Handle& file) {
    const std::lock_guard lock(mutex_);
    if (!written_.empty() && written_.back() == file) return;
    written_.push_back(file);
    changed_.notify_one();
}

/// Runs until it is stopped and everything is synced.
void BackgroundSync::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, stop, [&] { return !written_.empty(); });
        if (written_.empty()) return;
        const auto files = std::exchange(written_, {});
        lock.unlock();
        for (const auto& file : files) sync_(*file);
        lock.lock();
        changed_.wait_for(lock, stop, period_, [] { return false; });
    }
}

} // namespace scanloom::robot
