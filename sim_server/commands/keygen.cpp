#include "sim_server/commands/keygen.h"

#include <fmt/core.h>
#include <memory>

#include "protocol/key_file.h"

namespace palpate::sim {

int make_key(const std::filesystem::path& file, bool add) {
  const protocol::Key key = protocol::add_new_key(file, add);
  fmt::print(
      "key {} is in {} (mode 0600). Copy the file to the other machine by a safe way (scp -p), and give "
      "both\n"
      "programs --key {}. {}\n",
      key.number, file.string(), file.string(),
      add ? "Servers that have the file take all of its keys, clients use the newest; start both again, "
            "then\n"
            "delete the lines of old keys."
          : "`sim_server keygen --add` changes it later.");
  return 0;
}

Command keygen_command() {
  struct Requested {
    std::string file;
    bool add = false;
  };
  const auto requested = std::make_shared<Requested>();
  return {.name = "keygen",
          .summary = "Make a key, so that only who has it can push the motors",
          .footer =
              "Without a key, both programs talk on this machine only.\n"
              "Example: sim_server keygen palpate.key",
          .options = {{"FILE", "Key file to make, for both programs", &requested->file, {.required = true}},
                      {"--add", "Put a new key behind those in FILE, to change keys", &requested->add}},
          .run = [requested] { return make_key(requested->file, requested->add); }};
}

}  // namespace palpate::sim
