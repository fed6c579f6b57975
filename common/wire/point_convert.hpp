#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/geometry/pose2.hpp"

#include "scanloom/v1/frame.pb.h"

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <span>
#include <string_view>

/// Converts the parts that requests and replies have in common between protobuf messages and plain values.
/// An error of a check names its `field`.
namespace scanloom::wire {

/// Checks that a coordinate is finite and within kCoordinateMax.
/// Errors: kInvalidField.
[[nodiscard]] Result<> check_coordinate(std::string_view field, double metres);

/// Checks both coordinates of a point with check_coordinate().
[[nodiscard]] Result<> check(std::string_view field, const v1::Point& point);

/// Checks that a length, a cost or an area is finite and not negative.
/// Errors: kInvalidField.
[[nodiscard]] Result<> check_size(std::string_view field, double size);

[[nodiscard]] Point2 value_of(const v1::Point& point);
[[nodiscard]] Error value_of(const v1::Refusal& refusal);

/// Returns the error for a reply that has neither a result nor a refusal.
[[nodiscard]] Error without_outcome();

/// Points as differences: x and y of the first point, then x and y of each point minus those of the previous one.
/// Successive points are close to each other, so that a difference takes one or two bytes.
using Differences = google::protobuf::RepeatedField<std::int32_t>;

/// Appends the differences of the points. Precondition: the points are within kCoordinateMax.
void append_differences(std::span<const PointMm> points, Differences& out);

void write_point(const Point2& point, v1::Point& out);
void write_refusal(const Error& refusal, v1::Refusal& out);

} // namespace scanloom::wire
