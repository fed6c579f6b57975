#include "robot_client/recordings/recording.hpp"

#include "robot_client/recordings/decompression.hpp"
#include "robot_client/recordings/mcap.hpp"
#include "robot_client/recordings/recorded_bytes.hpp"
#include "robot_client/recordings/rosbag.hpp"
#include "robot_client/recordings/rosbag2.hpp"
#include "robot_client/recordings/split_recording.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace scanloom::robot {
namespace {

std::optional<RecordingFormat> format_of_plain(std::string_view first_bytes) {
    if (is_rosbag(first_bytes)) return RecordingFormat::kRosbag;
    if (is_mcap(first_bytes)) return RecordingFormat::kMcap;
    if (is_sqlite(first_bytes)) return RecordingFormat::kRosbag2;
    return std::nullopt;
}

} // namespace

std::optional<RecordingFormat> format_of(std::string_view first_bytes) {
    if (!first_bytes.starts_with(kZstdMagic)) return format_of_plain(first_bytes);
    std::string bytes;
    constexpr std::size_t kShown = 64;
    (void)decompress(Compression::kZstd, first_bytes, kShown, bytes);
    return format_of_plain(bytes);
}

Result<std::unique_ptr<Recording>> open_recording(const std::filesystem::path& path) {
    if (std::error_code unknown; std::filesystem::is_directory(path, unknown)) {
        auto parts = parts_in(path);
        if (!parts) return parts.error();
        return open_parts(std::move(*parts));
    }
    auto file = BytesOfFile::open(path);
    if (!file) return file.error();
    auto first = (*file)->read(0, kFormatBytes);
    if (!first) return first.error();
    if (first->starts_with(kZstdMagic)) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("{}: compressed as a whole with zstd, as rosbag2 does with --compression-mode file; "
                                 "decompress it with `zstd -d`, and name the decompressed file",
                                 path.string())};
    }
    const auto format = format_of_plain(*first);
    if (format == RecordingFormat::kRosbag) return open_rosbag(std::move(*file), path.string());
    if (format == RecordingFormat::kMcap) return open_mcap(std::move(*file), path.string());
    if (format == RecordingFormat::kRosbag2) return open_rosbag2(path);
    return Error{
        Errc::kMalformed,
        fmt::format("{}: not a recording of ROS that can be read; name a ROS 1 bag (.bag), an MCAP file (.mcap) "
                    "or a rosbag2 database (.db3), and decompress a file that gzip or bzip2 has compressed",
                    path.string())};
}

} // namespace scanloom::robot
