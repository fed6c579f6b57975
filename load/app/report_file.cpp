#include "load/app/report_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

namespace scanloom::load {

namespace fs = std::filesystem;

namespace {

Error cannot_write(const fs::path& file, int why) {
    return {Errc::kStoreFailed,
            fmt::format("--json: {} cannot be written: {}", file.string(), std::generic_category().message(why))};
}

} // namespace

ReportFile::ReportFile(fs::path file, fs::path part) : file_(std::move(file)), part_(std::move(part)) {}

ReportFile::ReportFile(ReportFile&& other) noexcept
    : file_(std::move(other.file_)), part_(std::exchange(other.part_, {})) {}

ReportFile::~ReportFile() {
    std::error_code ignored;
    if (part_ != file_ && !part_.empty()) fs::remove(part_, ignored);
}

Result<ReportFile> ReportFile::prepare(const fs::path& file) {
    std::error_code unknown;
    if (fs::is_directory(file, unknown)) return cannot_write(file, EISDIR);
    const bool is_special = fs::exists(file, unknown) && !fs::is_regular_file(file, unknown);
    if (is_special) return ReportFile(file, file);
    auto target = fs::is_symlink(file, unknown) ? fs::weakly_canonical(file, unknown) : file; // keeps a symbolic link
    auto part = fs::path(target.string() + ".part");
    const std::ofstream made(part, std::ios::binary);
    if (!made) return cannot_write(part, errno);
    return ReportFile(std::move(target), std::move(part));
}

Result<> ReportFile::write(std::string_view report) {
    std::ofstream out(part_, std::ios::binary);
    out << report << std::flush;
    if (!out) return cannot_write(part_, errno);
    out.close();
    if (part_ == file_) return {};
    std::error_code failed;
    fs::rename(part_, file_, failed);
    if (failed) return cannot_write(file_, failed.value());
    part_.clear();
    return {};
}

} // namespace scanloom::load
