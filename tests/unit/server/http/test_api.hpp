#pragma once

#include "server/http/api.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/system_executor.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace scanloom::http {

/// Queues of work that run when they are polled.
class PolledWork {
public:
    [[nodiscard]] Executors executors() {
        return {.metrics = of(WorkClass::kMetrics).get_executor(),
                .queries = of(WorkClass::kQueries).get_executor(),
                .whole_maps = of(WorkClass::kWholeMaps).get_executor(),
                .log_reading = of(WorkClass::kLogReading).get_executor(),
                .log_export = of(WorkClass::kLogExport).get_executor(),
                .planning = of(WorkClass::kPlanning).get_executor(),
                .store = of(WorkClass::kStore).get_executor(),
                .live = of(WorkClass::kIo).get_executor()};
    }

    /// Runs what is queued and adds the classes that had work to `ran`.
    void poll(std::vector<WorkClass>& ran) {
        for (std::size_t n = 0; n < queues_.size(); ++n) {
            const bool had_work = queues_[n].io.poll() > 0;
            if (had_work && n != 0) ran.push_back(static_cast<WorkClass>(n));
        }
    }

    [[nodiscard]] boost::asio::io_context& of(WorkClass work) { return queues_[static_cast<std::size_t>(work)].io; }

private:
    struct Queue {
        boost::asio::io_context io;
        boost::asio::executor_work_guard<boost::asio::io_context::executor_type> guard{io.get_executor()};
    };
    std::array<Queue, static_cast<std::size_t>(WorkClass::kStore) + 1> queues_;
};

/// Computes the response to a request, instead of the handlers.
using Answer = std::function<Response(const Request&)>;

struct TestServices : Services {
    Answer answer = nullptr;
};

/// An Api over given parts; it owns the parts that tests seldom use.
class TestApi {
public:
    TestApi(sessions::SessionRegistry& sessions, sessions::ReplayJobs& weaves, guidance::GoalAssignments& goals,
            store::ScanLog& log, const metrics::Metrics& metrics, Authorizer authorizer, WebFiles web = {},
            const ServerConfig& limits = {}, std::optional<Executors> executors = std::nullopt,
            std::span<const Route> of_routes = routes())
        : check_(log, sessions), locator_(log),
          work_classes_(executors ? *executors : polled_.executors(), limits), services_{{.sessions = sessions,
                                                                                          .weaves = weaves,
                                                                                          .goals = goals,
                                                                                          .locator = locator_,
                                                                                          .log = log,
                                                                                          .check = check_,
                                                                                          .metrics = metrics,
                                                                                          .authorizer = authorizer,
                                                                                          .work_classes = work_classes_,
                                                                                          .web = std::move(web)}},
          api_(services_, of_routes) {}

    [[nodiscard]] TestServices& services() { return services_; }
    [[nodiscard]] const Api& api() const { return api_; }
    void set_recovered() { services_.recovered = true; }

    struct Asked {
        std::optional<Response> response;
        std::vector<WorkClass> work; ///< for which it left the I/O threads
    };

    /// A running request.
    struct Running {
        Request request;
        Asked asked = {};
        std::atomic<bool> done = false; ///< then `response` is set
    };

    /// Starts a request, which continues in poll().
    [[nodiscard]] std::shared_ptr<Running> start(Request request) {
        std::shared_ptr<Running> running(new Running{std::move(request)});
        boost::asio::co_spawn(boost::asio::make_strand(polled_.of(WorkClass::kIo)), serve(running),
                              [](const std::exception_ptr& failed) {
                                  if (failed) std::rethrow_exception(failed);
                              });
        return running;
    }

    void poll(Running& running) { polled_.poll(running.asked.work); }

    /// Sends a request and waits for its response.
    [[nodiscard]] Asked ask(Request request) {
        const auto running = start(std::move(request));
        while (!running->done) {
            poll(*running);
            std::this_thread::yield();
        }
        return std::move(running->asked);
    }

    [[nodiscard]] Response answer(const Request& request) { return *ask(request).response; }

    /// Returns the refusal of a request by its header.
    [[nodiscard]] std::optional<Response> refuse(const Request& request) const {
        auto admitted = admit(request);
        auto* refusal = std::get_if<Response>(&admitted);
        return refusal == nullptr ? std::nullopt : std::optional(std::move(*refusal));
    }

private:
    [[nodiscard]] std::variant<Api::Admitted, Response> admit(const Request& request) const {
        auto routed = api_.route(request);
        if (auto* refusal = std::get_if<Response>(&routed)) return std::move(*refusal);
        return api_.admit(request, std::get<Api::Routed>(std::move(routed)));
    }

    boost::asio::awaitable<void> serve(std::shared_ptr<Running> running) const {
        auto admitted = admit(running->request);
        if (auto* refusal = std::get_if<Response>(&admitted)) {
            running->asked.response = std::move(*refusal);
        } else {
            running->asked.response =
                co_await api_.answer(std::get<Api::Admitted>(std::move(admitted)), running->request);
        }
        running->done = true;
    }

    sessions::BackgroundCheck check_; // never started
    guidance::Locator locator_;
    PolledWork polled_;
    WorkClasses work_classes_;
    TestServices services_;
    Api api_;
};

} // namespace scanloom::http
