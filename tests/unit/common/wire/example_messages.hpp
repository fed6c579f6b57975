#pragma once

#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <string>

/// Messages with every field set. Tests make single fields invalid.
namespace scanloom::wire {

inline Sensor example_sensor() {
    Sensor sensor;
    sensor.id = 63;
    sensor.kind = SensorKind::kSonar;
    sensor.name = "front, left";
    sensor.mount = {0.25, -0.125, 3.0};
    sensor.angles = UniformAngles{-1.5, 0.015625, 180};
    sensor.aperture = 0.25;
    sensor.range_min = 0.0625;
    sensor.range_max = 81.875;
    return sensor;
}

inline Scan example_scan(std::uint64_t seq = 1) {
    Scan scan;
    scan.seq = seq;
    scan.stamp = 976052857.28;
    scan.duration = -0.1;
    scan.sensor = 63;
    scan.pose = {1.5, -2.25, 0.5};
    scan.odometry = Pose2{-7.0, 8.0, -3.0};
    scan.ranges = {1000, kInvalidRange, kNoReturn};
    scan.intensities = {0, 255, 4'000'000'000U};
    scan.angles = ExplicitAngles{-0.5, 0.0, 0.25};
    return scan;
}

inline ScanBatch example_batch() { return {{example_scan(7), example_scan(8), example_scan(9), example_scan(10)}}; }

/// Returns options in which each field is set to a unique value.
inline SessionOptions every_option() {
    return {.cell_size = 0.1,
            .ray_model = RayModel::kBresenham,
            .accumulate = true,
            .hit_radius = 0.21,
            .drop_no_return = true,
            .p_occupied = 0.8,
            .p_free = 0.2,
            .p_prior = 0.5,
            .p_min = 0.01,
            .p_max = 0.99,
            .obstacle_thickness = 0.25,
            .beam_aperture = 0.125,
            .himm_increment = 5,
            .himm_decrement = 2,
            .himm_obstacle_thickness = 0.3,
            .himm_beam_aperture = 0.0625,
            .sonar_obstacle_thickness = 0.6,
            .sonar_beam_aperture = 0.4,
            .sonar_p_occupied_max = 0.97,
            .sonar_p_min = 0.02,
            .sonar_p_max = 0.98,
            .class_source = ClassSource::kHimm,
            .class_p_occupied = 0.7,
            .class_p_free = 0.3,
            .class_himm_occupied = 9,
            .class_himm_free = 3,
            .danger_cells = 4,
            .danger_radius = 0.35,
            .max_jump = 2.5};
}

inline Hello example_hello() {
    Hello hello;
    hello.robot = "robot-1";
    hello.session = "Intel_Lab";
    hello.token = "secret";
    hello.create = every_option();
    hello.client = "a robot 1.0";
    hello.source = "carmen:" + std::string(57, '9'); // maximum length
    hello.body_radius = 5.0;                         // maximum value
    return hello;
}

inline Path example_path() { return {{{0.5, -1.25}, {2.0, 3.0}, {-1e6, 1e6}}, 7.75, 9.5}; }

inline PlanRequest example_plan_request() {
    return {.id = 0xFEDCBA9876543210U,
            .start = Point2{1.5, -2.5},
            .goal = {-3.25, 4.0},
            .allow_unknown = true,
            .body_radius = 0.25,
            .danger_cost = 3.0};
}

inline GoalRequest example_goal_request() {
    return {.id = 18, .start = Point2{1.5, -2.5}, .body_radius = 0.25, .frontier_size_min = 9};
}

inline Goal example_goal() { return {Exploration::kGoal, example_path(), Point2{-1e6, 1e6}, 17, true}; }

inline LocateRequest example_locate_request() {
    LocateRequest request{20, {}, {0.25, -0.5}, Near{{-1e6, 12.5}, 1000.0}};
    for (std::int32_t n = 0; n < 20; ++n)
        request.points.push_back({n % 2 == 0 ? 1'000'000'000 : -1'000'000'000, 7 * n});
    return request;
}

inline Correction example_correction() {
    return {{1.0, 2.0, -0.5}, 99, 0.875, 0.003, 0.001, LocalizationState::kLost, 0.5};
}

inline CoverageRequest example_coverage_request() {
    return {.id = 19,
            .start = Point2{1.5, -2.5},
            .body_radius = 0.25,
            .spacing = 0.5,
            .region = {{0.0, 0.0}, {4.0, 0.0}, {0.0, 5.0}}};
}

inline Coverage example_coverage() {
    return {example_path(), 12.5, 11.25, {{-3, 7, 2}, {1'000'000, -1'000'000, 1}}, 0.05};
}

/// Returns the body of the frame that contains the message, in the decoder's format.
inline std::string body_of(const Message& message) {
    std::string frame;
    encode(message, frame);
    return frame.substr(kLengthPrefixBytes);
}

} // namespace scanloom::wire
