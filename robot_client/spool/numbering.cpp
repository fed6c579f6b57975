#include "robot_client/spool/numbering.hpp"

#include "robot_client/spool/segment.hpp"
#include "robot_client/spool/synced_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <fstream>

namespace scanloom::robot {
namespace {

constexpr std::string_view kFormat = "scanloom-spool 2";
constexpr std::string_view kNone = "-"; // stands for an empty text

std::string content_of(const Numbering& numbering) {
    const std::string_view session = numbering.session_id.empty() ? kNone : std::string_view(numbering.session_id);
    return fmt::format("{}\n{:<64} {:>20}\n", kFormat, session, numbering.acknowledged);
}

} // namespace

Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::optional<Numbering>{};
    std::ifstream in(file);
    if (!in) return file_error("cannot read", file);
    std::string name;
    std::string version;
    Numbering numbering;
    unsigned long sum = 0;
    in >> name >> version >> numbering.session_id >> numbering.acknowledged >> sum;
    if (numbering.session_id == kNone) numbering.session_id.clear();
    if (!in || fmt::format("{} {}", name, version) != kFormat || sum != checksum(content_of(numbering))) {
        return Error{Errc::kMalformed, fmt::format("{} is damaged", file.string())};
    }
    return std::optional(numbering);
}

Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering, Sync sync) {
    // Constant size and one block of the disk, so it is never half written.
    const std::string content = content_of(numbering);
    const std::string text = fmt::format("{}{:>10}\n", content, checksum(content));
    const FileDescriptor handle(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
    if (!handle) return file_error("cannot open", file);
    if (::pwrite(handle.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        (sync == Sync::kYes && ::fdatasync(handle.get()) != 0)) {
        return file_error("cannot write", file);
    }
    return {};
}

} // namespace scanloom::robot
