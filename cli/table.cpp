#include "cli/table.h"

#include <algorithm>
#include <cstdio>

namespace xrds {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string aligned(const std::vector<Row>& rows) {
  std::vector<size_t> widths(rows[0].size());
  for (const Row& row : rows)
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string lines;
  for (const Row& row : rows) {
    lines += row[0] + std::string(widths[0] - row[0].size(), ' ');
    for (size_t i = 1; i < row.size(); ++i) lines += "  " + std::string(widths[i] - row[i].size(), ' ') + row[i];
    lines += '\n';
  }
  return lines;
}

std::string markdown(const std::vector<Row>& rows) {
  std::string lines;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& cell : rows[i]) lines += "| " + cell + " ";
    lines += "|\n";
    if (i > 0) continue;
    for (size_t c = 0; c < rows[i].size(); ++c) lines += "|---";
    lines += "|\n";
  }
  return lines;
}

}  // namespace xrds
