#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <span>
#include <string_view>

namespace scanloom::lab {

/// A directory that results are written to.
class OutputDirectory {
public:
    /// Makes it, and its parents, if it does not exist.
    /// Errors  kStoreFailed: it cannot be made.
    [[nodiscard]] static Result<OutputDirectory> open(const std::filesystem::path& path);

    /// Writes a file, over an older one of that name.
    /// Errors  kStoreFailed: not all of it could be written.
    [[nodiscard]] Result<> write(const std::filesystem::path& file, std::string_view content) const;
    [[nodiscard]] Result<> write(const std::filesystem::path& file, std::span<const std::uint8_t> content) const;

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    explicit OutputDirectory(std::filesystem::path path) : path_(std::move(path)) {}

    std::filesystem::path path_;
};

} // namespace scanloom::lab
