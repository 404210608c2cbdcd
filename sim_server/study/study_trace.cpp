// Traces in files, and processes of their own.
#include <algorithm>
#include <csignal>
#include <cstring>
#include <fstream>
#include <malloc.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "common/interrupt.h"
#include "common/memory_budget.h"
#include "common/report.h"
#include "sim_server/study/study_run.h"

namespace palpate::sim {
namespace {

constexpr std::uint64_t kMagic = 0x31656361'72745050;  // "PPtrace1"

/// Reads or writes one thing after another, as bytes of this machine: a cache, not a format.
struct Writer {
  std::ofstream file;
  template <class T>
  void number(const T& value) {
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void list(const std::vector<T>& values) {
    number(values.size());
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(T)));
  }
};
struct Reader {
  std::ifstream file;
  std::uintmax_t size;
  template <class T>
  void number(T& value) {
    file.read(reinterpret_cast<char*>(&value), sizeof value);
  }
  template <class T>
  void list(std::vector<T>& values) {
    std::size_t count = 0;
    number(count);
    if (!file || count > size / sizeof(T)) return file.setstate(std::ios::failbit);
    values.resize(count);
    file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  }
};

template <class File, class T>
void pass(File& file, T& trace) {
  file.number(trace.dt);
  file.list(trace.places);
  file.list(trace.forces);
  file.list(trace.tangents);
  file.list(trace.moved);
  file.number(trace.sites);
  file.number(trace.flagged);
  file.number(trace.tetrahedra);
  file.number(trace.nodes);
  file.number(trace.state_hash);
  file.number(trace.setup_ms);
  file.number(trace.step_ms_p50);
  file.number(trace.step_ms_p99);
  file.number(trace.peak_bytes);
}

}  // namespace

void write_trace(const std::filesystem::path& path, const Trace& trace) {
  AtomicFile atomic_file(path, Contents::kTable);
  Writer writer{std::ofstream(atomic_file.path(), std::ios::binary)};
  writer.number(kMagic);
  pass(writer, trace);
  writer.number(kMagic);
  writer.file.close();
  if (!writer.file) fail_at_run_time("{}: cannot be written", path.string());
  atomic_file.commit();
}

std::optional<Trace> read_trace(const std::filesystem::path& path) {
  std::error_code none;
  Reader reader{std::ifstream(path, std::ios::binary), std::filesystem::file_size(path, none)};
  std::uint64_t first = 0, last = 0;
  Trace trace;
  reader.number(first);
  if (!reader.file || first != kMagic) return {};
  pass(reader, trace);
  reader.number(last);
  if (!reader.file || last != kMagic) return {};
  return trace;
}

namespace {

/// Does `work` in the child, and reports what went wrong.
[[noreturn]] void separate_work(int out, const std::function<void()>& work) {
  sigset_t all;
  sigfillset(&all);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_DFL);
  sigprocmask(SIG_UNBLOCK, &all, nullptr);  // Ctrl-C ends it at once
  prctl(PR_SET_PDEATHSIG, SIGKILL);         // an interrupted study leaves nobody behind
  int code = 0;
  try {
    work();
  } catch (const std::exception& error) {
    const auto* const known = dynamic_cast<const Error*>(&error);
    code = known != nullptr ? known->exit_code() : 1;
    if (write(out, error.what(), std::strlen(error.what())) < 0) code = 1;
  }
  _exit(code);
}

/// Returns what the child says until it ends; nothing where Ctrl-C came first.
std::optional<std::string> hear(int in) {
  constexpr int kPollPeriod = 100;  // ms
  std::string text(4096, '\0');
  std::size_t length = 0;
  pollfd waiting{in, POLLIN, 0};
  while (length < text.size()) {
    if (wait_for_interrupt(Time::zero())) return {};
    if (poll(&waiting, 1, kPollPeriod) <= 0) continue;
    const ssize_t got = read(in, text.data() + length, text.size() - length);
    if (got <= 0) break;
    length += static_cast<std::size_t>(got);
  }
  text.resize(length);
  return text;
}

}  // namespace

double run_separately(const std::string& name, const std::function<void()>& work) {
  malloc_trim(0);  // what is free here is not the child's
  const double inherited = resident_memory();
  int said[2];
  if (pipe(said) != 0) fail_at_run_time("{}: no pipe: {}", name, std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) fail_at_run_time("{}: no process: {}", name, std::strerror(errno));
  if (child == 0) {
    close(said[0]);
    separate_work(said[1], work);
  }
  close(said[1]);
  const std::optional<std::string> text = hear(said[0]);
  close(said[0]);
  if (!text) kill(child, SIGKILL);
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (!text || signal == SIGINT || signal == SIGTERM || signal == SIGHUP)
    fail_at_run_time("{}: interrupted; the same command goes on from there", name);
  if (signal != 0)
    throw CaseFailed(fmt::format("{}: ended by signal {}{}", name, signal,
                                 signal == SIGKILL ? ", as where memory runs out" : ""),
                     Error::Kind::kRun);
  if (WEXITSTATUS(status) != 0)
    throw WEXITSTATUS(status) == 2 ? CaseFailed(*text)
                                   : CaseFailed(fmt::format("{}: {}", name, *text), Error::Kind::kRun);
  return std::max(0.0, 1024.0 * static_cast<double>(used.ru_maxrss) - inherited);
}

}  // namespace palpate::sim
