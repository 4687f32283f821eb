#include "tests/cli/process.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace xrds::test {
namespace {

namespace fs = std::filesystem;

// The tests have caches of their own, but for Mesa's of machine code, which depends on the program and the driver
// alone: what the library's tests and a build before have compiled, which lies in the user's, is not compiled again.
void shareShaderCache() {
  const char *caches = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
  const fs::path users =
      caches && fs::path(caches).is_absolute() ? fs::path(caches) : fs::path(home ? home : "") / ".cache";
  std::error_code failed;  // then the tests compile for themselves
  for (const char* name : {"mesa_shader_cache", "xrds/mesa-w128", "xrds/mesa-w256", "xrds/mesa-w512"}) {
    const fs::path link = fs::path(XRDS_TEST_CACHE) / name;
    if (users.is_relative() || fs::symlink_status(link, failed).type() != fs::file_type::not_found) continue;
    fs::create_directories(link.parent_path(), failed);
    if (fs::create_directories(users / name, failed); fs::is_directory(users / name, failed))
      fs::create_directory_symlink(users / name, link, failed);
  }
}

[[noreturn]] void becomeXrds(const std::vector<std::string>& arguments, const StartOptions& options) {
  setenv("XDG_CACHE_HOME", XRDS_TEST_CACHE, 1);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
  if (options.fullOutput) dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO);
  if (options.largestFileBytes >= 0) {
    const rlimit limit{static_cast<rlim_t>(options.largestFileBytes), static_cast<rlim_t>(options.largestFileBytes)};
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
  }
  std::vector<char*> words{const_cast<char*>("xrds")};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(XRDS_PROGRAM, words.data());
  _exit(127);
}

int waitFor(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

// One read; false at the end of the stream (on a terminal that is an error).
bool append(int file, std::string& text) {
  char bytes[4096];
  const ssize_t count = read(file, bytes, sizeof bytes);
  if (count > 0) text.append(bytes, static_cast<size_t>(count));
  return count > 0;
}

}  // namespace

Ended runXrds(const std::vector<std::string>& arguments, const StartOptions& options) {
  int output[2], error[2];
  if (pipe2(output, O_CLOEXEC) != 0 || pipe2(error, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  shareShaderCache();
  const pid_t child = fork();
  if (child == 0) {
    dup2(output[1], STDOUT_FILENO);
    dup2(error[1], STDERR_FILENO);
    becomeXrds(arguments, options);
  }
  close(output[1]);
  close(error[1]);
  Ended ended;
  pollfd waiting[] = {{output[0], POLLIN, 0}, {error[0], POLLIN, 0}};
  std::string* texts[] = {&ended.output, &ended.error};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    poll(waiting, 2, -1);
    for (int i = 0; i < 2; ++i)
      if (waiting[i].revents != 0 && !append(waiting[i].fd, *texts[i])) waiting[i].fd = -1;
  }
  close(output[0]);
  close(error[0]);
  ended.exitCode = waitFor(child);
  return ended;
}

Ended killXrds(const std::vector<std::string>& arguments, const std::function<bool()>& due, const StartOptions& options,
               int signal) {
  shareShaderCache();
  const pid_t child = fork();
  if (child == 0) becomeXrds(arguments, options);
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0)
    if (due()) kill(child, signal);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status), "", ""};
}

Ended runOnTerminal(const std::vector<std::string>& arguments, const std::string& awaited, const std::string& keys,
                    const StartOptions& options) {
  int terminal = -1;
  shareShaderCache();
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) becomeXrds(arguments, options);
  Ended ended;
  bool typed = keys.empty();
  while (append(terminal, ended.output)) {
    if (typed || ended.output.find(awaited) == std::string::npos) continue;
    typed = true;
    if (write(terminal, keys.data(), keys.size()) < 0) break;
  }
  ended.exitCode = waitFor(child);
  close(terminal);
  return ended;
}

}  // namespace xrds::test
