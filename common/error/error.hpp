#pragma once

#include <boost/assert/source_location.hpp>
#include <boost/system/result.hpp>

#include <stdexcept>
#include <string>
#include <string_view>

namespace scanloom {

/// What kind of thing went wrong. HTTP statuses, wire error codes and exit codes are looked up
/// from it in one table each; people read Error::message.
enum class Errc {
    kMalformed,          ///< bytes that are not what they claim to be
    kDamaged,            ///< bytes that were changed on the way; the same may pass when they are sent again
    kTooLarge,           ///< a size beyond a stated limit
    kUnsupportedVersion, ///< a protocol or format version this program does not speak
    kInvalidField,       ///< a value out of its range; the message names the field
    kNotFound,           ///< no such session, layer, tile, file
    kAlreadyExists,      ///< a session of that name
    kConflict,           ///< what contradicts what is there: other settings, another source, a damaged session
    kOutOfOrder,         ///< a scan's seq is missing
    kCreditExceeded,     ///< a robot sent more than it was allowed
    kTimeout,            ///< a deadline passed
    kReplaced,           ///< the same robot connected again
    kGone,               ///< the session was deleted while in use
    kStoreFailed,        ///< the store could not read or write; later it may
    kDataLoss,           ///< what was stored is damaged or missing; waiting does not mend it
    kShuttingDown,       ///< the server is draining
    kUnauthorized,       ///< no valid token
    kUnreachable,        ///< the peer cannot be reached, or hung up
    kOverloaded,         ///< no room or no time for this now; later there may be
    kFull,               ///< a session or its map holds the most it can; waiting makes no room
    kNoPath,             ///< no way leads there; the message says what is in it
    kAmbiguous,          ///< several answers are as good as each other; the message names two
    kUndetermined,       ///< too little is known for an answer
    kNothingMapped,      ///< there is no map yet that could tell
    kInternal,           ///< a fault of this program
};

/// Stable lower-case name of a code, for logs and JSON ("invalid_field").
[[nodiscard]] std::string_view name_of(Errc code) noexcept;

/// A failure: a code for programs, one sentence for people.
/// The sentence says what was wrong, where, and what to do about it.
struct Error {
    Errc code;
    std::string message;

    friend bool operator==(const Error&, const Error&) = default;
};

/// The one way a boundary reports failure. Mark functions that return it [[nodiscard]].
template <class T = void>
using Result = boost::system::result<T, Error>;

/// Result::value() on a failure throws this.
class ErrorException : public std::runtime_error {
public:
    explicit ErrorException(const Error& error) : std::runtime_error(error.message), error_(error) {}
    [[nodiscard]] const Error& error() const noexcept { return error_; }

private:
    Error error_;
};

/// Customisation point found by boost::system::result.
[[noreturn]] inline void throw_exception_from_error(const Error& error, const boost::source_location&) {
    throw ErrorException(error);
}

/// The same failure with where it happened in front: "scans[3]." + "pose.x is not finite".
[[nodiscard]] inline Error prefixed(std::string_view where, Error error) {
    error.message.insert(0, where);
    return error;
}

} // namespace scanloom
