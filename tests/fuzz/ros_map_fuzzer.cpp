#include "server/tiles/ros_map_import.hpp"
#include "tests/fuzz/check.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>

/// Input: the YAML of a map, a zero byte, its image.
SCANLOOM_FUZZER(ros_map)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    const std::string_view input(reinterpret_cast<const char*>(data), size);
    const auto yaml = input.substr(0, input.find('\0'));
    const auto image = std::span(data, size).subspan(std::min(size, yaml.size() + 1));
    const auto description = parse_ros_yaml(yaml);
    if (!description) {
        fuzz::check(!description.error().message.empty(), "every error has a message");
        return 0;
    }
    const auto patches = tiles::read_ros_image(*description, image);
    if (!patches) return 0;
    for (const auto& patch : *patches) {
        fuzz::check(patch.width > 0 && patch.cells.size() % patch.width == 0, "patches consist of complete rows");
        fuzz::check(patch.cells.size() <= kMapPatchCellsMax, "patches are bounded");
    }
    return 0;
}
