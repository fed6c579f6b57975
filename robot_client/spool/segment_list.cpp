#include "robot_client/spool/segment_list.hpp"

#include "robot_client/spool/segment.hpp"

#include <fmt/format.h>

#include <optional>

namespace scanloom::robot {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kSuffix = ".spool";
constexpr std::string_view kSetAside = ".unreadable"; ///< suffix of the name

using Report = std::function<void(const std::string&)>;

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

/// Renames a file so that it is not read again but a person can still examine it.
void set_aside(const fs::path& file, const std::string& why, const Report& report) {
    std::error_code failed;
    fs::path aside = file.string() + std::string(kSetAside);
    for (int n = 2; fs::exists(aside, failed); ++n) aside = fmt::format("{}{}.{}", file.string(), kSetAside, n);
    fs::rename(file, aside, failed);
    report(fmt::format("{}; it is skipped{}", why, failed ? "" : ", as " + aside.filename().string()));
}

/// Counts the scans of a file, up to its end or to damage.
/// Errors: kMalformed, kStoreFailed.
Result<SpoolFile> count(const fs::path& file, const Report& report) {
    auto reader = SegmentReader::open(file);
    if (!reader) return reader.error();
    SpoolFile segment;
    for (;;) {
        const auto record = reader->next();
        if (!record && segment.scans == 0 && reader->sent_as()) return record.error();
        if (!record && segment.scans > 0) report(record.error().message + "; later scans cannot be read");
        if (!record || !*record) break;
        const auto* batch = std::get_if<wire::ScanBatch>(&(*record)->message);
        if (batch == nullptr) continue;
        const std::uint64_t number = batch->scans.front().seq;
        if (segment.scans == 0) segment.first = number;
        if (number != segment.end()) {
            report(fmt::format("{} lacks scan {}; later scans are skipped", file.string(), segment.end()));
            break;
        }
        ++segment.scans;
    }
    segment.is_headless = !reader->sent_as();
    if (segment.is_headless && segment.scans == 0) {
        return Error{Errc::kMalformed, fmt::format("{} is not a spool file", file.string())};
    }
    const SentAs sent = reader->sent_as().value_or(SentAs{});
    segment.from = std::clamp(sent.from, segment.first, segment.end());
    segment.seq = sent.seq;
    std::error_code ignored;
    segment.bytes = fs::file_size(file, ignored);
    return segment;
}

/// Returns whether a file is shorter than a head, because of a power failure.
bool is_cut_short(const fs::path& file) {
    std::error_code failed;
    const auto bytes = fs::file_size(file, failed);
    return !failed && bytes < kSegmentHeadBytes;
}

} // namespace

std::string segment_file(std::uint64_t first) { return fmt::format("{:020}{}", first, kSuffix); }

Result<std::vector<SpoolFile>> segments_left(const fs::path& directory, const Report& report) {
    const auto files = files_in(directory);
    if (!files) return files.error();
    std::vector<SpoolFile> left;
    for (const fs::path& file : *files) {
        const auto segment = is_cut_short(file) ? Result<SpoolFile>(SpoolFile{}) : count(file, report);
        if (!segment && segment.error().code == Errc::kStoreFailed) return segment.error();
        if (!segment) {
            set_aside(file, segment.error().message, report);
        } else if (segment->scans == 0) {
            std::error_code ignored;
            fs::remove(file, ignored);
        } else if (file.filename() != segment_file(segment->first)) {
            set_aside(file, fmt::format("{} contains the scans of another file", file.string()), report);
        } else {
            left.push_back(*segment);
        }
    }
    return left;
}

} // namespace scanloom::robot
