#include "load/app/live_display.hpp"

#include <fmt/format.h>

namespace scanloom::load {

void LiveDisplay::show(const std::vector<std::string>& rows) {
    clear();
    for (const auto& row : rows) out_.write(row + "\n");
    rows_ = out_.is_terminal() ? rows.size() : 0;
}

void LiveDisplay::note(std::string_view text) {
    clear();
    out_.write(fmt::format("{}\n", text));
}

void LiveDisplay::passing(std::string_view text) {
    if (out_.is_terminal()) show({std::string(text)});
}

void LiveDisplay::clear() {
    if (rows_ > 0) out_.write(fmt::format("\x1b[{}A\x1b[J", rows_)); // moves the cursor up and erases to the end
    rows_ = 0;
}

} // namespace scanloom::load
