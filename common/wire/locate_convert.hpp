#pragma once

#include "common/error/error.hpp"
#include "common/wire/messages.hpp"

#include "scanloom/v1/frame.pb.h"

/// Converts corrections and localization requests and replies between protobuf messages and plain values.
/// from_proto() validates every value; the error names the field relative to the message.
namespace scanloom::wire {

[[nodiscard]] Result<Correction> from_proto(const v1::Correction& correction);
[[nodiscard]] Result<LocateRequest> from_proto(const v1::LocateRequest& request);
[[nodiscard]] Result<LocateReply> from_proto(const v1::LocateReply& reply);

/// Precondition for a request: kLocatePointsMin to kLocatePointsMax points, within kCoordinateMax.
void to_proto(const Correction& correction, v1::Correction& out);
void to_proto(const LocateRequest& request, v1::LocateRequest& out);
void to_proto(const LocateReply& reply, v1::LocateReply& out);

} // namespace scanloom::wire
