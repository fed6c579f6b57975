#include "common/error/error.hpp"

namespace scanloom {

std::string_view name_of(Errc code) noexcept {
    switch (code) {
    case Errc::kMalformed: return "malformed";
    case Errc::kDamaged: return "damaged";
    case Errc::kTooLarge: return "too_large";
    case Errc::kUnsupportedVersion: return "unsupported_version";
    case Errc::kInvalidField: return "invalid_field";
    case Errc::kNotFound: return "not_found";
    case Errc::kAlreadyExists: return "already_exists";
    case Errc::kConflict: return "conflict";
    case Errc::kOutOfOrder: return "out_of_order";
    case Errc::kCreditExceeded: return "credit_exceeded";
    case Errc::kTimeout: return "timeout";
    case Errc::kReplaced: return "replaced";
    case Errc::kNotOwner: return "not_owner";
    case Errc::kGone: return "gone";
    case Errc::kStoreFailed: return "store_failed";
    case Errc::kDataLoss: return "data_loss";
    case Errc::kShuttingDown: return "shutting_down";
    case Errc::kUnauthorized: return "unauthorized";
    case Errc::kUnreachable: return "unreachable";
    case Errc::kOverloaded: return "overloaded";
    case Errc::kFull: return "full";
    case Errc::kNoPath: return "no_path";
    case Errc::kAmbiguous: return "ambiguous";
    case Errc::kUndetermined: return "undetermined";
    case Errc::kNothingMapped: return "nothing_mapped";
    case Errc::kInternal: return "internal";
    }
    return "unknown";
}

std::string further(std::string_view message, std::string_view more) {
    std::string text(message);
    if (!text.ends_with('?') || more.empty()) return text.append("; ").append(more);
    text.append(" ").append(more);
    char& first = text[text.size() - more.size()];
    if (first >= 'a' && first <= 'z') first = static_cast<char>(first - 'a' + 'A');
    return text;
}

} // namespace scanloom
