#pragma once

#include <string>

namespace xrds {

/// Throws Failure with ExitCode::usage unless the name ends in `extension` (".exr"), in upper or lower case. `option`
/// is what the user knows it by.
void requireExtension(const std::string& path, const std::string& extension, const char* option);

/// Throws Failure with ExitCode::output unless a file of this name can be written: asked before a long computation,
/// not after it. Creates a temporary file in the folder and removes it.
void requireWritable(const std::string& path);

/// Both of a file that an option names, if it is given: its name ends in `extension`, and it can be written.
void requireOutput(const std::string& path, const std::string& extension, const char* option);

/// Writes a text file, whole or not at all. Throws Error if it cannot be written.
void writeText(const std::string& path, const std::string& text);

}  // namespace xrds
