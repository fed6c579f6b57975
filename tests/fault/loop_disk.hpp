#pragma once

#include "common/error/error.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace scanloom::fault {

inline constexpr std::uint64_t kDiskBytes = std::uint64_t{128} << 20; ///< size of the rows' disks

/// An ext4 file system in a file on a loop device, which can lose power and can be full.
class LoopDisk {
public:
    /// Creates the file system and mounts it at `mount_point`, which is created.
    /// Errors  kUnreachable: the user is not root, there are no loop devices, or a program is missing.
    [[nodiscard]] static Result<std::unique_ptr<LoopDisk>>
    make(const std::filesystem::path& image, const std::filesystem::path& mount_point, std::uint64_t bytes);
    ~LoopDisk();
    LoopDisk(const LoopDisk&) = delete;
    LoopDisk& operator=(const LoopDisk&) = delete;

    /// Discards all data that was not synced. Every further access fails until mount_again(). Throws.
    void cut_power() const;

    /// Blocks all writes and syncs while the returned object exists. Throws.
    [[nodiscard]] std::shared_ptr<const void> freeze() const;

    /// Unmounts and mounts the file system again, which replays its journal. Pre: none of its files is open. Throws.
    void mount_again();

private:
    LoopDisk(std::string device, std::filesystem::path mount_point)
        : device_(std::move(device)), mount_point_(std::move(mount_point)) {}

    [[nodiscard]] Result<> mount();
    void control(unsigned long what, void* how, const char* name) const;

    std::string device_; // "/dev/loop0"
    std::filesystem::path mount_point_;
    bool is_mounted_ = false;
};

} // namespace scanloom::fault
