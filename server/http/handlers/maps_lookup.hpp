#pragma once

#include "common/error/error.hpp"
#include "server/http/handlers/call.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/session/session_registry.hpp"
#include "server/session/weaves.hpp"

#include <chrono>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

namespace scanloom::http {

/// The maps that a request is about.
struct Maps {
    std::shared_ptr<session::Session> session;
    std::shared_ptr<const mapping::Snapshot> snapshot;
    std::shared_ptr<const void> origin; ///< what makes them: the session or the weave
    std::string tag;                    ///< tells them from those of every other session and weave: for entity tags
};

/// The maps that a request compares.
struct TwoMaps {
    Maps a;
    Maps b;
};

/// Finds the maps of a session: its own, those of the weave that `weave` names, or those that settings and `until` ask
/// for (see weave_request()).
/// Thread  any.
class MapsLookup {
public:
    /// Whoever asks for settings waits for so long at most until they are woven.
    static constexpr std::chrono::milliseconds kPatience{20'000};

    MapsLookup(session::SessionRegistry& sessions, session::Weaves& weaves,
               std::chrono::milliseconds patience = kPatience)
        : sessions_(sessions), weaves_(weaves), patience_(patience) {}

    /// Those that exist: the session's, or the newest that a weave has finished. `known` are the other parameters that
    /// the caller reads.
    /// Errors  those of find_session(); kInvalidField: an unknown parameter; kNotFound: no such weave; kOverloaded: it
    ///         has none yet; its own, where it failed.
    [[nodiscard]] Result<Maps> find(const Call& call, std::initializer_list<std::string_view> known) const;

    /// The same for threads that may not wait: without a snapshot where the session's own maps are being written, and
    /// without a session where that is not in memory.
    [[nodiscard]] Result<Maps> find_at_once(const Call& call, std::initializer_list<std::string_view> known) const;

    /// The same as find(), and weaves them if settings are given; waits until what the session shows now is in.
    /// Errors  also those of weave_request().
    [[nodiscard]] Result<Maps> find_or_weave(const Call& call, std::initializer_list<std::string_view> known) const;

    /// Two of them, to be compared: those of `weave` and those of `with`, at least one of which names a weave; where
    /// one does not, the session's own. Both may name the same weave.
    /// Errors  as find(); kInvalidField: neither is given.
    [[nodiscard]] Result<TwoMaps> find_two(const Call& call, std::initializer_list<std::string_view> known) const;

    [[nodiscard]] session::SessionRegistry& sessions() const noexcept { return sessions_; }
    [[nodiscard]] session::Weaves& weaves() const noexcept { return weaves_; }

private:
    enum class Waiting { kAllowed, kNotAllowed };

    [[nodiscard]] static Result<> check(const Call& call, std::initializer_list<std::string_view> known);
    [[nodiscard]] Result<Maps> chosen(const Call& call, std::string_view parameter,
                                      Waiting waiting = Waiting::kAllowed) const;
    [[nodiscard]] Result<Maps> woven(const Call& call) const;

    session::SessionRegistry& sessions_;
    session::Weaves& weaves_;
    std::chrono::milliseconds patience_;
};

/// Errors  kNotFound.
[[nodiscard]] Result<std::shared_ptr<session::Weave>> find_weave(session::Weaves& weaves,
                                                                 const session::Session& session, std::string_view id);

} // namespace scanloom::http
