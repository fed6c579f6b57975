#include "common/error/further.hpp"

namespace scanloom {

std::string further(std::string_view message, std::string_view more) {
    std::string text(message);
    if (!text.ends_with('?') || more.empty()) return text.append("; ").append(more);
    text.append(" ").append(more);
    char& first = text[text.size() - more.size()];
    if (first >= 'a' && first <= 'z') first = static_cast<char>(first - 'a' + 'A');
    return text;
}

} // namespace scanloom
