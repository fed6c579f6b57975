#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <utility>

namespace scanloom::store {

/// Keeps a file open to detect that its path no longer leads to it: the file was deleted, moved or replaced.
///
/// The file system does not reuse the inode of an open file, so equal device and inode mean the same file.
/// Threads: any, concurrently.
class HeldFile {
public:
    /// @param path  of a file or a directory; must stay valid relative to the working directory
    /// Errors: kNotFound: the path leads to no file; kStoreFailed: the file cannot be opened.
    [[nodiscard]] static Result<HeldFile> open(std::filesystem::path path);

    HeldFile(HeldFile&& other) noexcept
        : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
    HeldFile& operator=(HeldFile&& other) noexcept;
    ~HeldFile();

    /// @return false if the path leads to no file or to another one. Costs two system calls.
    [[nodiscard]] bool is_in_place() const;

private:
    HeldFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

    std::filesystem::path path_;
    int descriptor_; // -1 after a move
};

} // namespace scanloom::store
