#pragma once

#include "common/error/error.hpp"

#include <unistd.h>

#include <filesystem>
#include <string_view>
#include <utility>

namespace scanloom::robot {

/// Returns errno of a failed call as an error that names the file.
/// @param what  e.g. "cannot write"
[[nodiscard]] Error file_error(std::string_view what, const std::filesystem::path& file);

/// An open file descriptor, closed on destruction.
class FileHandle {
public:
    FileHandle() = default;
    explicit FileHandle(int descriptor) noexcept : descriptor_(descriptor) {}
    FileHandle(FileHandle&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileHandle() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }

    [[nodiscard]] int get() const noexcept { return descriptor_; }
    explicit operator bool() const noexcept { return descriptor_ >= 0; }

private:
    int descriptor_ = -1;
};

} // namespace scanloom::robot
