#include "common/wire/messages.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/error_codes.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/locate_convert.hpp"
#include "common/wire/proto_convert.hpp"
#include "common/wire/request_convert.hpp"
#include "common/wire/session_convert.hpp"

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

Result<Message> read_hello(const v1::Hello& proto) {
    Hello hello{proto.protocol_version(), proto.robot(), proto.session(), proto.token(), std::nullopt,
                proto.client(),           proto.source()};
    if (hello.protocol_version != kProtocolVersion) {
        return Error{Errc::kUnsupportedVersion,
                     fmt::format("hello.protocol_version is {}; this program speaks version {}", hello.protocol_version,
                                 kProtocolVersion)};
    }
    if (auto ok = check_name("hello.robot", hello.robot); !ok) return ok.error();
    if (auto ok = check_name("hello.session", hello.session); !ok) return ok.error();
    if (auto ok = check_text("hello.client", hello.client, kClientBytesMax); !ok) return ok.error();
    if (auto ok = check_text("hello.source", hello.source, kSourceBytesMax); !ok) return ok.error();
    if (proto.has_body_radius()) {
        hello.body_radius = proto.body_radius();
        if (!is_body_radius(*hello.body_radius)) {
            return invalid_field(fmt::format("hello.body_radius is {} m; it must be more than 0 and at most {}",
                                             *hello.body_radius, kBodyRadiusMax));
        }
    }
    if (proto.has_create()) {
        auto options = from_proto(proto.create());
        if (!options) return prefixed("hello.create.", options.error());
        hello.create = *options;
    }
    return Message(std::move(hello));
}

Result<Message> read_batch(const v1::ScanBatch& proto) {
    if (proto.scans().empty()) return invalid_field("scan_batch.scans is empty; a batch has at least 1 scan");
    if (static_cast<std::size_t>(proto.scans_size()) > kScansPerBatchMax) {
        return Error{Errc::kTooLarge, fmt::format("scan_batch.scans has {} scans, at most {} are allowed",
                                                  proto.scans_size(), kScansPerBatchMax)};
    }
    ScanBatch batch;
    batch.scans.reserve(static_cast<std::size_t>(proto.scans_size()));
    for (const auto& scan_proto : proto.scans()) {
        auto scan = from_proto(scan_proto);
        if (!scan) return prefixed(fmt::format("scan_batch.scans[{}].", batch.scans.size()), scan.error());
        batch.scans.push_back(std::move(*scan));
    }
    return Message(std::move(batch));
}

template <class Kind>
Result<Message> as_message(std::string_view where, Result<Kind> read) {
    if (!read) return prefixed(where, read.error());
    return Message(std::move(*read));
}

Result<Message> read_frame(const v1::Frame& frame) {
    switch (frame.body_case()) {
    case v1::Frame::kHello: return read_hello(frame.hello());
    case v1::Frame::kWelcome: {
        const auto& limits = frame.welcome().limits();
        return Message(Welcome{frame.welcome().session_id(), frame.welcome().last_durable_seq(),
                               Limits{limits.frame_size_max(), limits.beams_max(), limits.scans_per_batch_max()},
                               frame.welcome().credit_bytes(), frame.welcome().zstd()});
    }
    case v1::Frame::kSensorDescription: {
        auto sensor = from_proto(frame.sensor_description());
        if (!sensor) return prefixed("sensor_description.", sensor.error());
        return Message(std::move(*sensor));
    }
    case v1::Frame::kScanBatch: return read_batch(frame.scan_batch());
    case v1::Frame::kAck:
        return Message(Ack{frame.ack().durable_seq(), frame.ack().applied_seq(), frame.ack().credit_bytes()});
    case v1::Frame::kError:
        return Message(
            LinkError{Error{to_errc(frame.error().code()), frame.error().message()}, frame.error().retryable()});
    case v1::Frame::kPing: return Message(Ping{frame.ping().nonce()});
    case v1::Frame::kPong: return Message(Pong{frame.pong().nonce()});
    case v1::Frame::kGoodbye: return Message(Goodbye{frame.goodbye().reason()});
    case v1::Frame::kCorrection: return as_message("correction.", from_proto(frame.correction()));
    case v1::Frame::kPlanRequest: return as_message("plan_request.", from_proto(frame.plan_request()));
    case v1::Frame::kPlanReply: return as_message("plan_reply.", from_proto(frame.plan_reply()));
    case v1::Frame::kGoalRequest: return as_message("goal_request.", from_proto(frame.goal_request()));
    case v1::Frame::kGoalReply: return as_message("goal_reply.", from_proto(frame.goal_reply()));
    case v1::Frame::kCoverageRequest: return as_message("coverage_request.", from_proto(frame.coverage_request()));
    case v1::Frame::kCoverageReply: return as_message("coverage_reply.", from_proto(frame.coverage_reply()));
    case v1::Frame::kLocateRequest: return as_message("locate_request.", from_proto(frame.locate_request()));
    case v1::Frame::kLocateReply: return as_message("locate_reply.", from_proto(frame.locate_reply()));
    case v1::Frame::kCompressedScanBatch:
        return Message(CompressedScanBatch{frame.compressed_scan_batch().size(), frame.compressed_scan_batch().zstd()});
    case v1::Frame::BODY_NOT_SET: break;
    }
    return Error{Errc::kMalformed, "a frame without a body this program knows; it may come from a newer version"};
}

