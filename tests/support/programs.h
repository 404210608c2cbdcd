#pragma once
/// What system tests do with the real programs.
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"

namespace palpate::test {

inline const std::string kScene = source_dir() + "/configs/scenes/liver_paper.toml";
inline const std::string kClient = source_dir() + "/configs/clients/liver_paper.toml";

/// A server of the liver on a port of its own (or a given one), ready.
struct Server {
  Process process;
  std::string address;

  explicit Server(const std::vector<std::string>& more = {}, const std::string& listen = "127.0.0.1:0",
                  const std::string& scene = kScene)
      : process("sim_server", arguments(scene, listen, more)) {
    if (!process.wait_for("listening on ")) throw std::runtime_error("no server: " + process.output());
    const std::string& said = process.output();
    const std::size_t begin = said.find("listening on ") + 13;
    address = said.substr(begin, said.find(' ', begin) - begin);
  }
  static std::vector<std::string> arguments(const std::string& scene, const std::string& listen,
                                            const std::vector<std::string>& more) {
    std::vector<std::string> all{"run", scene, "--listen", listen};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

/// Arguments of a client with the motion that ships.
inline std::vector<std::string> client_arguments(const std::string& server,
                                                 const std::vector<std::string>& more) {
  std::vector<std::string> all{"run", kClient, "--server", server};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// Runs a program to its end, checks its exit code and returns what it said.
inline std::string output_of(const std::string& program, const std::vector<std::string>& arguments,
                             int expected_code, double seconds = 60) {
  Process process(program, arguments);
  const int code = process.wait(seconds);
  CAPTURE(program, arguments, process.output());
  CHECK(code == expected_code);
  return process.output();
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline nlohmann::json read_json(const std::filesystem::path& file) {
  return nlohmann::json::parse(bytes_of(file));
}

}  // namespace palpate::test
