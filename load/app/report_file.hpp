#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string_view>

namespace scanloom::load {

/// The file of --json. That it can be written is known before the run; until the report is whole, an earlier one stays.
class ReportFile {
public:
    /// Makes a file beside it, FILE.part, unless it is no regular file (a pipe, a device): that is written as it is.
    /// Errors  kStoreFailed.
    [[nodiscard]] static Result<ReportFile> prepare(const std::filesystem::path& file);

    ReportFile(ReportFile&& other) noexcept;
    ReportFile& operator=(ReportFile&&) = delete;
    /// Of a run without a report nothing is left.
    ~ReportFile();

    /// Call once. Errors  kStoreFailed: the disk is full.
    [[nodiscard]] Result<> write(std::string_view report);

private:
    ReportFile(std::filesystem::path file, std::filesystem::path part);

    std::filesystem::path file_;
    std::filesystem::path part_; // file_ itself where it is no regular file; empty: nothing is to be removed
};

} // namespace scanloom::load