struct MessageToProto {
    v1::Frame& frame;

    void operator()(const Hello& hello) const {
        auto& out = *frame.mutable_hello();
        out.set_protocol_version(hello.protocol_version);
        out.set_robot(hello.robot);
        out.set_session(hello.session);
        out.set_token(hello.token);
        if (hello.create) to_proto(*hello.create, *out.mutable_create());
        out.set_client(hello.client);
        out.set_source(hello.source);
        if (hello.body_radius) out.set_body_radius(*hello.body_radius);
    }
    void operator()(const Welcome& welcome) const {
        auto& out = *frame.mutable_welcome();
        out.set_session_id(welcome.session_id);
        out.set_last_durable_seq(welcome.last_durable_seq);
        out.mutable_limits()->set_frame_size_max(welcome.limits.frame_size_max);
        out.mutable_limits()->set_beams_max(welcome.limits.beams_max);
        out.mutable_limits()->set_scans_per_batch_max(welcome.limits.scans_per_batch_max);
        out.set_credit_bytes(welcome.credit_bytes);
        out.set_zstd(welcome.zstd);
    }
    void operator()(const Sensor& sensor) const { to_proto(sensor, *frame.mutable_sensor_description()); }
    void operator()(const ScanBatch& batch) const {
        auto& out = *frame.mutable_scan_batch();
        for (const auto& scan : batch.scans) to_proto(scan, *out.add_scans());
    }
    void operator()(const Ack& ack) const {
        auto& out = *frame.mutable_ack();
        out.set_durable_seq(ack.durable_seq);
        out.set_applied_seq(ack.applied_seq);
        out.set_credit_bytes(ack.credit_bytes);
    }
    void operator()(const LinkError& failure) const {
        auto& out = *frame.mutable_error();
        out.set_code(to_code(failure.error.code));
        out.set_message(failure.error.message);
        out.set_retryable(failure.retryable);
    }
    void operator()(const Ping& ping) const { frame.mutable_ping()->set_nonce(ping.nonce); }
    void operator()(const Pong& pong) const { frame.mutable_pong()->set_nonce(pong.nonce); }
    void operator()(const Goodbye& goodbye) const { frame.mutable_goodbye()->set_reason(goodbye.reason); }
    void operator()(const Correction& correction) const { to_proto(correction, *frame.mutable_correction()); }
    void operator()(const PlanRequest& request) const { to_proto(request, *frame.mutable_plan_request()); }
    void operator()(const PlanReply& reply) const { to_proto(reply, *frame.mutable_plan_reply()); }
    void operator()(const GoalRequest& request) const { to_proto(request, *frame.mutable_goal_request()); }
    void operator()(const GoalReply& reply) const { to_proto(reply, *frame.mutable_goal_reply()); }
    void operator()(const CoverageRequest& request) const { to_proto(request, *frame.mutable_coverage_request()); }
    void operator()(const CoverageReply& reply) const { to_proto(reply, *frame.mutable_coverage_reply()); }
    void operator()(const LocateRequest& request) const { to_proto(request, *frame.mutable_locate_request()); }
    void operator()(const LocateReply& reply) const { to_proto(reply, *frame.mutable_locate_reply()); }
    void operator()(const CompressedScanBatch& batch) const {
        frame.mutable_compressed_scan_batch()->set_size(batch.size);
        frame.mutable_compressed_scan_batch()->set_zstd(batch.zstd);
    }
};

} // namespace

std::string_view name_of(const Message& message) noexcept {
    constexpr std::string_view kNames[] = {"hello",
                                           "welcome",
                                           "sensor_description",
                                           "scan_batch",
                                           "ack",
                                           "error",
                                           "ping",
                                           "pong",
                                           "goodbye",
                                           "correction",
                                           "plan_request",
                                           "plan_reply",
                                           "goal_request",
                                           "goal_reply",
                                           "coverage_request",
                                           "coverage_reply",
                                           "compressed_scan_batch",
                                           "locate_request",
                                           "locate_reply"};
    static_assert(std::size(kNames) == std::variant_size_v<Message>);
    return kNames[message.index()];
}

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
    std::visit(MessageToProto{*frame}, message);
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
