#pragma once
/// What tests of the Falcon through both real programs need.
#include "tests/emulation/emulator.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

namespace palpate::test {

constexpr double kGoodCount = 4096;

/// A folder with a dummy image, a scene whose wall meets the grip at z = 120 mm, and a client file for the
/// Falcon.
struct Bench {
  TemporaryFolder folder;
  std::string scene, client, firmware;

  Bench() {
    std::string image;
    for (unsigned i = 0, x = 1; i < 8000; ++i)
      image += static_cast<char>((x = x * 1103515245u + 12345u) >> 16);
    firmware = folder.write("firmware.bin", image).string();
    folder.write("wall.msh",
                 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 -0.1 -0.1 0.015\n2 0.1 -0.1 0.015\n3 "
                 "0.1 0.1 0.015\n"
                 "4 -0.1 0.1 0.015\n5 -0.1 -0.1 0.115\n6 0.1 -0.1 0.115\n7 0.1 0.1 0.115\n8 -0.1 0.1 "
                 "0.115\n$EndNodes\n"
                 "$Elements\n5\n1 4 2 0 0 1 2 4 5\n2 4 2 0 0 3 4 2 7\n3 4 2 0 0 6 5 7 2\n4 4 2 0 0 8 7 5 4\n"
                 "5 4 2 0 0 2 4 5 7\n$EndElements\n");
    scene = folder
                .write("wall.toml",
                       "rate_hz = 1000\n[mesh]\nfile = \"wall.msh\"\n[deformation]\nmodel = "
                       "\"rigid\"\nstiffness = 800\n"
                       "[[tool]]\nradius = 0.005\n")
                .string();
    client = folder
                 .write("client.toml",
                        "rate_hz = 1000\nmethod = \"constant\"\n[device]\nname = \"falcon:2-1\"\n[falcon]\n"
                        "firmware = \"firmware.bin\"\ntorque_constant = 10000\n")
                 .string();
  }
};

/// The server of a scene, ready.
struct Wall {
  Process process;
  std::string address;
  explicit Wall(const Bench& bench) : Wall(bench.scene) {}
  explicit Wall(const std::string& scene) : process("sim_server", {"run", scene, "--listen", "127.0.0.1:0"}) {
    if (!process.wait_for("listening on ")) throw std::runtime_error(process.output());
    const std::string& said = process.output();
    const std::size_t begin = said.find("listening on ") + 13;
    address = said.substr(begin, said.find(' ', begin) - begin);
  }
};

inline bool homed(const nlohmann::json& state) {
  return state["homed"] == 7;
}

}  // namespace palpate::test
