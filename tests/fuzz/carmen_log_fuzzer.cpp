#include "common/scan/limits.hpp"
#include "tests/fuzz/server_check.hpp"
#include "tests/support/whole_log.hpp"

#include <sys/mman.h>
#include <unistd.h>

namespace {

using namespace scanloom;

/// A file in memory, read by its path.
class MemoryFile {
public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("fuzz.log", 0)) {
        fuzz::check(descriptor_ >= 0 && write(descriptor_, data, size) == static_cast<ssize_t>(size),
                    "the file is written");
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { close(descriptor_); }

    [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
    int descriptor_;
};

} // namespace

/// Input: a CARMEN log, plain or compressed.
SCANLOOM_FUZZER(carmen_log)(const std::uint8_t* data, std::size_t size) {
    const MemoryFile file(data, size);
    robot::CarmenOptions options;
    options.poses = static_cast<Poses>(size % 3);
    options.limits = {.text_bytes_max = 1 << 20, .line_bytes_max = 1 << 16};
    const auto log = robot::read_whole_log(file.path(), options, [](const robot::SkippedLine& line) {
        fuzz::check(!line.reason.empty(), "every skipped line has its reason");
    });
    if (!log) {
        fuzz::check(!log.error().message.empty(), "every error has a message");
        fuzz::check(log.error().code != Errc::kConflict, "both readings of the file agree");
        return 0;
    }
    std::uint64_t seq = 0;
    for (auto observation : log->observations) {
        observation.scan.seq = ++seq;
        fuzz::check_accepted(*observation.sensor);
        fuzz::check_accepted(wire::ScanBatch{{observation.scan}});
        fuzz::check(wire::check_scan(observation.scan, *observation.sensor).has_value(), "a scan fits its sensor");
    }
    return 0;
}
