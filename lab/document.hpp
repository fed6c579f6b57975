#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// A report as plain values, so that its two formats have the same content.
namespace scanloom::lab {

struct Heading {
    int level = 1;
    std::string text;
};
struct Paragraph {
    std::string text;
};
struct Items {
    std::vector<std::string> texts;
};
struct Code {
    std::string text;
};
struct Link {
    std::string text;
    std::string file; ///< without its extension: Markdown links to .md, HTML to .html
};
/// Numbers and short words; every row has as many cells as the head.
struct Table {
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};
struct Picture {
    std::string file; ///< relative to the report
    std::string caption;
};

/// Joins two parts of a row.
[[nodiscard]] inline std::vector<std::string> joined(std::vector<std::string> front,
                                                     const std::vector<std::string>& back) {
    front.insert(front.end(), back.begin(), back.end());
    return front;
}

/// Formats the range of some values: "1.20 to 3.40", "1.20" if they are equal, "nothing" if there are none.
[[nodiscard]] std::string range_text(std::span<const double> values, int digits = 2);

using Block = std::variant<Heading, Paragraph, Items, Code, Link, Table, Picture>;
using Document = std::vector<Block>;

/// Formats a document as Markdown for GitHub and GitLab. Texts are not escaped.
[[nodiscard]] std::string to_markdown(const Document& document);

/// Formats a document as one page without scripts that loads only its pictures.
[[nodiscard]] std::string to_html(const Document& document, std::string_view title);

} // namespace scanloom::lab
