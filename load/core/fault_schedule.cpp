#include "load/core/fault_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace scanloom::load {
namespace {

constexpr double kMeanMin = 0.1; // seconds
constexpr double kMeanMax = 1e6;

Error unknown_fault(std::string_view text) {
    return {Errc::kInvalidField, fmt::format("'{}' is not a fault; name kinds with the mean seconds between two on a "
                                             "link, as in cut=20,half-open=60,stall=30",
                                             text)};
}

Result<> read_fault(std::string_view item, FaultMeans& means) {
    const auto equals = item.find('=');
    const auto* const kind = std::ranges::find(kFaultNames, item.substr(0, equals));
    if (equals == std::string_view::npos || kind == kFaultNames.end()) return unknown_fault(item);
    const auto number = item.substr(equals + 1);
    double mean = 0.0;
    const auto [stopped, failed] = std::from_chars(number.data(), number.data() + number.size(), mean);
    if (failed != std::errc{} || stopped != number.data() + number.size()) return unknown_fault(item);
    if (!(mean >= kMeanMin && mean <= kMeanMax)) {
        return Error{Errc::kInvalidField,
                     fmt::format("'{}': the mean is not within {} to {} s", item, kMeanMin, kMeanMax)};
    }
    means[static_cast<std::size_t>(kind - kFaultNames.begin())] = mean;
    return {};
}

} // namespace

Result<FaultMeans> parse_faults(std::string_view text) {
    FaultMeans means{};
    while (!text.empty()) {
        const auto comma = std::min(text.find(','), text.size());
        if (auto ok = read_fault(text.substr(0, comma), means); !ok) return ok.error();
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return means;
}

FaultSchedule::FaultSchedule(const FaultMeans& means, std::uint32_t robots, std::uint64_t seed)
    : robots_(robots), random_(seed) {
    for (std::size_t i = 0; i < kFaultKinds; ++i) rates_[i] = means[i] > 0.0 ? robots / means[i] : 0.0;
    per_second_ = std::accumulate(rates_.begin(), rates_.end(), 0.0);
}

/// The distributions of standard libraries may differ; these draws do not.
double FaultSchedule::uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

FaultSchedule::Event FaultSchedule::next() {
    Event event;
    event.after = static_cast<Micros>(-std::log(1.0 - uniform()) / per_second_ * static_cast<double>(kSecond));
    event.robot = static_cast<std::uint32_t>(uniform() * robots_);
    double left = uniform() * per_second_;
    for (std::size_t i = 0; i < kFaultKinds; ++i) {
        if (rates_[i] > 0.0) event.fault = static_cast<Fault>(i); // the last kind present, despite rounding
        if (left < rates_[i]) break;
        left -= rates_[i];
    }
    return event;
}

} // namespace scanloom::load
