#include "robot_client/spool/numbering.hpp"

#include "robot_client/spool/file_handle.hpp"
#include "robot_client/spool/segment.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <fstream>

namespace scanloom::robot {
namespace {

constexpr std::string_view kFormat = "scanloom-spool 1";

} // namespace

Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::optional<Numbering>{};
    std::ifstream in(file);
    if (!in) return file_error("cannot read", file);
    std::string name;
    int version = 0;
    std::string end;
    Numbering numbering;
    in >> name >> version >> numbering.session_id >> numbering.first >> numbering.seq >> numbering.entered >> end;
    if (!in || fmt::format("{} {}", name, version) != kFormat || end != "end") {
        return Error{
            Errc::kMalformed,
            fmt::format("{} is damaged; remove the directory to go on without the scans in it", file.string())};
    }
    return std::optional(numbering);
}

Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering) {
    // Of one size and in one block of the disk: it is never half written, and needs no room on a full one.
    const std::string text = fmt::format("{}\n{:<64} {:>20} {:>20} {:>20}\nend\n", kFormat, numbering.session_id,
                                         numbering.first, numbering.seq, numbering.entered);
    const FileHandle handle(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
    if (!handle) return file_error("cannot open", file);
    if (::pwrite(handle.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        ::fdatasync(handle.get()) != 0) {
        return file_error("cannot write", file);
    }
    return {};
}

} // namespace scanloom::robot
