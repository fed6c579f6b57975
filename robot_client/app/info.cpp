#include "robot_client/app/info.hpp"

#include "common/app/standard_streams.hpp"
#include "robot_client/app/ros_options.hpp"
#include "robot_client/ros/frame_choice.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

constexpr double kNanosecond = 1e-9; // seconds

/// Returns a text without characters that a terminal could interpret.
std::string printable(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return text;
}

std::string time_text(RosTime time) {
    constexpr RosTime kYear = RosTime{365} * 24 * 3600 * 1'000'000'000;
    if (time < kYear) return fmt::format("{:.3f} s", static_cast<double>(time) * kNanosecond); // of a simulation
    return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<std::time_t>(time / 1'000'000'000)));
}

std::string row(const SurveyedTopic& topic, std::size_t name_width, std::size_t type_width) {
    const double seconds = static_cast<double>(topic.last - topic.first) * kNanosecond;
    const double rate = seconds > 0.0 ? static_cast<double>(topic.messages - 1) / seconds : 0.0;
    std::vector<std::string> frames;
    for (const auto& [frame, count] : topic.frames) frames.push_back(printable(frame));
    return fmt::format("{:{}}  {:{}}  {:>9}  {:>8}  {}{}\n", printable(topic.name), name_width, printable(topic.type),
                       type_width, topic.messages, rate > 0.0 ? fmt::format("{:.1f}", rate) : "",
                       fmt::join(frames, ", "),
                       topic.malformed > 0 ? fmt::format("  ({} malformed)", topic.malformed) : "");
}

std::string topics_text(const RecordingSurvey& found) {
    std::size_t name_width = 5;
    std::size_t type_width = 4;
    for (const auto& topic : found.topics) {
        name_width = std::max(name_width, topic.name.size());
        type_width = std::max(type_width, topic.type.size());
    }
    auto topics = found.topics;
    std::ranges::sort(topics, {}, &SurveyedTopic::name);
    std::string text = fmt::format("{:{}}  {:{}}  {:>9}  {:>8}  {}\n", "topic", name_width, "type", type_width,
                                   "messages", "per s", "frame");
    for (const auto& topic : topics) text += row(topic, name_width, type_width);
    return text;
}

std::string times_text(const RecordingSurvey& found) {
    std::optional<std::pair<RosTime, RosTime>> span;
    for (const auto& topic : found.topics) {
        if (topic.messages == 0) continue;
        if (!span) span.emplace(topic.first, topic.last);
        span->first = std::min(span->first, topic.first);
        span->second = std::max(span->second, topic.last);
    }
    if (!span) return "no messages";
    return fmt::format("{:.1f} s, from {} to {}", static_cast<double>(span->second - span->first) * kNanosecond,
                       time_text(span->first), time_text(span->second));
}

} // namespace

std::string info_text(const InfoOptions& options, const RecordingSurvey& found, const Result<RecordingPlan>& plan) {
    std::string text = fmt::format("{}: {}\n{}", options.file, times_text(found), topics_text(found));
    for (const auto& loss : texts_of(found.losses)) text += loss + "\n";
    if (!plan) return text + fmt::format("it cannot be replayed: {}\n", plan.error().message);
    text += fmt::format("{}\nscans: {} of {} can be sent",
                        poses_text(plan->poses, plan->base_frame, plan->fixed_frame, plan->odom_topic),
                        plan->scan_count, plan->scans.size());
    text += plan->skipped.empty() ? "\n" : fmt::format("; skipped: {}\n", skipped_text(plan->skipped));
    for (const auto& note : plan->notes) text += note + "\n";
    return text + fmt::format("replay it with: scanloom-robot --server HOST:7447 --session NAME --robot NAME{} replay "
                              "{}{}\n",
                              options.scan_arguments, quoted(options.file), options.ros_arguments);
}

ExitCode run(const InfoOptions& options) {
    auto found = survey(options.file);
    if (!found) {
        standard_error().write(fmt::format("scanloom-robot: {}\n", found.error().message));
        return kExitFailed;
    }
    const auto plan = robot::plan(*found, options.recording);
    fmt::print("{}", info_text(options, *found, plan));
    return kExitDone;
}

} // namespace scanloom::robot
