#include "load/app/run.hpp"

#include "common/app/settings.hpp"
#include "common/net/await_tuple.hpp"
#include "load/app/load_run.hpp"
#include "load/app/record_workload.hpp"
#include "load/app/report_file.hpp"
#include "load/core/figure_text.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <optional>
#include <system_error>

#include <sys/resource.h>

namespace scanloom::load {

namespace asio = boost::asio;

namespace {

constexpr std::uint64_t kDescriptorsBesides = 64; ///< for threads, files and the program's own requests

Result<net::HttpPlace> http_place(const LoadOptions& options, const std::string& token) {
    auto tls = tls_of(options, options.http.tls);
    if (!tls) return tls.error();
    return net::HttpPlace{static_cast<const net::Address&>(options.http), std::move(*tls), token,
                          "give the server's HTTP port to --http, or --verify none without viewers and tile readers"};
}

Result<RobotLinkOptions> link_options(const LoadOptions& options) {
    RobotLinkOptions link;
    link.servers = options.servers;
    for (const auto& server : options.servers) {
        auto endpoints = net::resolve(server);
        if (!endpoints) return endpoints.error();
        link.endpoints.push_back(std::move(*endpoints));
    }
    auto tls = tls_of(options, options.tls);
    if (!tls) return tls.error();
    link.tls = std::move(*tls);
    auto token = read_token(options.token_file);
    if (!token) return token.error();
    link.hello.token = std::move(*token);
    link.hello.poses = options.poses;
    link.hello.create = SessionOptions{};
    link.hello.create->cell_size = options.cell_size;
    link.hello.client = fmt::format("scanloom-load {}", kVersion);
    return link;
}

/// Raises this process's limit of file descriptors to the allowed maximum and returns it.
std::uint64_t raise_descriptor_limit() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

Result<> check_descriptors(const LoadOptions& options) {
    const bool leaves_links = options.faults[static_cast<std::size_t>(Fault::kHalfOpen)] > 0.0;
    const std::uint64_t needed = std::uint64_t{options.robots} * (leaves_links ? 2 : 1) + options.viewers +
                                 options.tile_readers + kDescriptorsBesides;
    const std::uint64_t allowed = raise_descriptor_limit();
    if (allowed >= needed) return {};
    return Error{
        Errc::kFull,
        fmt::format("{} descriptors are needed and {} allowed; raise the limit (ulimit -n), or use fewer robots",
                    grouped(needed), grouped(allowed))};
}

/// The first signal ends the streaming, the second the program.
asio::awaitable<void> obey_signals(asio::io_context& io, LoadRun& run, Console& console) {
    asio::signal_set signals(io, SIGINT, SIGTERM);
    if (std::get<0>(co_await signals.async_wait(kAwaitTuple))) co_return;
    console.note("interrupted: waiting for sent scans, then verifying them; interrupt again to end immediately, which "
                 "leaves the sessions on the server");
    run.interrupt();
    if (std::get<0>(co_await signals.async_wait(kAwaitTuple))) co_return;
    io.stop();
}

bool goes_to_a_file(const std::string& json_file) { return !json_file.empty() && json_file != "-"; }

/// @param file  of --json; absent if there is none or it is standard output
Result<> write_report(const RunReport& report, const std::string& json_file, std::optional<ReportFile>& file) {
    const std::string shown = json_file == "-" ? to_json(report) : to_text(report);
    const bool is_shown =
        std::fwrite(shown.data(), 1, shown.size(), stdout) == shown.size() && std::fflush(stdout) == 0;
    const int why = errno;
    if (file) {
        if (auto written = file->write(to_json(report)); !written) return written;
    }
    if (is_shown) return {};
    return Error{Errc::kInternal, fmt::format("the report cannot be written to standard output: {}",
                                              std::generic_category().message(why))};
}

} // namespace

ExitCode run(const LoadOptions& options) {
    Console console(standard_error());
    const auto fail = [&](const Error& error) {
        console.note("scanloom-load: " + error.message);
        return error.code == Errc::kTooLarge ? kExitUsage : kExitFailed;
    };
    std::optional<ReportFile> file;
    if (goes_to_a_file(options.json_file)) {
        auto prepared = ReportFile::prepare(options.json_file);
        if (!prepared) {
            fail(prepared.error());
            return kExitUsage;
        }
        file.emplace(std::move(*prepared));
    }
    asio::io_context io(1);
    const auto link = link_options(options);
    if (!link) return fail(link.error());
    const auto http = http_place(options, link->hello.token);
    if (!http) return fail(http.error());
    if (auto ok = check_descriptors(options); !ok) return fail(ok.error());
    console.passing("simulating the trajectory");
    const auto workload = record_workload(options);
    if (!workload) return fail(workload.error());

    LoadRun run(io, options, *workload, *link, *http, console);
    std::optional<Result<RunReport>> outcome; // absent if a second signal ended the run
    asio::co_spawn(io, obey_signals(io, run, console), asio::detached);
    asio::co_spawn(io, run.conduct(), [&](std::exception_ptr failed, Result<RunReport> result) {
        if (failed) std::rethrow_exception(failed);
        outcome = std::move(result);
        io.stop();
    });
    io.run();
    if (!outcome) return fail({Errc::kShuttingDown, "interrupted; not verified"});
    if (!*outcome) return fail(outcome->error());
    if (auto written = write_report(**outcome, options.json_file, file); !written) return fail(written.error());
    return (*outcome)->verdict.is_good ? kExitDone : kExitFailed;
}

} // namespace scanloom::load
