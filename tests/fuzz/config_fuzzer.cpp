#include "common/app/settings.hpp"
#include "tests/fuzz/check.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <sstream>

/// Input: a file of --config, read into options of every kind that the programs have.
SCANLOOM_FUZZER(config)(const std::uint8_t* data, std::size_t size) {
    namespace fuzz = scanloom::fuzz;
    const std::string text(reinterpret_cast<const char*>(data), size);
    const auto lines = scanloom::one_line_a_setting(text);
    fuzz::check(lines ? lines->size() <= text.size() : !lines.error().message.empty(),
                "comments are removed and nothing is added, or the error has a message");

    CLI::App app("a program", "program");
    std::string word;
    double number = 0.0;
    unsigned count = 0;
    bool flag = false;
    std::vector<std::string> words;
    app.add_option("--store", word);
    app.add_option("--cell-size", number)->check(CLI::Range(0.001, 10.0));
    app.add_option("--threads", count);
    app.add_flag("--insecure", flag);
    app.add_option("--http-host", words);
    app.add_subcommand("simulate", "a subcommand")->add_option("--seed", count);
    scanloom::read_settings_from_environment_and_file(app);
    std::istringstream file(text);
    try {
        app.parse_from_stream(file);
    } catch (const CLI::ParseError& refused) {
        fuzz::check(std::string_view(refused.what()).size() > 0, "every refusal has a message");
    }
    return 0;
}
