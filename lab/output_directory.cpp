#include "lab/output_directory.hpp"

#include <fmt/format.h>

#include <fstream>

namespace scanloom::lab {

Result<OutputDirectory> OutputDirectory::open(const std::filesystem::path& path) {
    std::error_code failed;
    std::filesystem::create_directories(path, failed);
    if (!failed) return OutputDirectory(path);
    return Error{Errc::kStoreFailed, fmt::format("{}: the directory cannot be created: {}; name another with --out",
                                                 path.string(), failed.message())};
}

Result<> OutputDirectory::write(const std::filesystem::path& file, std::string_view content) const {
    const auto path = path_ / file;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (out) return {};
    return Error{Errc::kStoreFailed,
                 fmt::format("{}: cannot be written; check the free space and the permissions", path.string())};
}

Result<> OutputDirectory::write(const std::filesystem::path& file, std::span<const std::uint8_t> content) const {
    return write(file, std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

} // namespace scanloom::lab
