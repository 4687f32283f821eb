#pragma once

// XRDS_API stands before what libxrds exports; all else stays inside. XRDS_STATIC: the library is linked statically.
#if !defined(_WIN32)
#define XRDS_API __attribute__((visibility("default")))
#elif defined(XRDS_BUILDS_LIBRARY)
#define XRDS_API __declspec(dllexport)
#elif defined(XRDS_STATIC)
#define XRDS_API
#else
#define XRDS_API __declspec(dllimport)
#endif
