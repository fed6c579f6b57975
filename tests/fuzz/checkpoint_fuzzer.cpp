#include "core/mapping/map_config.hpp"
#include "server/sessions/checkpoint.hpp"
#include "server/sessions/checkpoint_reader.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace {

/// Removes the next string from the input: two bytes of length, little-endian, then that many bytes, or fewer at the
/// end.
std::string_view take_text(std::string_view& input) {
    const auto byte = [&](std::size_t at) {
        return at < input.size() ? std::size_t{static_cast<unsigned char>(input[at])} : 0;
    };
    const std::size_t length = byte(0) | byte(1) << 8;
    input.remove_prefix(std::min<std::size_t>(2, input.size()));
    const auto text = input.substr(0, length);
    input.remove_prefix(text.size());
    return text;
}

} // namespace

/// Input: key, value, key, value ... of a checkpoint's parts.
SCANLOOM_FUZZER(checkpoint)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    std::string_view input(reinterpret_cast<const char*>(data), size);
    sessions::CheckpointReader reader{mapping::MapConfig{}};
    while (!input.empty()) {
        const auto key = take_text(input);
        const auto value = take_text(input);
        if (const auto added = reader.add(key, value); !added) {
            fuzz::check(!added.error().message.empty(), "every error has a message");
            return 0;
        }
    }
    // Maps that were accepted can be read and written again.
    auto maps = std::move(reader).finish();
    if (!maps) return 0;
    auto& projection = maps->projection();
    store::MemoryScanLog log;
    const auto id = log.create_session("s").value();
    const auto written = sessions::write_checkpoint(log, id, projection.snapshot(), projection.state(), 0, false,
                                                    sessions::estimation_to_store(*maps));
    fuzz::check(written.has_value(), "a checkpoint that was read can be written");
    return 0;
}
