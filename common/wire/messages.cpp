#include "common/wire/messages.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/error_codes.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/proto_convert.hpp"
#include "common/wire/request_convert.hpp"

#include "scanloom/v1/frame.pb.h"

#include <fmt/format.h>
#include <google/protobuf/arena.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <cmath>

namespace scanloom::wire {
namespace {

/// Silences protobuf, which writes a line to stderr for every invalid string received; decode() reports them already.
[[maybe_unused]] auto* const kEarlierLogHandler = google::protobuf::SetLogHandler(nullptr);

constexpr std::size_t kClientBytesMax = 128;
constexpr std::size_t kSourceBytesMax = 64;

Result<> check_name(std::string_view field, std::string_view name) {
    if (is_valid_name(name)) return {};
    return invalid_field(
        fmt::format("{} is not a valid name; use 1 to {} characters of A-Z a-z 0-9 _ -", field, kNameBytesMax));
}

/// Checks text that appears in logs.
Result<> check_text(std::string_view field, std::string_view text, std::size_t bytes_max) {
    if (text.size() > bytes_max) {
        return Error{Errc::kTooLarge,
                     fmt::format("{} has {} bytes, at most {} are allowed", field, text.size(), bytes_max)};
    }
    if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
        return invalid_field(fmt::format("{} holds a control character; send printable text", field));
    }
    return {};
}

} // namespace

// The messages of frame.proto that no other file converts. They are not in the unnamed namespace, which would hide the
// functions of the same name in the headers.

static Result<Hello> from_proto(const v1::Hello& proto) {
    Hello hello{proto.protocol_version(), proto.robot(), proto.session(), proto.token(), std::nullopt,
                proto.client(),           proto.source()};
    if (hello.protocol_version != kProtocolVersion) {
        return Error{Errc::kUnsupportedVersion, fmt::format("protocol_version is {}; this program speaks version {}",
                                                            hello.protocol_version, kProtocolVersion)};
    }
    if (auto ok = check_name("robot", hello.robot); !ok) return ok.error();
    if (auto ok = check_name("session", hello.session); !ok) return ok.error();
    if (auto ok = check_text("client", hello.client, kClientBytesMax); !ok) return ok.error();
    if (auto ok = check_text("source", hello.source, kSourceBytesMax); !ok) return ok.error();
    if (proto.has_body_radius()) {
        hello.body_radius = proto.body_radius();
        if (!is_body_radius(*hello.body_radius)) {
            return invalid_field(fmt::format("body_radius is {} m; it must be more than 0 and at most {}",
                                             *hello.body_radius, kBodyRadiusMax));
        }
    }
    const auto poses = from_proto(proto.poses());
    if (!poses) return poses.error();
    hello.poses = *poses;
    if (proto.has_create()) {
        auto options = from_proto(proto.create());
        if (!options) return prefixed("create.", options.error());
        hello.create = *options;
    }
    return hello;
}

static void to_proto(const Hello& hello, v1::Hello& out) {
    out.set_protocol_version(hello.protocol_version);
    out.set_robot(hello.robot);
    out.set_session(hello.session);
    out.set_token(hello.token);
    if (hello.create) to_proto(*hello.create, *out.mutable_create());
    out.set_client(hello.client);
    out.set_source(hello.source);
    if (hello.body_radius) out.set_body_radius(*hello.body_radius);
    out.set_poses(to_proto(hello.poses));
}

static Result<Welcome> from_proto(const v1::Welcome& proto) {
    const auto& limits = proto.limits();
    return Welcome{proto.session_id(), proto.last_durable_seq(),
                   Limits{limits.frame_size_max(), limits.beams_max(), limits.scans_per_batch_max()},
                   proto.credit_bytes(), proto.zstd()};
}

