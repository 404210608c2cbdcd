/// As scene.c, of a scene with friction, and from C++: every wrong use is answered with an error, and changes
/// nothing.
/// usage: scene_cpp SCENE CAPTURE
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <palpate.h>
#include <string>

namespace {

char error[512];

void expect(bool right, const char* what) {
  if (right) return;
  std::fprintf(stderr, "scene_cpp: %s; %s\n", what, error);
  std::exit(1);
}

template <class Struct>
Struct sized() {
  Struct s{};
  s.struct_size = sizeof s;
  return s;
}

/// Refused as wrong input, with a sentence that names `word`.
void expect_wrong(int code, const char* word) {
  expect(code == PALPATE_WRONG_INPUT, word);
  expect(std::strstr(error, word) != nullptr, word);
}

struct Closer {
  void operator()(palpate_scene* s) const { palpate_scene_close(s); }
  void operator()(palpate_capture* c) const { palpate_capture_close(c); }
};
using Scene = std::unique_ptr<palpate_scene, Closer>;
using Capture = std::unique_ptr<palpate_capture, Closer>;

Scene open_scene(const char* file) {
  palpate_scene* scene = nullptr;
  expect(palpate_scene_open(file, &scene, error, sizeof error) == PALPATE_OK, "no scene");
  return Scene(scene);
}

Capture open_capture(const char* file) {
  palpate_capture* capture = nullptr;
  expect(palpate_capture_open(file, &capture, error, sizeof error) == PALPATE_OK, "no capture");
  return Capture(capture);
}

void check_wrong_steps(palpate_scene* scene, palpate_tool_state tool) {
  auto sample = sized<palpate_force_sample>();
  const auto step = [&](palpate_scene* s, std::size_t count, double dt) {
    return palpate_scene_step(s, &tool, count, dt, &sample, error, sizeof error);
  };
  expect_wrong(step(nullptr, 1, 0), "scene");
  expect_wrong(step(scene, 2, 0), "count");
  expect_wrong(step(scene, 1, std::nan("")), "dt");
  expect_wrong(step(scene, 1, -1), "dt");
  expect_wrong(palpate_scene_step(scene, nullptr, 1, 0, &sample, error, sizeof error), "tools");
  expect_wrong(palpate_scene_step(scene, &tool, 1, 0, nullptr, error, sizeof error), "samples");
  tool.position[1] = HUGE_VAL;
  expect_wrong(step(scene, 1, 0), "not finite");
  tool.position[1] = 0;
  tool.orientation[0] = 2;
  expect_wrong(step(scene, 1, 0), "quaternion");
  tool.struct_size = 0;
  expect_wrong(step(scene, 1, 0), "struct_size");
  expect(palpate_scene_step(nullptr, nullptr, 0, 0, nullptr, nullptr, 0) == PALPATE_WRONG_INPUT, "no text");
}

void check_wrong_files(const char* text_file) {
  palpate_scene* scene = nullptr;
  palpate_capture* capture = nullptr;
  expect_wrong(palpate_scene_open("nowhere.toml", &scene, error, sizeof error), "nowhere.toml");
  expect_wrong(palpate_scene_open(nullptr, &scene, error, sizeof error), "NULL");
  expect_wrong(palpate_capture_open(text_file, &capture, error, sizeof error), text_file);
  expect(scene == nullptr && capture == nullptr, "a handle without a file");
  expect(
      palpate_scene_open("nowhere.toml", &scene, error, 5) == PALPATE_WRONG_INPUT && std::strlen(error) == 4,
      "a text beyond its room");
  expect(palpate_scene_tools(nullptr) == 0, "tools of nothing");
  expect_wrong(palpate_capture_next(nullptr, nullptr, nullptr, nullptr, error, sizeof error), "capture");
}

void check_wrong_sessions() {
  auto options = sized<palpate_session_options>();
  palpate_session* session = nullptr;
  const auto open = [&] { return palpate_session_open(&options, &session, error, sizeof error); };
  options.server = "192.0.2.2:45130";
  expect_wrong(open(), "key");  // another machine
  options.server = "127.0.0.1:1";
  options.method = "magic";
  expect_wrong(open(), "magic");
  options.method = nullptr;
  options.max_force = -1;
  expect_wrong(open(), "max_force");
  options.max_force = 0;
  expect(open() == PALPATE_FAILED && std::strlen(error) > 0, "a session without a server");
  expect(session == nullptr, "a handle without a server");
  auto rendered = sized<palpate_rendered>();
  const auto tool = sized<palpate_tool_state>();
  expect(palpate_session_tick(nullptr, &tool, &rendered) == PALPATE_WRONG_INPUT, "a tick of nothing");
  expect(palpate_session_rearm(nullptr) == PALPATE_WRONG_INPUT, "nothing is armed");
  palpate_session_close(nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  expect(argc == 3, "usage: scene_cpp SCENE CAPTURE");
  check_wrong_files(argv[1]);
  const Scene scene = open_scene(argv[1]);
  const Capture capture = open_capture(argv[2]);
  std::map<std::uint64_t, palpate_tool_state> states;  // by tick
  auto state = sized<palpate_tool_state>();
  auto recorded = sized<palpate_force_sample>(), stepped = recorded;
  auto datagram = sized<palpate_datagram>();
  std::int64_t now = 0;
  int samples = 0, rubbed = 0;
  while (palpate_capture_next(capture.get(), &datagram, &state, &recorded, error, sizeof error) ==
             PALPATE_OK &&
         datagram.type != PALPATE_END) {
    if (datagram.type == PALPATE_TOOL_STATE) states[state.tick] = state;
    if (datagram.type != PALPATE_FORCE_SAMPLE) continue;
    const palpate_tool_state& tool = states[recorded.tick];
    if (samples++ % 20 == 0) check_wrong_steps(scene.get(), tool);
    const double dt = 1e-9 * static_cast<double>(tool.time_ns - now);
    now = tool.time_ns;
    expect(palpate_scene_step(scene.get(), &tool, 1, dt, &stepped, error, sizeof error) == PALPATE_OK,
           "no step");
    expect(std::memcmp(stepped.force, recorded.force, sizeof stepped.force) == 0, "a force is another");
    rubbed += std::abs(stepped.force[0]) > 0.02 ? 1 : 0;
  }
  expect(rubbed > 10, "the tool hardly rubbed");
  check_wrong_sessions();
  std::printf("scene_cpp: %d samples, %d with friction, the same forces\n", samples, rubbed);
}
