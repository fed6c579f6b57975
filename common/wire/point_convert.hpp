#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/geometry/pose2.hpp"

#include "scanloom/v1/frame.pb.h"

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <span>
#include <string_view>

/// What requests and replies of all kinds are made of, between protobuf and values.
/// The checks name the field as they are told it is called.
namespace scanloom::wire {

/// Finite, and within kCoordinateMax.
[[nodiscard]] Result<> check_coordinate(std::string_view field, double metres);
[[nodiscard]] Result<> check(std::string_view field, const v1::Point& point);

/// Of lengths, costs and areas: finite, and not negative.
[[nodiscard]] Result<> check_size(std::string_view field, double size);

[[nodiscard]] Point2 value_of(const v1::Point& point);
[[nodiscard]] Error value_of(const v1::Refusal& refusal);

/// Of a reply that says neither what was found nor why nothing was.
[[nodiscard]] Error without_outcome();

/// x and y of each point less those of the one before it, of the first less (0, 0): neighbours are near one another,
/// and their differences take a byte or two each.
using Differences = google::protobuf::RepeatedField<std::int32_t>;

/// Points up to kCoordinateMax from the origin either way.
void append_differences(std::span<const PointMm> points, Differences& out);

void write_point(const Point2& point, v1::Point& out);
void write_refusal(const Error& refusal, v1::Refusal& out);

} // namespace scanloom::wire
