#include "server/store/synced_files.hpp"

#include "server/store/failure.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::store {
namespace {

namespace fs = std::filesystem;

std::string last_system_error() { return std::system_category().message(errno); }

Result<> sync(const fs::path& path, int flags, std::string_view what) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
    if (file < 0) return failure("cannot open the {} {}: {}", what, path.native(), last_system_error());
    const bool synced = ::fsync(file) == 0;
    const std::string problem = synced ? "" : last_system_error();
    ::close(file);
    if (!synced) return failure("cannot sync the {} {}: {}", what, path.native(), problem);
    return {};
}

} // namespace

Result<> sync_directory(const fs::path& directory) { return sync(directory, O_DIRECTORY, "directory"); }

Result<> sync_file(const fs::path& file) { return sync(file, 0, "file"); }

Result<> create_store_directory(const fs::path& directory) {
    std::error_code problem;
    const auto kind = fs::status(directory, problem).type();
    if (kind == fs::file_type::directory) return {};
    if (kind != fs::file_type::not_found && kind != fs::file_type::none) {
        return failure("the store {} is not a directory; name a directory of its own", directory.native());
    }
    fs::create_directories(directory, problem);
    if (problem) return failure("cannot create the store {}: {}", directory.native(), problem.message());
    for (auto made = fs::absolute(directory).lexically_normal(); made.has_relative_path(); made = made.parent_path()) {
        // All of these directories may be new, except those near the root that this process cannot open.
        if (::access(made.parent_path().c_str(), R_OK) != 0) break;
        if (auto synced = sync_directory(made.parent_path()); !synced) return synced;
    }
    return {};
}

Result<> write_mark(const fs::path& file, std::string_view sentence) {
    std::ofstream out(file, std::ios::binary);
    out << sentence << '\n';
    out.close();
    if (!out) return failure("cannot write {}; is there room on its disk?", file.native());
    if (auto synced = sync_file(file); !synced) return synced;
    return sync_directory(file.parent_path());
}

Result<> remove_mark(const fs::path& file) {
    std::error_code problem;
    if (!fs::remove(file, problem) && !problem) return {}; // it did not exist
    if (problem) return failure("cannot remove {}: {}", file.native(), problem.message());
    return sync_directory(file.parent_path());
}

} // namespace scanloom::store
