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

/// The maps that a request refers to.
struct Maps {
    std::shared_ptr<session::Session> session;
    std::shared_ptr<const mapping::Snapshot> snapshot;
    std::shared_ptr<const void> origin; ///< their producer: the session or the replay job
    std::string tag;                    ///< unique among all sessions and replay jobs; for entity tags
};

/// The maps that a request compares.
struct TwoMaps {
    Maps a;
    Maps b;
};

/// Finds the maps of a session: its own, those of the replay job that `weave` names, or those for given settings and
/// `until` (see weave_request()).
/// Threads: any.
class MapsLookup {
public:
    /// The longest time that a request with settings waits for its replay job.
    static constexpr std::chrono::milliseconds kPatience{20'000};

    MapsLookup(session::SessionRegistry& sessions, session::Weaves& weaves,
               std::chrono::milliseconds patience = kPatience)
        : sessions_(sessions), weaves_(weaves), patience_(patience) {}

    /// Returns existing maps: the session's own, or the newest that a replay job has finished.
    /// @param known  the other parameters that the caller reads
    /// Errors: those of find_session(); kInvalidField for an unknown parameter; kNotFound if there is no such job;
    ///         kOverloaded if it has no maps yet; the job's own error if it failed.
    [[nodiscard]] Result<Maps> find(const Call& call, std::initializer_list<std::string_view> known) const;

    /// Returns what find() returns, but without waiting: without a snapshot while the session's own maps are being
    /// written, and without a session if that is not in memory.
    [[nodiscard]] Result<Maps> find_at_once(const Call& call, std::initializer_list<std::string_view> known) const;

    /// Returns what find() returns if no settings are given. Otherwise starts a replay job with the settings and waits
    /// until it has reached the session's current revision.
    /// Errors: those of find() and weave_request().
    [[nodiscard]] Result<Maps> find_or_weave(const Call& call, std::initializer_list<std::string_view> known) const;

    /// Returns two maps to compare, those of the parameters `weave` and `with`. At least one of them must name a replay
    /// job; an absent one means the session's own map. Both may name the same job.
    /// Errors: those of find(); kInvalidField if neither is given.
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

/// Errors: kNotFound if there is no such replay job.
[[nodiscard]] Result<std::shared_ptr<session::Weave>> find_weave(session::Weaves& weaves,
                                                                 const session::Session& session, std::string_view id);

} // namespace scanloom::http
