#pragma once

#include <string>
#include <vector>

namespace xrds {

/// The cells of one row of a table; the first row of a table is its head, and all rows have as many cells.
using Row = std::vector<std::string>;

/// The number in a printf format such as "%.3f".
std::string text(const char* format, double value);

/// For a terminal: the first column to the left, the others to the right.
std::string aligned(const std::vector<Row>& rows);

/// As a Markdown table.
std::string markdown(const std::vector<Row>& rows);

}  // namespace xrds
