#include "robot_client/app/lidar_options.hpp"

#include "common/app/command_line.hpp"
#include "common/net/connect.hpp"
#include "common/scan/limits.hpp"
#include "robot_client/app/pose_text.hpp"
#include "robot_client/lidars/lidar_models.hpp"
#include "robot_client/sources/stationary_detector.hpp"
#include "robot_client/uplink/limits.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

namespace scanloom::robot {
namespace {

Result<wire::Near> parse_near(const std::string& text) {
    const auto numbers = parse_three_numbers(text, "X,Y,RADIUS in metres");
    if (!numbers) return numbers.error();
    const auto [x, y, radius] = *numbers;
    if (auto ok = check_place(x, y); !ok) return ok.error();
    if (radius >= kNearRadiusMin && radius <= kNearRadiusMax) return wire::Near{{x, y}, radius};
    return Error{Errc::kInvalidField, fmt::format("the radius {:g} m is out of range: {:g} to {:g}", radius,
                                                  kNearRadiusMin, kNearRadiusMax)};
}

constexpr unsigned kBaudMin = 1'200;
constexpr unsigned kBaudMax = 4'000'000;

std::string check_window(const std::string& text) {
    int window = 0;
    if (CLI::detail::lexical_cast(text, window) && window % 2 == 1 && window >= kMedianWindowMin &&
        window <= kMedianWindowMax) {
        return {};
    }
    return fmt::format("'{}' is not an odd number from {} to {}", text, kMedianWindowMin, kMedianWindowMax);
}

std::string check_confidence(const std::string& text) {
    int confidence = 0;
    if (CLI::detail::lexical_cast(text, confidence) && confidence >= 0 && confidence <= 255) return {};
    return fmt::format("'{}' is not a whole number from 0 to 255", text);
}

/// Adds the options that devices of both subcommands have.
void add_device_options(CLI::App& lidar, LidarOptions& options) {
    lidar.add_option("--pose-file", options.pose_file,
                     "File of lines: t x y yaw, '-' = stdin: poses in the map, or odometry with --poses odometry. t is "
                     "seconds since the first packet for a file, and Unix time for a "
                     "device. Poses are interpolated; scans before the first and after the last line are skipped");
    add_parsed(lidar, "--mount", options.mount,
               "X,Y,YAW of the sensor on the robot; its 0 degrees are its x axis. Default: 0,0,0", parse_pose);
    lidar.add_option("--min-range", options.range_min, "Metres; shorter readings are invalid. Default: the model's")
        ->check(check_within(0.0, kRangeMax));
    lidar
        .add_option(
            "--min-confidence", options.confidence_min,
            "0 to 255, for sensors that state one; readings below are invalid. Default: the model's, 100 for LD06")
        ->check(check_confidence);
    lidar
        .add_option("--median", options.median_window,
                    "Beams; each reading becomes the median of this many neighbours. Odd, 3 to 101; from about 15 "
                    "corners are rounded. Default: off")
        ->check(check_window);
    lidar.add_option("--baud", options.baud, "Rate of the serial device. Default: the model's")
        ->check(CLI::Range(kBaudMin, kBaudMax));
    add_checked(lidar, "--reopen-for", options.reopen_for,
                "Seconds during which a lost device is reopened; 0 = not at all", check_within(0.0, 1e6));
}

bool is_wrong_address(const std::string& input) {
    return input.starts_with(kTcpScheme) && !net::parse_address(input.substr(kTcpScheme.size()));
}

std::string known_models() {
    std::vector<std::string_view> names;
    std::ranges::transform(lidar_models(), std::back_inserter(names), &LidarModel::name);
    return fmt::format("{}", fmt::join(names, ", "));
}

void add_locating(CLI::App& ld06, LidarOptions& options) {
    ld06.add_flag(
        "--locate", options.locate,
        "Deprecated, until 0.4: use --poses none. For a lidar that is carried from place to place: the server "
        "localizes it where it stands. Scans taken while it moves are dropped. Each run sends a capture file "
        "again");
    add_parsed(ld06, "--near", options.near,
               "X,Y,RADIUS in metres, with --locate: the maximum distance of the first place from X,Y along each axis; "
               "later places are at most 100 m apart. Default: anywhere in the map",
               parse_near);
}

/// Returns why the options for the robot's place are invalid, or an empty string.
std::string complaint_about_places(const LidarOptions& options, Poses poses) {
    if (options.near && !options.locate) return "ld06: --near needs --locate; give both, or neither";
    if (options.locate && poses != Poses::kMap) {
        return fmt::format("ld06: --locate sends poses in the map, and --poses {} sends none; leave one of them out",
                           name_of(poses));
    }
    if (options.locate && !options.pose_file.empty()) {
        return "ld06: --locate requests the pose from the server, and --pose-file states it; leave one of them out";
    }
    if (options.locate && options.speed > 0.0) {
        return "ld06: with --locate a capture file is read as fast as the server accepts scans; leave --speed out";
    }
    if (poses == Poses::kNone && (options.pose || !options.pose_file.empty())) {
        return fmt::format("{}: with --poses none no poses are sent; leave --pose and --pose-file out",
                           options.command());
    }
    if (poses == Poses::kOdometry && (options.pose || options.pose_file.empty())) {
        return fmt::format(
            "{}: --poses odometry needs the odometry; give it with --pose-file FILE, and leave --pose out",
            options.command());
    }
    if (poses == Poses::kMap && !options.locate && options.pose.has_value() != options.pose_file.empty()) {
        return fmt::format("{}: state the robot's pose with --pose X,Y,YAW or --pose-file FILE, {}", options.command(),
                           options.is_ld06_command ? "let the server estimate it with --poses none, or let the server "
                                                     "determine it with --locate"
                                                   : "or let the server estimate it with --poses none");
    }
    return {};
}

} // namespace

CLI::App* add_ld06(CLI::App& app, LidarOptions& options) {
    options.is_ld06_command = true;
    options.model = "ld06";
    auto* ld06 = app.add_subcommand("ld06", "Read an LD06 or LD19 lidar, or a file with its bytes");
    ld06->add_option("INPUT", options.input, "Serial device (/dev/ttyUSB0), tcp://HOST:PORT (ser2net), or capture file")
        ->configurable(false);
    add_parsed(
        *ld06, "--pose", options.pose,
        "X,Y,YAW of a stationary robot: metres, and radians counter-clockwise. With --locate: its first pose, used "
        "if no map exists yet; default then: 0,0,0",
        parse_pose);
    add_device_options(*ld06, options);
    add_locating(*ld06, options);
    add_checked(*ld06, "--speed", options.speed,
                "For a capture file: 1 = as recorded, 0 = as fast as the server accepts scans", check_not_negative);
    return ld06;
}

CLI::App* add_lidar(CLI::App& app, LidarOptions& options) {
    auto* lidar = app.add_subcommand("lidar", "Read a lidar: " + known_models());
    lidar->add_option("MODEL", options.model, "One of these models; scanloom-robot lidars lists what is plugged in")
        ->configurable(false);
    lidar
        ->add_option("DEVICE", options.input,
                     "Serial device (/dev/ttyUSB0), or tcp://HOST:PORT (the lidar, or ser2net)")
        ->configurable(false);
    add_parsed(*lidar, "--pose", options.pose, "X,Y,YAW of a stationary robot: metres, and radians counter-clockwise",
               parse_pose);
    add_device_options(*lidar, options);
    return lidar;
}

CLI::App* add_lidars(CLI::App& app, LidarsOptions& options) {
    auto* lidars = app.add_subcommand("lidars", "List which lidars are plugged in, and the commands that read them");
    lidars
        ->add_option("DEVICE", options.devices,
                     "Serial devices, or tcp://HOST:PORT. Default: all serial devices of USB adapters. Each is asked "
                     "what it is, which stops a measurement: name none that is in use")
        ->configurable(false);
    add_checked(*lidars, "--wait", options.wait, "Seconds that each kind of lidar has to answer",
                check_within(0.01, 60.0));
    return lidars;
}

std::string complaint_about(const LidarsOptions& options) {
    for (const auto& device : options.devices) {
        if (is_wrong_address(device)) return fmt::format("lidars: '{}' is not tcp://HOST:PORT", device);
    }
    return {};
}

std::string complaint_about(const LidarOptions& options, Poses poses) {
    if (!options.is_ld06_command) {
        if (options.model.empty() || options.input.empty()) {
            return "lidar: name the MODEL and the DEVICE: a serial device, or tcp://HOST:PORT";
        }
        if (find_lidar_model(options.model) == nullptr) {
            return fmt::format("lidar: '{}' is not one of the models: {}", options.model, known_models());
        }
    }
    if (options.input.empty()) return "ld06: name the INPUT: a serial device, tcp://HOST:PORT, or a capture file";
    if (is_wrong_address(options.input)) {
        return fmt::format("{}: '{}' is not tcp://HOST:PORT", options.command(), options.input);
    }
    return complaint_about_places(options, poses);
}

} // namespace scanloom::robot
