#include "lab/document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace scanloom::lab {
namespace {

std::string row_text(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

std::string markdown_of(const Heading& heading) {
    return fmt::format("{} {}\n", std::string(static_cast<std::size_t>(heading.level), '#'), heading.text);
}

std::string markdown_of(const Paragraph& paragraph) { return paragraph.text + "\n"; }

std::string markdown_of(const Items& items) {
    std::string text;
    for (const std::string& item : items.texts) text += fmt::format("- {}\n", item);
    return text;
}

std::string markdown_of(const Code& code) { return fmt::format("```sh\n{}\n```\n", code.text); }

std::string markdown_of(const Link& link) { return fmt::format("[{}]({}.md)\n", link.text, link.file); }

std::string markdown_of(const Table& table) {
    std::string text = row_text(table.head);
    text += row_text(std::vector<std::string>(table.head.size(), "---"));
    for (const auto& row : table.rows) text += row_text(row);
    return text;
}

std::string markdown_of(const Picture& picture) {
    return fmt::format("![{}]({})\n\n*{}*\n", picture.caption, picture.file, picture.caption);
}

} // namespace

std::string to_markdown(const Document& document) {
    std::string text;
    for (const Block& block : document) {
        if (!text.empty()) text += '\n';
        text += std::visit([](const auto& content) { return markdown_of(content); }, block);
    }
    return text;
}

} // namespace scanloom::lab
