#pragma once
/// A server with its live page, for tests that look at it.
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/web_page.h"

namespace palpate::test {

/// A server of the paper's liver with its page.
struct Watched : Server {
  PageAddress page;
  explicit Watched(std::vector<std::string> more = {})
      : Server([&] {
          more.insert(more.end(), {"--viewer", "0"});
          return more;
        }()),
        page(PageAddress::of(process)) {}
  std::string get(const std::string& path, const std::string& host = {},
                  const std::string& method = "GET") const {
    return answer_to(page.port, method + " " + path + " HTTP/1.1\r\nHost: " +
                                    (host.empty() ? page.host() : host) + "\r\nConnection: close\r\n\r\n");
  }
  long resident_kb() const {
    std::ifstream file("/proc/" + std::to_string(process.id()) + "/statm");
    long all = 0, resident = 0;
    file >> all >> resident;
    return resident * 4;
  }
  /// Time of a processor that the server has taken so far, s, of all its threads.
  double processor_s() const {
    std::ifstream file("/proc/" + std::to_string(process.id()) + "/stat");
    std::string all((std::istreambuf_iterator<char>(file)), {}), word;
    std::istringstream fields(all.substr(all.rfind(')') + 2));
    long user = 0, system = 0;
    for (int k = 0; k < 11; ++k) fields >> word;  // from the third on, to the fourteenth
    fields >> user >> system;
    return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
};

inline int status_of(const std::string& answer) {
  return answer.starts_with("HTTP/1.1 ") ? std::stoi(answer.substr(9, 3)) : 0;
}
inline std::string body_of(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}
inline std::string dist(const std::string& file) {
  return bytes_of(std::filesystem::path(source_dir()) / "sim_server/viewer/page/dist" / file);
}

}  // namespace palpate::test
