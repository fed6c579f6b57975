#include "server/store/log_file.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

/// Input: a log file. The seeds have valid checksums; the fuzzer breaks them.
SCANLOOM_FUZZER(log_file)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const auto found = store::check_log_file(bytes);
    fuzz::check(found.whole_bytes <= size, "complete writes end within the file");
    fuzz::check(!found.damage || (*found.damage >= found.whole_bytes && *found.damage < size),
                "damage is after the last complete write, within the file");

    const auto kept = store::check_log_file(bytes.substr(0, found.whole_bytes));
    fuzz::check(!kept.damage && kept.whole_bytes == found.whole_bytes, "the complete writes alone are a valid file");

    const auto writes = store::whole_writes_of(bytes);
    const auto first = store::whole_writes_of(bytes.substr(0, found.whole_bytes));
    fuzz::check(first.size() <= writes.size() && std::equal(first.begin(), first.end(), writes.begin()),
                "bytes after the complete writes do not change them");
    return 0;
}
