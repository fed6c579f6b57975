#include "robot_client/spool/segment_list.hpp"

#include "robot_client/spool/segment.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::robot {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kSuffix = ".spool";

Result<std::vector<fs::path>> files_in(const fs::path& directory) {
    std::vector<fs::path> files;
    std::error_code failed;
    for (fs::directory_iterator entry(directory, failed), end; !failed && entry != end; entry.increment(failed)) {
        if (entry->path().extension() == kSuffix) files.push_back(entry->path());
    }
    if (failed) {
        return Error{Errc::kStoreFailed, fmt::format("cannot list {}: {}", directory.string(), failed.message())};
    }
    std::ranges::sort(files);
    return files;
}

/// Counts the scans of a file, up to its end or to damage.
Result<SpoolFile> count(const fs::path& file, const std::function<void(const std::string&)>& tell) {
    auto reader = SegmentReader::open(file);
    if (!reader) return reader.error();
    SpoolFile segment;
    for (;;) {
        const auto record = reader->next();
        if (!record) {
            tell(record.error().message + "; the scans behind that are lost");
            break;
        }
        if (!*record) break;
        const auto* batch = std::get_if<wire::ScanBatch>(&(*record)->message);
        if (batch != nullptr && segment.scans++ == 0) segment.first = batch->scans.front().seq;
    }
    std::error_code ignored;
    segment.bytes = fs::file_size(file, ignored);
    return segment;
}

} // namespace

std::string segment_file(std::uint64_t first) { return fmt::format("{:020}{}", first, kSuffix); }

Result<std::vector<SpoolFile>> segments_left(const fs::path& directory, std::uint64_t first_unacknowledged,
                                             const std::function<void(const std::string&)>& tell) {
    const auto files = files_in(directory);
    if (!files) return files.error();
    std::vector<SpoolFile> left;
    for (const fs::path& file : *files) {
        const auto segment = count(file, tell);
        if (!segment) return segment.error();
        if (segment->scans == 0 || segment->first + segment->scans <= first_unacknowledged) {
            std::error_code ignored;
            fs::remove(file, ignored);
            continue;
        }
        if (file.filename() != segment_file(segment->first)) {
            return Error{Errc::kMalformed, fmt::format("{} holds scans of another file; remove it", file.string())};
        }
        left.push_back(*segment);
    }
    return left;
}

} // namespace scanloom::robot
