#include "server/ingest/request_desk.hpp"

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <exception>
#include <new>
#include <utility>

namespace scanloom::ingest {

std::optional<Error> RequestDesk::ask(Asker asker, link::Request request, Done done) {
    const bool asks_where = std::holds_alternative<wire::LocateRequest>(request);
    auto slot = (asks_where ? locating_slots_ : slots_).try_acquire();
    if (!slot) return Error{Errc::kOverloaded, "too many robots ask at this moment; ask again soon"};
    boost::asio::post(asks_where ? locating_ : planning_, [this, asker = std::move(asker), request = std::move(request),
                                                           done = std::move(done), slot = std::move(slot)]() mutable {
        std::string frame;
        wire::encode(meet(request, asker), frame);
        done(std::move(frame), std::move(slot));
    });
    return std::nullopt;
}

/// Starts no search while the server shuts down, because shutdown would have to wait for it.
wire::Message RequestDesk::meet(const link::Request& request, const Asker& asker) const {
    if (services_.sessions.is_draining())
        return link::refusal_of(request, {Errc::kShuttingDown, "the server is shutting down"});
    if (*asker.is_gone) return link::refusal_of(request, {Errc::kUnreachable, "the link is closed"});
    try {
        return reply_to(request, asker, services_);
    } catch (const std::bad_alloc&) {
        return link::refusal_of(request,
                                {Errc::kOverloaded, "there is no memory for this search now; ask again later"});
    } catch (const std::exception& failure) {
        return link::refusal_of(request, {Errc::kInternal, fmt::format("the search failed: {}", failure.what())});
    }
}

} // namespace scanloom::ingest