static void to_proto(const Welcome& welcome, v1::Welcome& out) {
    out.set_session_id(welcome.session_id);
    out.set_last_durable_seq(welcome.last_durable_seq);
    out.mutable_limits()->set_frame_size_max(welcome.limits.frame_size_max);
    out.mutable_limits()->set_beams_max(welcome.limits.beams_max);
    out.mutable_limits()->set_scans_per_batch_max(welcome.limits.scans_per_batch_max);
    out.set_credit_bytes(welcome.credit_bytes);
    out.set_zstd(welcome.zstd);
}

static Result<ScanBatch> from_proto(const v1::ScanBatch& proto) {
    if (proto.scans().empty()) return invalid_field("scans is empty; a batch has at least 1 scan");
    if (static_cast<std::size_t>(proto.scans_size()) > kScansPerBatchMax) {
        return Error{Errc::kTooLarge,
                     fmt::format("scans has {} scans, at most {} are allowed", proto.scans_size(), kScansPerBatchMax)};
    }
    ScanBatch batch;
    batch.scans.reserve(static_cast<std::size_t>(proto.scans_size()));
    for (const auto& scan_proto : proto.scans()) {
        auto scan = from_proto(scan_proto);
        if (!scan) return prefixed(fmt::format("scans[{}].", batch.scans.size()), scan.error());
        batch.scans.push_back(std::move(*scan));
    }
    return batch;
}

static void to_proto(const ScanBatch& batch, v1::ScanBatch& out) {
    for (const auto& scan : batch.scans) to_proto(scan, *out.add_scans());
}

static Result<CompressedScanBatch> from_proto(const v1::CompressedScanBatch& proto) {
    return CompressedScanBatch{proto.size(), proto.zstd()};
}

static void to_proto(const CompressedScanBatch& batch, v1::CompressedScanBatch& out) {
    out.set_size(batch.size);
    out.set_zstd(batch.zstd);
}

static Result<Ack> from_proto(const v1::Ack& proto) {
    return Ack{proto.durable_seq(), proto.applied_seq(), proto.credit_bytes()};
}

static void to_proto(const Ack& ack, v1::Ack& out) {
    out.set_durable_seq(ack.durable_seq);
    out.set_applied_seq(ack.applied_seq);
    out.set_credit_bytes(ack.credit_bytes);
}

static Result<LinkError> from_proto(const v1::Error& proto) {
    return LinkError{Error{to_errc(proto.code()), proto.message()}, proto.retryable(), proto.address()};
}

static void to_proto(const LinkError& failure, v1::Error& out) {
    out.set_code(to_code(failure.error.code));
    out.set_message(failure.error.message);
    out.set_retryable(failure.retryable);
    out.set_address(failure.address);
}

static Result<Ping> from_proto(const v1::Ping& proto) { return Ping{proto.nonce()}; }
static Result<Pong> from_proto(const v1::Pong& proto) { return Pong{proto.nonce()}; }
static Result<Goodbye> from_proto(const v1::Goodbye& proto) { return Goodbye{proto.reason()}; }
static void to_proto(const Ping& ping, v1::Ping& out) { out.set_nonce(ping.nonce); }
static void to_proto(const Pong& pong, v1::Pong& out) { out.set_nonce(pong.nonce); }
static void to_proto(const Goodbye& goodbye, v1::Goodbye& out) { out.set_reason(goodbye.reason); }

