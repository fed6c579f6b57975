#pragma once

#include <utility>

#include <unistd.h>

namespace scanloom {

/// Owns a file descriptor of the operating system: a file, a directory or a socket. Closes it on destruction.
class FileDescriptor {
public:
    FileDescriptor() = default;

    /// @param descriptor  as open(2) or socket(2) returned it; negative: none
    explicit FileDescriptor(int descriptor) noexcept : descriptor_(descriptor) {}

    FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileDescriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }

    /// Returns the descriptor for system calls; negative if there is none.
    [[nodiscard]] int get() const noexcept { return descriptor_; }
    explicit operator bool() const noexcept { return descriptor_ >= 0; }

private:
    int descriptor_ = -1;
};

} // namespace scanloom
