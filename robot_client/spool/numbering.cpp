#include "robot_client/spool/numbering.hpp"

#include "robot_client/spool/file_handle.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <fstream>

namespace scanloom::robot {
namespace {

constexpr std::string_view kFormat = "scanloom-spool 2";
constexpr std::string_view kNone = "-"; // in the place of an empty text

std::string_view shown(std::string_view text) { return text.empty() ? kNone : text; }

std::string meant(std::string text) { return text == kNone ? std::string() : text; }

} // namespace

std::string this_boot() {
    std::ifstream in("/proc/sys/kernel/random/boot_id");
    std::string id;
    in >> id;
    return id.substr(0, 36);
}

Result<std::optional<Numbering>> read_numbering(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::optional<Numbering>{};
    std::ifstream in(file);
    if (!in) return file_error("cannot read", file);
    std::string name;
    int version = 0;
    std::string end;
    Numbering numbering;
    in >> name >> version >> numbering.session_id >> numbering.acknowledged >> numbering.boot >> end;
    if (!in || fmt::format("{} {}", name, version) != kFormat || end != "end") {
        return Error{Errc::kMalformed, fmt::format("{} is damaged", file.string())};
    }
    numbering.session_id = meant(std::move(numbering.session_id));
    numbering.boot = meant(std::move(numbering.boot));
    return std::optional(numbering);
}

Result<> write_numbering(const std::filesystem::path& file, const Numbering& numbering, Sync sync) {
    // Of one size and in one block of the disk: it is never half written.
    const std::string text = fmt::format("{}\n{:<64} {:>20} {:<36}\nend\n", kFormat, shown(numbering.session_id),
                                         numbering.acknowledged, shown(numbering.boot));
    const FileHandle handle(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644));
    if (!handle) return file_error("cannot open", file);
    if (::pwrite(handle.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()) ||
        (sync == Sync::kYes && ::fdatasync(handle.get()) != 0)) {
        return file_error("cannot write", file);
    }
    return {};
}

} // namespace scanloom::robot
