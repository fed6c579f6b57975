#include "load/core/figure_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace scanloom::load {

std::string grouped(std::uint64_t count) {
    const std::string digits = std::to_string(count);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
        text += digits[i];
    }
    return text;
}

std::string whole(double count) { return grouped(static_cast<std::uint64_t>(std::llround(std::fmax(count, 0.0)))); }

std::string as_milliseconds(Micros time) {
    const double milliseconds = static_cast<double>(time) / static_cast<double>(kMillisecond);
    if (milliseconds < 9.995) return fmt::format("{:.2f}", milliseconds);
    if (milliseconds < 99.95) return fmt::format("{:.1f}", milliseconds);
    return whole(milliseconds);
}

std::string as_bytes(double bytes) {
    constexpr double kStep = 1024.0;
    if (bytes < kStep) return fmt::format("{:.0f} B", bytes);
    for (const char* unit : {"KiB", "MiB", "GiB"}) {
        bytes /= kStep;
        if (bytes < kStep) return fmt::format("{:.{}f} {}", bytes, bytes < 100.0 ? 1 : 0, unit);
    }
    return fmt::format("{} TiB", whole(bytes / kStep));
}

std::string harmless(std::string text) {
    std::ranges::replace_if(
        text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text;
}

} // namespace scanloom::load
