#pragma once

#include <sstream>
#include <stdexcept>

namespace xrds {

/// Throws std::logic_error that shows the failed expression and both values: a bug of ours, never of the user.
template <class A, class B>
[[noreturn]] void failCheck(const char* expression, const A& a, const B& b, const char* file, int line) {
  std::ostringstream text;
  text << file << ":" << line << ": expected " << expression << ", found " << +a << " and " << +b;
  throw std::logic_error(text.str());
}

}  // namespace xrds

// Its name alone: a package tells nothing of the folders that it was built in.
#ifdef __FILE_NAME__
#define XRDS_FILE __FILE_NAME__
#else
#define XRDS_FILE __FILE__
#endif

#define XRDS_CHECK_RELATION(a, op, b)                                                               \
  do {                                                                                              \
    const auto xrdsA = (a);                                                                         \
    const auto xrdsB = (b);                                                                         \
    if (!(xrdsA op xrdsB)) ::xrds::failCheck(#a " " #op " " #b, xrdsA, xrdsB, XRDS_FILE, __LINE__); \
  } while (false)
#define XRDS_CHECK_EQ(a, b) XRDS_CHECK_RELATION(a, ==, b)
#define XRDS_CHECK_LE(a, b) XRDS_CHECK_RELATION(a, <=, b)
#define XRDS_CHECK_LT(a, b) XRDS_CHECK_RELATION(a, <, b)
#define XRDS_CHECK(condition) XRDS_CHECK_EQ(static_cast<bool>(condition), true)
