#include "tests/unit/server/http/generated_requests.hpp"

#include "tests/unit/server/http/api_fixture.hpp"

#include <set>

namespace scanloom::http {
namespace {

class GeneratedRequests : public ApiTest {
protected:
    void restore_session() {
        if (!registry_.load("lab")) {
            create("lab");
            stream("lab", 3);
        }
        if (registry_.find("new") != nullptr) static_cast<void>(registry_.remove("new"));
    }

    /// openapi.json describes every response, and no request causes a server error.
    void ask_many(unsigned seed, int count) {
        RequestGenerator generator(seed);
        std::set<Status> seen;
        for (int n = 0; n < count; ++n) {
            restore_session();
            const Request request = generator.next();
            SCOPED_TRACE(fmt::format("seed {}, request {}: {} {} {} {}", seed, n, request.method, request.target,
                                     request.content_type, request.body.substr(0, 1000)));
            const auto response = answer(api_, request);
            EXPECT_NE(response.status, Status::internal_server_error) << response.body.bytes();
            if (response.stream) {
                for (auto piece = response.stream->next(); piece && !piece->empty(); piece = response.stream->next()) {
                }
            }
            seen.insert(response.status);
            if (HasFailure()) return;
        }
        for (const Status status : {Status::ok, Status::created, Status::no_content, Status::bad_request,
                                    Status::not_found, Status::conflict, Status::unsupported_media_type}) {
            EXPECT_TRUE(seen.contains(status)) << status << " is in no response";
        }
    }
};

TEST_F(GeneratedRequests, GetResponsesOfTheDescription) { ask_many(1, 4'000); }

class GeneratedRequestsTrials : public GeneratedRequests {};

TEST_F(GeneratedRequestsTrials, GetResponsesOfTheDescription) {
    for (unsigned seed = 2; seed <= 13 && !HasFailure(); ++seed) ask_many(seed, 4'000);
}

} // namespace
} // namespace scanloom::http
