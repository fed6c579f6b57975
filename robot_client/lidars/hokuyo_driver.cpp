#include "robot_client/lidars/hokuyo_driver.hpp"

#include "robot_client/sources/stationary_detector.hpp"

#include <fmt/format.h>

#include <numbers>
#include <numeric>
#include <utility>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

constexpr auto kAnswerWithin = 1s;
constexpr int kAttemptsMax = 3;

std::vector<std::uint8_t> line_of(std::string_view command) {
    std::vector<std::uint8_t> bytes(command.begin(), command.end());
    bytes.push_back('\n');
    return bytes;
}

} // namespace

/// Returns the command whose reply the state waits for.
std::string HokuyoDriver::command() const {
    switch (state_) {
    case State::kStopping: return "QT";
    case State::kSwitching: return "SCIP2.0";
    case State::kAskingVersion: return "VV";
    case State::kAskingParameters: return "PP";
    case State::kStarting:
    case State::kMeasuring: break;
    }
    // all steps one by one, every scan, without end
    return fmt::format("MD{:04}{:04}01000", parameters_.first_step, parameters_.last_step);
}

LidarStep HokuyoDriver::on_open() {
    reader_.restart();
    clock_.restart();
    version_.clear();
    return enter(State::kStopping);
}

LidarStep HokuyoDriver::enter(State state) {
    state_ = state;
    attempts_ = 1;
    return state == State::kMeasuring ? LidarStep{.timeout = 0ms} : ask();
}

LidarStep HokuyoDriver::ask() const { return {.send = line_of(command()), .timeout = kAnswerWithin}; }

LidarStep HokuyoDriver::on_timeout() {
    if (++attempts_ <= kAttemptsMax) return ask();
    switch (state_) {
    case State::kSwitching: return enter(State::kAskingVersion); // it speaks nothing else
    case State::kAskingVersion: return enter(State::kAskingParameters);
    default: break;
    }
    return {.failure = Error{
                Errc::kTimeout,
                fmt::format("no answer of a Hokuyo to {}; is it another device, or another line speed?", command())}};
}

LidarStep HokuyoDriver::on_bytes(std::span<const std::uint8_t> bytes, double arrival) {
    if (!reader_.has_part()) arrival_ = arrival;
    reader_.feed(bytes);
    LidarStep all;
    while (const auto reply = reader_.next()) {
        if (reply->command != command()) {
            if (state_ == State::kMeasuring) ++damaged_;
        } else if (state_ == State::kMeasuring) {
            take_measurement(*reply, all);
        } else {
            auto step = take(*reply);
            step.has_packet = all.has_packet;
            all = std::move(step); // the reply to one command is awaited at a time, so no earlier step sends anything
            if (all.failure) return all;
        }
        arrival_ = arrival; // the next reply begins within these bytes
    }
    return all;
}

LidarStep HokuyoDriver::take(const ScipReply& reply) {
    if (reply.is_damaged) return {}; // the command is repeated
    switch (state_) {
    case State::kStopping: return enter(State::kSwitching);
    case State::kSwitching: return enter(State::kAskingVersion);
    case State::kAskingVersion:
        version_ = fmt::format("serial {}, firmware {}", scip_value(reply, "SERI"), scip_value(reply, "FIRM"));
        return enter(State::kAskingParameters);
    case State::kAskingParameters: return take_parameters(reply);
    case State::kStarting:
    case State::kMeasuring: break;
    }
    if (reply.status == "00") return enter(State::kMeasuring);
    return {.failure = Error{
                Errc::kUnreachable,
                fmt::format("the Hokuyo refuses to measure (status {}); switch its power off and on", reply.status)}};
}

LidarStep HokuyoDriver::take_parameters(const ScipReply& reply) {
    auto parameters = read_hokuyo_parameters(reply);
    if (!parameters) return {.failure = parameters.error()};
    parameters_ = std::move(*parameters);
    LidarScanOptions scan = options_;
    if (scan.range_min <= 0.0) scan.range_min = parameters_.range_min * 1e-3;
    if (scan.range_max <= 0.0) scan.range_max = parameters_.range_max * 1e-3;
    if (scan.range_min >= scan.range_max) {
        return {.failure = Error{Errc::kInvalidField,
                                 fmt::format("its readings are from {:g} to {:g} m; no reading would be valid; change "
                                             "--min-range or --max-range",
                                             scan.range_min, scan.range_max)}};
    }
    const double step_angle = 2.0 * std::numbers::pi / parameters_.steps_per_turn;
    sensor_ = std::make_shared<const Sensor>(
        Sensor{.id = 0,
               .kind = SensorKind::kLaser,
               .name = "Hokuyo",
               .mount = scan.mount,
               .angles = UniformAngles{(parameters_.first_step - parameters_.front_step) * step_angle, step_angle,
                                       static_cast<std::uint32_t>(parameters_.beams())},
               .aperture = 0.0,
               .range_min = scan.range_min,
               .range_max = scan.range_max});
    LidarStep step = enter(State::kStarting);
    const std::string note = fmt::format("Hokuyo {}, {}, {} beams, {:g} scans per second", parameters_.model, version_,
                                         parameters_.beams(), parameters_.rpm / 60.0);
    if (noted_.insert(note).second) step.notes.push_back(note);
    return step;
}

void HokuyoDriver::take_measurement(const ScipReply& reply, LidarStep& step) {
    if (reply.status == "00" && reply.lines.empty()) return; // the command was repeated
    if (!reply.is_damaged && reply.status != "99") {
        const auto note = fmt::format("the Hokuyo states an abnormal status: {}", reply.status);
        constexpr std::size_t kNotesMax = 20; // of a lidar that states a status after another
        if (noted_.size() < kNotesMax && noted_.insert(note).second) step.notes.push_back(note);
        return;
    }
    const auto measured = read_hokuyo_scan(reply, parameters_.beams());
    if (reply.is_damaged || !measured) {
        ++damaged_;
        return;
    }
    step.has_packet = true;
    ++turns_;
    LidarScanOptions limits = options_;
    limits.range_min = sensor_->range_min;
    limits.range_max = sensor_->range_max;
    const RangeFilter filter(limits);
    Scan scan;
    scan.duration = static_cast<double>(parameters_.beams() - 1) / parameters_.steps_per_turn * 60.0 / parameters_.rpm;
    scan.stamp = clock_.stamp(measured->milliseconds, arrival_) - scan.duration / 2.0;
    scan.ranges.reserve(measured->distances.size());
    for (const auto distance : measured->distances) {
        const bool is_code = distance < static_cast<std::uint32_t>(parameters_.range_min);
        scan.ranges.push_back(is_code ? kInvalidRange : filter(distance));
    }
    if (options_.median_window) {
        std::vector<std::int32_t> steps(scan.ranges.size());
        std::iota(steps.begin(), steps.end(), parameters_.first_step);
        scan.ranges = median_filtered(scan.ranges, steps, parameters_.steps_per_turn, *options_.median_window);
    }
    complete_.push_back({sensor_, std::move(scan)});
}

std::vector<std::uint8_t> HokuyoDriver::stop_request() const { return line_of("QT"); }

std::optional<Observation> HokuyoDriver::next() {
    if (complete_.empty()) return std::nullopt;
    Observation taken = std::move(complete_.front());
    complete_.pop_front();
    return taken;
}

LidarCounts HokuyoDriver::counts() const { return {.damaged = damaged_, .turns = turns_}; }

} // namespace scanloom::robot
