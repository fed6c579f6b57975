#include "robot_client/spool/file_handle.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace scanloom::robot {

Error file_error(std::string_view what, const std::filesystem::path& file) {
    return {Errc::kStoreFailed, fmt::format("{} {}: {}", what, file.string(), std::strerror(errno))};
}

} // namespace scanloom::robot
