#pragma once

#include <boost/assert/source_location.hpp>
#include <boost/system/result.hpp>

#include <stdexcept>
#include <string>
#include <string_view>

namespace scanloom {

/// The kind of a failure, for programs; people read Error::message. One table each maps it to HTTP statuses, wire error
/// codes and exit codes.
enum class Errc {
    kMalformed,          ///< bytes that do not have the expected format
    kDamaged,            ///< bytes that changed in transit; sending them again may succeed
    kTooLarge,           ///< a size beyond a documented limit
    kUnsupportedVersion, ///< a protocol or format version that this program does not support
    kInvalidField,       ///< a value out of its range; the message names the field
    kNotFound,           ///< no such session, layer, tile or file
    kAlreadyExists,      ///< a session with this name exists
    kConflict,           ///< contradicts the present state: other settings, another source, a damaged session
    kOutOfOrder,         ///< a scan's seq is missing
    kCreditExceeded,     ///< a robot sent more than its credit allows
    kTimeout,            ///< a deadline passed
    kReplaced,           ///< the same robot connected again
    kGone,               ///< the session was deleted while in use
    kNotOwner,           ///< another server that shares the store has the session; connect there, or retry
    kStoreFailed,        ///< the store could not read or write; a retry may succeed
    kDataLoss,           ///< stored data is damaged or missing; a retry does not help
    kShuttingDown,       ///< the server is draining
    kUnauthorized,       ///< no valid token
    kUnreachable,        ///< the peer cannot be reached or has closed the connection
    kOverloaded,         ///< no capacity or no time for this now; a retry may succeed
    kFull,               ///< a session or its map has reached its maximum; a retry does not help
    kNoPath,             ///< no path leads there; the message says what blocks it
    kAmbiguous,          ///< several answers are equally good; the message says which or in what they differ
    kUndetermined,       ///< too little is known for an answer
    kNothingMapped,      ///< there is no map yet to answer from
    kInternal,           ///< a bug in this program
};

/// Returns the stable lower-case name of a code, for logs and JSON ("invalid_field").
[[nodiscard]] std::string_view name_of(Errc code) noexcept;

/// A failure: a code for programs and one sentence for people, which says what is wrong, where, and what to do.
struct Error {
    Errc code;           ///< what kind of failure
    std::string message; ///< for people; names the field, file or peer that is concerned

    friend bool operator==(const Error&, const Error&) = default;
};

/// A value or an Error. Every function that can fail returns one; mark such functions [[nodiscard]].
template <class T = void>
using Result = boost::system::result<T, Error>;

/// What Result::value() throws on a failure.
class ErrorException : public std::runtime_error {
public:
    /// Creates an exception whose what() is the error's message.
    explicit ErrorException(const Error& error) : std::runtime_error(error.message), error_(error) {}
    /// Returns the error that value() was called on.
    [[nodiscard]] const Error& error() const noexcept { return error_; }

private:
    Error error_;
};

/// Customisation point of boost::system::result.
[[noreturn]] inline void throw_exception_from_error(const Error& error, const boost::source_location&) {
    throw ErrorException(error);
}

/// Returns the error with `where` before its message: "scans[3]." + "pose.x is not finite".
[[nodiscard]] inline Error prefixed(std::string_view where, Error error) {
    error.message.insert(0, where);
    return error;
}

/// Joins a message and what follows from it: "it is gone; trying again". After a question, `more` becomes a sentence of
/// its own: "is it gone? Trying again".
[[nodiscard]] std::string further(std::string_view message, std::string_view more);

} // namespace scanloom
