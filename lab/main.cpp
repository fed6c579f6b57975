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
    if (const auto* landmarks = std::get_if<scanloom::lab::LandmarkOptions>(&options)) {
        return scanloom::lab::run(*landmarks);
    }
    if (const auto* score = std::get_if<scanloom::lab::ScoreOptions>(&options)) return scanloom::lab::run(*score);
    return scanloom::lab::run(std::get<scanloom::lab::ExperimentOptions>(options));
} catch (const std::exception& error) {
    scanloom::standard_error().write(fmt::format("scanloom-lab: {}\n", error.what()));
    return scanloom::kExitFailed;
}
