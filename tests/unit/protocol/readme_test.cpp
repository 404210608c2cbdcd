// What protocol/README.md says of sizes is what the code writes.
#include <fstream>
#include <map>
#include <sstream>

#include "protocol/codec.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

using namespace palpate::protocol;

namespace {

/// The cells "payload" and "datagram" of the table of messages, by the name of the message.
std::map<std::string, std::pair<std::string, std::string>> sizes_published() {
  std::ifstream file(palpate::test::source_dir() + "/protocol/README.md");
  std::map<std::string, std::pair<std::string, std::string>> published;
  std::string line;
  while (std::getline(file, line) && line.find("## Messages") == std::string::npos) {
  }
  while (std::getline(file, line) && line.find("Numbers never change") == std::string::npos) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, '|');) row.push_back(cell);
    const auto bare = [](const std::string& s) {
      const std::size_t a = s.find_first_not_of(' '), b = s.find_last_not_of(' ');
      return a == std::string::npos ? std::string() : s.substr(a, b - a + 1);
    };
    if (row.size() >= 6) published[bare(row[2])] = {bare(row[4]), bare(row[5])};
  }
  return published;
}

std::size_t size_of(const Message& message) {
  std::array<std::byte, kMaxDatagram> bytes;
  return encode({1, 1}, message, bytes);
}

std::string range(std::size_t least, std::size_t most) {
  return least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most);
}

}  // namespace

TEST_CASE("the sizes in protocol/README.md are those of the code") {
  const auto published = sizes_published();
  ToolState all;
  all.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead | ToolState::kRequestsSurface |
              ToolState::kAsksPages;
  const std::map<std::string, std::pair<std::size_t, std::size_t>> sizes{
      {"Challenge", {size_of(Challenge{}), size_of(Challenge{})}},
      {"Welcome", {size_of(Welcome{}), size_of(Welcome{})}},
      {"Refuse", {size_of(Refuse{}), size_of(Refuse{})}},
      {"Bye", {size_of(Bye{}), size_of(Bye{})}},
      {"ToolState", {size_of(ToolState{}), size_of(all)}},
      {"ForceSample", {size_of(ForceSample{}), kMaxDatagram - kTagBytes}},  // the server fills it up to there
      {"Telemetry", {size_of(Telemetry{}), size_of(Telemetry{.laws = 8, .count = 24})}},
      {"Pointer", {size_of(Pointer{}), size_of(Pointer{})}},
      {"SurfacePage", {size_of(SurfacePage{}), size_of(SurfacePage{})}}};
  for (const auto& [name, size] : sizes) {
    CAPTURE(name);
    REQUIRE(published.contains(name));
    CHECK(published.at(name).first == range(size.first - kHeaderBytes, size.second - kHeaderBytes));
    CHECK(published.at(name).second == range(size.first, size.second));
  }
  CHECK(published.at("Hello").second == std::to_string(size_of(Hello{})));
}
