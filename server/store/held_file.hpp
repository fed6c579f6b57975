#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <utility>

namespace scanloom::store {

/// A file that is kept open to notice that its path no longer leads to it: it was deleted, moved or replaced.
///
/// The file system does not reuse the inode of an open file, so equal device and inode mean the same file.
/// Thread  any, at the same time.
class HeldFile {
public:
    /// @param path  of a file or a directory; must stay valid relative to the working directory
    /// Errors  kNotFound: the path leads to no file; kStoreFailed: it cannot be opened.
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
    int descriptor_; // or -1, after a move
};

} // namespace scanloom::store
