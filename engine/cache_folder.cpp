#include "engine/cache_folder.h"

#include "engine/cache_file.h"
#include "engine/environment.h"

#ifndef _WIN32
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace xrds {
namespace {

namespace fs = std::filesystem;

#ifdef _WIN32
bool makePrivate(const fs::path&) { return true; }  // temporary folders there are the user's own
#else
// A folder of this name may be another user's, who waits for us to run what he put there.
bool makePrivate(const fs::path& folder) {
  mkdir(folder.c_str(), S_IRWXU);
  struct stat found {};
  return lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == geteuid() &&
         (found.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}
#endif

std::string notice(const fs::path& asked, const fs::path& taken, const char* variable) {
  const std::string kept = taken.empty() ? "programs are compiled again at every start"
                                         : "compiled programs are kept in '" + taken.string() + "'";
  return "the cache folder '" + asked.string() + "' cannot be written: " + kept + "; make it writable, or let " +
         variable + " name another";
}

}  // namespace

bool canWriteFiles(const fs::path& folder) {
  const fs::path file = folder / ("probe-" + std::to_string(reinterpret_cast<uintptr_t>(&folder)));
  const bool written = writeCacheFile(file, "probe", {});
  std::error_code ignored;
  fs::remove(file, ignored);
  return written;
}

fs::path writableCacheFolder(const fs::path& asked, std::vector<std::string>& notes) {
  const fs::path temporary = temporaryCacheFolder();
  const auto writable = [&](const fs::path& folder) {
    return (folder != temporary || makePrivate(folder)) && canWriteFiles(folder);
  };
  const fs::path wanted = asked.empty() ? defaultCacheFolder() : asked;
  if (writable(wanted)) return wanted;
  const fs::path taken = writable(temporary) ? temporary : fs::path();
  notes.push_back(notice(wanted, taken, "XDG_CACHE_HOME"));
  return taken;
}

fs::path chooseCacheFolder(const fs::path& asked, std::vector<std::string>& notes) {
  const fs::path wanted = asked.empty() ? defaultCacheFolder() : asked;
  const fs::path users = usersShaderCacheFolder();
  const bool usersFits = users.empty() || canWriteFiles(users);
  const fs::path taken = writableCacheFolder(asked, notes);
  const bool wantedFits = taken == wanted;
  if (!usersFits) notes.push_back(notice(users, taken, "MESA_SHADER_CACHE_DIR"));
  // Where the width of vectors is Mesa's own choice, it would go on to use the folder that it cannot write.
  if (!taken.empty() && (!usersFits || (!wantedFits && users.empty()))) placeShaderCache(taken / "mesa");
  return taken;
}

}  // namespace xrds