namespace {

/// The kinds of frames: the type in Message, and the type and the field in frame.proto.
#define SCANLOOM_FRAMES(FRAME)                                                                                         \
    FRAME(Hello, Hello, hello)                                                                                         \
    FRAME(Welcome, Welcome, welcome)                                                                                   \
    FRAME(Sensor, SensorDescription, sensor_description)                                                               \
    FRAME(ScanBatch, ScanBatch, scan_batch)                                                                            \
    FRAME(Ack, Ack, ack)                                                                                               \
    FRAME(LinkError, Error, error)                                                                                     \
    FRAME(Ping, Ping, ping)                                                                                            \
    FRAME(Pong, Pong, pong)                                                                                            \
    FRAME(Goodbye, Goodbye, goodbye)                                                                                   \
    FRAME(Correction, Correction, correction)                                                                          \
    FRAME(PlanRequest, PlanRequest, plan_request)                                                                      \
    FRAME(PlanReply, PlanReply, plan_reply)                                                                            \
    FRAME(GoalRequest, GoalRequest, goal_request)                                                                      \
    FRAME(GoalReply, GoalReply, goal_reply)                                                                            \
    FRAME(CoverageRequest, CoverageRequest, coverage_request)                                                          \
    FRAME(CoverageReply, CoverageReply, coverage_reply)                                                                \
    FRAME(LocateRequest, LocateRequest, locate_request)                                                                \
    FRAME(LocateReply, LocateReply, locate_reply)                                                                      \
    FRAME(CompressedScanBatch, CompressedScanBatch, compressed_scan_batch)

template <class Kind>
Result<Message> as_message(std::string_view where, Result<Kind> read) {
    if (!read) return prefixed(where, read.error());
    return Message(std::move(*read));
}

Result<Message> read_frame(const v1::Frame& frame) {
    switch (frame.body_case()) {
#define SCANLOOM_READ(type, proto, field)                                                                              \
    case v1::Frame::k##proto: return as_message<type>(#field ".", from_proto(frame.field()));
        SCANLOOM_FRAMES(SCANLOOM_READ)
    case v1::Frame::BODY_NOT_SET: break;
    }
    return Error{Errc::kMalformed, "a frame without a body this program knows; it may come from a newer version"};
}

struct FrameWriter {
    v1::Frame& frame;
#define SCANLOOM_WRITE(type, proto, field)                                                                             \
    void operator()(const type& message) const { to_proto(message, *frame.mutable_##field()); }
    SCANLOOM_FRAMES(SCANLOOM_WRITE)
};

struct FrameName {
#define SCANLOOM_NAME(type, proto, field)                                                                              \
    std::string_view operator()(const type&) const noexcept { return #field; }
    SCANLOOM_FRAMES(SCANLOOM_NAME)
};

} // namespace

std::string_view name_of(const Message& message) noexcept { return std::visit(FrameName(), message); }

Result<Message> decode(std::string_view body) {
    google::protobuf::Arena arena;
    auto* frame = google::protobuf::Arena::CreateMessage<v1::Frame>(&arena);
    if (!frame->ParseFromArray(body.data(), static_cast<int>(body.size()))) {
        return Error{Errc::kMalformed,
                     fmt::format("{} bytes that are not a scanloom.v1.Frame; check the sender's protobuf definition",
                                 body.size())};
    }
    return read_frame(*frame);
}

void encode(const Message& message, std::string& out) {
    google::protobuf::Arena arena;
    auto* frame = google::protobuf::Arena::CreateMessage<v1::Frame>(&arena);
    std::visit(FrameWriter{*frame}, message);
    append_checked_frame(out, frame->SerializeAsString());
}

Result<> check_scan(const Scan& scan, const Sensor& sensor) {
    if (scan.angles) return {}; // decode() has checked them against the ranges
    if (const auto* uniform = std::get_if<UniformAngles>(&sensor.angles)) {
        const double span = std::abs(uniform->increment) * static_cast<double>(scan.ranges.size() - 1);
        if (span <= kFullTurn) return {};
        return invalid_field(
            fmt::format("ranges has {} beams, which span {:.3f} rad at the increment of sensor {}, more "
                        "than a full turn; send the scan's own angles",
                        scan.ranges.size(), span, sensor.id));
    }
    const std::size_t described = beam_count(sensor.angles);
    if (scan.ranges.size() == described) return {};
    return invalid_field(fmt::format("ranges has {} beams, sensor {} has {} angles; send the scan's own angles",
                                     scan.ranges.size(), sensor.id, described));
}

} // namespace scanloom::wire
