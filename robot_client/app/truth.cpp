#include "robot_client/app/truth.hpp"

#include "common/app/standard_streams.hpp"
#include "common/ros_map/pgm.hpp"
#include "sim/ground_truth.hpp"
#include "sim/robot/world_file.hpp"

#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <span>

namespace scanloom::robot {
namespace {

/// Creates the folder of the files.
/// Errors: kStoreFailed if it cannot be created.
Result<> make_folder(const std::string& prefix) {
    const auto folder = std::filesystem::path(prefix).parent_path();
    std::error_code failed;
    if (!folder.empty()) std::filesystem::create_directories(folder, failed);
    if (!failed) return {};
    return Error{Errc::kStoreFailed, fmt::format("{}: the folder cannot be created ({}); give another --output",
                                                 folder.string(), failed.message())};
}

Result<> write_file(const std::string& path, std::span<const char> content) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (file) return {};
    return Error{Errc::kStoreFailed,
                 fmt::format("{}: the file cannot be written; free space on the disk, or give another --output", path)};
}

/// Called before memory is allocated for the cells.
Result<> check_size(const sim::World& world, double cell_size) {
    const sim::Box box = bounds_of(world);
    const double cells = (box.x_max - box.x_min) / cell_size * ((box.y_max - box.y_min) / cell_size);
    if (cells <= static_cast<double>(kRosImagePixelsMax)) return {};
    return Error{Errc::kTooLarge,
                 fmt::format("the world has {:.0f} cells of {} m, more than {}; use a larger --cell-size", cells,
                             cell_size, kRosImagePixelsMax)};
}

} // namespace

Result<std::string> write_ground_truth(const GroundTruthOptions& options) {
    const auto world = sim::load_world(options.world);
    if (!world) return world.error();
    if (auto ok = check_size(*world, options.cell_size); !ok) return ok.error();
    if (auto made = make_folder(options.output); !made) return made.error();
    const sim::GroundTruthGrid truth = ground_truth_of(*world, options.cell_size);
    const std::string image = options.output + ".pgm";
    const std::string yaml = options.output + ".yaml";
    const auto pgm = ground_truth_pgm(truth);
    const std::span pixels(reinterpret_cast<const char*>(pgm.data()), pgm.size());
    if (auto written = write_file(image, pixels); !written) return written.error();
    const std::string description = ground_truth_yaml(truth, std::filesystem::path(image).filename().string());
    if (auto written = write_file(yaml, description); !written) return written.error();
    return fmt::format(R"({{"width":{},"height":{},"map":{}}})", truth.width, truth.height,
                       boost::json::serialize(yaml));
}

ExitCode run(const GroundTruthOptions& options) {
    const auto line = write_ground_truth(options);
    if (!line) {
        Console(standard_error()).note("scanloom-robot: " + line.error().message);
        return kExitFailed;
    }
    fmt::print("{}\n", *line);
    return kExitDone;
}

} // namespace scanloom::robot
