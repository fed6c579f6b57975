#include "common/app/standard_streams.hpp"
#include "lab/options.hpp"
#include "lab/run.hpp"

#include <fmt/format.h>

#include <csignal>
#include <exception>

int main(int argc, char** argv) try {
    std::signal(SIGPIPE, SIG_IGN); // the reader of the output may close it
    scanloom::open_missing_standard_streams();
    const auto options = scanloom::lab::parse_options(argc, argv);
    if (const auto* leave = std::get_if<scanloom::Leave>(&options)) {
        fmt::print(leave->code == scanloom::kExitDone ? stdout : stderr, "{}", leave->text);
        return leave->code;
    }
    return std::visit([](const auto& chosen) { return scanloom::lab::run(chosen); },
                      std::get<scanloom::lab::Options>(options));
} catch (const std::exception& error) {
    scanloom::standard_error().write(fmt::format("scanloom-lab: {}\n", error.what()));
    return scanloom::kExitFailed;
}
