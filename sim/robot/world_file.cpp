#include "sim/robot/world_file.hpp"

#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "sim/map_world.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

namespace scanloom::sim {
namespace {

namespace fs = std::filesystem;

/// Size of a plain image with the most pixels, six characters each, and its comments.
constexpr std::uintmax_t kFileBytesMax = 7 * static_cast<std::uintmax_t>(kRosImagePixelsMax);

Error about(const fs::path& path, const Error& error) { return prefixed(path.string() + ": ", error); }

Result<std::string> content_of(const fs::path& path) {
    std::error_code failed;
    if (!fs::is_regular_file(path, failed)) {
        return Error{Errc::kNotFound, fmt::format("{}: no such file", path.string())};
    }
    const auto size = fs::file_size(path, failed);
    if (!failed && size > kFileBytesMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("{}: the file has {} bytes, more than {}", path.string(), size, kFileBytesMax)};
    }
    std::ifstream file(path, std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(file), {}};
    if (!file.bad() && file.is_open()) return content;
    return Error{Errc::kNotFound, fmt::format("{}: the file cannot be read", path.string())};
}

Result<World> load_map(const fs::path& yaml) {
    const auto text = content_of(yaml);
    if (!text) return text.error();
    const auto description = parse_ros_yaml(*text);
    if (!description) return about(yaml, description.error());
    if (description->image.empty()) {
        return about(yaml, {Errc::kInvalidField, "the map's yaml: image is missing; it names the file of the map"});
    }
    const fs::path image = yaml.parent_path() / description->image; // an absolute path stays as it is
    const auto file = content_of(image);
    if (!file) return file.error();
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(file->data()), file->size());
    const auto cells = read_ros_pgm(*description, bytes);
    if (!cells) return about(image, cells.error());
    auto world = world_of_map(yaml.stem().string(), *description, *cells);
    if (!world) return about(image, world.error());
    return world;
}

} // namespace

bool is_world_file(std::string_view world) { return world.ends_with(".yaml") || world.ends_with(".yml"); }

std::string check_world(const std::string& world) {
    if (is_world_file(world)) return {};
    const auto found = find_world(world);
    return found ? "" : found.error().message + ", or the .yaml file of a ROS map";
}

Result<World> load_world(const std::string& world) {
    return is_world_file(world) ? load_map(world) : find_world(world);
}

} // namespace scanloom::sim
