#pragma once

#include "server/http/context.hpp"
#include "server/http/lane.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/router.hpp"
#include "server/http/target.hpp"

#include <functional>
#include <optional>
#include <variant>

namespace scanloom::http {

/// Answers requests: parses the target, finds the route, checks the permission and calls the handler.
/// Bounds: large responses take a slot, such as map images of up to 64 MB; cached tiles take at most
///     Services::tile_bytes_max.
/// Threads: answer() may be called on any number of threads.
class Api {
public:
    /// @param services  must outlive this object
    explicit Api(Services& services) : services_(services) {}

    /// Computes the response. A failure becomes a response too, with application/problem+json.
    [[nodiscard]] Response answer(const Request& request);

    /// Returns the response if it is immediately available, else the lane on which to call answer(), or the session to
    /// load first.
    /// Threads: I/O threads, before answer().
    [[nodiscard]] Outlook look(const Request& request);

    /// Loads the session that look() returned. `on_loaded` is called once, when the session is in memory or failed to
    /// load. Then call look() again. If its result is the same, answer() returns the reason.
    void wake(const Asleep& asleep, std::function<void()> on_loaded);

    /// Returns the refusal of a request whose header is enough to refuse it, else nullopt.
    /// Threads: I/O threads, before the body is read.
    [[nodiscard]] std::optional<Response> refuse(const Request& request) const;

private:
    /// A request whose header passed all checks.
    struct Admitted {
        Match match;
        Query query;
        access::TokenRef who;
    };

    /// Checks everything but the body: path, method, permission, Content-Type.
    [[nodiscard]] std::variant<Admitted, Response> admit(const Request& request) const;
    [[nodiscard]] Response for_who_asked(Operation operation, Response response) const;
    [[nodiscard]] Result<Response> call(Operation operation, Context& context);

    Services& services_;
};

} // namespace scanloom::http
