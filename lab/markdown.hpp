#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Reports are Markdown. lab/reports has their texts, with names in braces where figures, tables and pictures belong.
namespace scanloom::lab {

/// A table. Head and rows are cells separated by " | ".
class Table {
public:
    explicit Table(std::string_view head);

    /// Adds a row. A formatted argument may contain several cells.
    /// Pre: the row has as many cells as the head.
    template <class... Args>
    void add(fmt::format_string<Args...> row, Args&&... cells) {
        add_row(fmt::format(row, std::forward<Args>(cells)...));
    }

    /// Returns the table as Markdown, without a newline at the end.
    [[nodiscard]] const std::string& text() const noexcept { return text_; }

private:
    void add_row(std::string_view cells);

    std::size_t bars_;
    std::string text_;
};

inline constexpr const char* kPicturesFolder = "pictures"; ///< in the folder of the report

/// Returns a picture with its caption.
/// @param file  name in the folder for pictures
[[nodiscard]] std::string picture(std::string_view file, std::string_view caption);

/// Returns a picture for a cell of a table.
/// @param file  name in the folder for pictures
[[nodiscard]] std::string picture_cell(std::string_view file, std::string_view caption);

/// Returns a list with an item for each text.
[[nodiscard]] std::string items(const std::vector<std::string>& texts);

/// Formats the range of some values: "1.20 to 3.40", "1.20" if they are equal, "nothing" if there are none.
[[nodiscard]] std::string range_text(std::span<const double> values, int digits = 2);

/// Converts the Markdown of a report to one page without scripts that loads only its pictures. The first heading is the
/// title. Understands blocks separated by an empty line: headings, paragraphs, lists, code, tables (also of pictures),
/// pictures with their captions, and links to other reports (.md, here .html).
[[nodiscard]] std::string to_html(std::string_view markdown);

} // namespace scanloom::lab
