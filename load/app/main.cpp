#include "common/app/standard_streams.hpp"
#include "load/app/options.hpp"
#include "load/app/run.hpp"

#include <fmt/format.h>

#include <csignal>
#include <exception>

int main(int argc, char** argv) try {
    std::signal(SIGPIPE, SIG_IGN); // the reader of the output may close it
    scanloom::open_missing_standard_streams();
    const auto options = scanloom::load::parse_options(argc, argv);
    if (const auto* leave = std::get_if<scanloom::Leave>(&options)) {
        fmt::print(leave->code == scanloom::kExitDone ? stdout : stderr, "{}", leave->text);
        return leave->code;
    }
    return scanloom::load::run(std::get<scanloom::load::LoadOptions>(options));
} catch (const std::exception& error) {
    scanloom::standard_error().write(fmt::format("scanloom-load: {}\n", error.what()));
    return scanloom::kExitFailed;
}
