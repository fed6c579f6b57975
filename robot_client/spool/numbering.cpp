#include "robot_client/spool/numbering.hpp"

#include "robot_client/spool/segment.hpp"
#include "robot_client/spool/synced_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <fstream>

namespace scanloom::robot {
namespace {

constexpr std::string_view kFormat = "scanloom-spool 3";
constexpr std::string_view kFormatWithoutPoses = "scanloom-spool 2"; // as earlier releases wrote it
constexpr std::string_view kNone = "-";                              // stands for an empty text

std::string content_of(const Numbering& numbering, std::string_view format) {
    const std::string_view session = numbering.session_id.empty() ? kNone : std::string_view(numbering.session_id);
    const auto content = fmt::format("{}\n{:<64} {:>20}", format, session, numbering.acknowledged);
    if (format == kFormatWithoutPoses) return content + "\n";
    return fmt::format("{} {:<8}\n", content, numbering.poses ? name_of(*numbering.poses) : kNone);
}

} // namespace

Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::optional<Numbering>{};
    std::ifstream in(file);
    if (!in) return file_error("cannot read", file);
    std::string format;
    std::string poses(kNone);
    Numbering numbering;
    unsigned long sum = 0;
    std::getline(in, format);
    in >> numbering.session_id >> numbering.acknowledged;
    if (format == kFormat) in >> poses;
    in >> sum;
    if (numbering.session_id == kNone) numbering.session_id.clear();
    numbering.poses = find_poses(poses);
    const bool is_known = format == kFormat || format == kFormatWithoutPoses;
    if (!in || !is_known || sum != checksum(content_of(numbering, format))) {
        return Error{Errc::kMalformed, fmt::format("{} is damaged", file.string())};
    }
    return std::optional(numbering);
}

Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering, Sync sync) {
    // Constant size and one block of the disk, so it is never half written.
    const std::string content = content_of(numbering, kFormat);
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
