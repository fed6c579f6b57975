#pragma once

#include "common/error/error.hpp"

#include <filesystem>
#include <string_view>

namespace scanloom::load {

/// The file of --json. prepare() detects before the run whether it can be written; an earlier report stays until the
/// new one is complete.
class ReportFile {
public:
    /// Creates FILE.part next to the file. A file that is not regular (a pipe, a device) is written directly.
    /// Errors: kStoreFailed: the file cannot be written.
    [[nodiscard]] static Result<ReportFile> prepare(const std::filesystem::path& file);

    ReportFile(ReportFile&& other) noexcept;
    ReportFile& operator=(ReportFile&&) = delete;
    /// Removes FILE.part if no report was written.
    ~ReportFile();

    /// Writes the report. Call once.
    /// Errors: kStoreFailed: the disk is full.
    [[nodiscard]] Result<> write(std::string_view report);

private:
    ReportFile(std::filesystem::path file, std::filesystem::path part);

    std::filesystem::path file_;
    std::filesystem::path part_; // file_ itself if it is not a regular file; empty: nothing to remove
};

} // namespace scanloom::load
