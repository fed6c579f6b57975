#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include "scanloom/v1/frame.pb.h"

/// Converts requests, their replies and corrections between protobuf messages and plain values.
/// from_proto() validates the points of requests and every value of replies; the error names the field relative to the
/// message.
namespace scanloom::wire {

[[nodiscard]] Result<PlanRequest> from_proto(const v1::PlanRequest& request);
[[nodiscard]] Result<PlanReply> from_proto(const v1::PlanReply& reply);
[[nodiscard]] Result<GoalRequest> from_proto(const v1::GoalRequest& request);
[[nodiscard]] Result<GoalReply> from_proto(const v1::GoalReply& reply);
[[nodiscard]] Result<CoverageRequest> from_proto(const v1::CoverageRequest& request);
[[nodiscard]] Result<CoverageReply> from_proto(const v1::CoverageReply& reply);
[[nodiscard]] Result<LocateRequest> from_proto(const v1::LocateRequest& request);
[[nodiscard]] Result<LocateReply> from_proto(const v1::LocateReply& reply);
[[nodiscard]] Result<Correction> from_proto(const v1::Correction& correction);

/// Precondition: a path has at most kReplyPointsMax points, a region at most kRegionPointsMax, a localization request
/// kViewPointsMin to kViewPointsMax, within kCoordinateMax.
void to_proto(const PlanRequest& request, v1::PlanRequest& out);
void to_proto(const PlanReply& reply, v1::PlanReply& out);
void to_proto(const GoalRequest& request, v1::GoalRequest& out);
void to_proto(const GoalReply& reply, v1::GoalReply& out);
void to_proto(const CoverageRequest& request, v1::CoverageRequest& out);
void to_proto(const CoverageReply& reply, v1::CoverageReply& out);
void to_proto(const LocateRequest& request, v1::LocateRequest& out);
void to_proto(const LocateReply& reply, v1::LocateReply& out);
void to_proto(const Correction& correction, v1::Correction& out);

} // namespace scanloom::wire
