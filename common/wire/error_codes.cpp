#include "common/wire/error_codes.hpp"

namespace scanloom::wire {
namespace {

struct ErrorCodePair {
    Errc errc;
    v1::ErrorCode code;
};

constexpr ErrorCodePair kErrorCodes[] = {
    {Errc::kMalformed, v1::ERROR_CODE_MALFORMED_FRAME},
    {Errc::kDamaged, v1::ERROR_CODE_DAMAGED_FRAME},
    {Errc::kTooLarge, v1::ERROR_CODE_FRAME_TOO_LARGE},
    {Errc::kUnsupportedVersion, v1::ERROR_CODE_UNSUPPORTED_VERSION},
    {Errc::kInvalidField, v1::ERROR_CODE_INVALID_FIELD},
    {Errc::kNotFound, v1::ERROR_CODE_UNKNOWN_SESSION},
    {Errc::kConflict, v1::ERROR_CODE_SESSION_CONFLICT},
    {Errc::kOutOfOrder, v1::ERROR_CODE_OUT_OF_ORDER},
    {Errc::kCreditExceeded, v1::ERROR_CODE_CREDIT_EXCEEDED},
    {Errc::kTimeout, v1::ERROR_CODE_TIMEOUT},
    {Errc::kReplaced, v1::ERROR_CODE_REPLACED},
    {Errc::kGone, v1::ERROR_CODE_SESSION_DELETED},
    {Errc::kNotOwner, v1::ERROR_CODE_NOT_OWNER},
    {Errc::kStoreFailed, v1::ERROR_CODE_STORE_FAILED},
    {Errc::kShuttingDown, v1::ERROR_CODE_SHUTTING_DOWN},
    {Errc::kUnauthorized, v1::ERROR_CODE_UNAUTHORIZED},
    {Errc::kOverloaded, v1::ERROR_CODE_OVERLOADED},
    {Errc::kFull, v1::ERROR_CODE_SESSION_FULL},
    {Errc::kNoPath, v1::ERROR_CODE_NO_PATH},
    {Errc::kAmbiguous, v1::ERROR_CODE_AMBIGUOUS},
    {Errc::kUndetermined, v1::ERROR_CODE_UNDETERMINED},
    {Errc::kNothingMapped, v1::ERROR_CODE_NOTHING_MAPPED},
    {Errc::kInternal, v1::ERROR_CODE_INTERNAL},
};

} // namespace

v1::ErrorCode to_code(Errc errc) noexcept {
    for (const auto& pair : kErrorCodes) {
        if (pair.errc == errc) return pair.code;
    }
    return v1::ERROR_CODE_INTERNAL;
}

Errc to_errc(v1::ErrorCode code) noexcept {
    for (const auto& pair : kErrorCodes) {
        if (pair.code == code) return pair.errc;
    }
    return Errc::kInternal;
}

} // namespace scanloom::wire
