/// Steps a scene that moves by itself along a motion that `sim_server record` captured, and holds each force against the captured
/// one, bit by bit.
/// usage: scene SCENE CAPTURE
#include <inttypes.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TICKS = 100000 };

static palpate_tool_state states[MOST_TICKS];  // by tick
static char error[512];

static void expect(int right, const char* what) {
  if (right) return;
  fprintf(stderr, "scene: %s; %s\n", what, error);
  exit(1);
}

/// The next force sample of the capture; the tool states on the way go into the table. 0 at the end.
static int next_sample(palpate_capture* capture, palpate_force_sample* sample) {
  palpate_datagram datagram = {.struct_size = sizeof datagram};
  palpate_tool_state state = {.struct_size = sizeof state};
  do {
    int code = palpate_capture_next(capture, &datagram, &state, sample, error, sizeof error);
    expect(code == PALPATE_OK, "the capture cannot be read");
    if (datagram.type == PALPATE_TOOL_STATE && state.tick < MOST_TICKS) states[state.tick] = state;
    if (datagram.type == PALPATE_END) return 0;
  } while (datagram.type != PALPATE_FORCE_SAMPLE);
  expect(datagram.direction == PALPATE_TO_CLIENT, "a force sample goes to the server");
  return 1;
}

int main(int argc, char** argv) {
  expect(argc == 3, "usage: scene SCENE CAPTURE");
  palpate_scene* scene = NULL;
  palpate_capture* capture = NULL;
  expect(palpate_scene_open(argv[1], &scene, error, sizeof error) == PALPATE_OK, "no scene");
  expect(palpate_scene_tools(scene) == 1, "the scene has not one tool");
  expect(palpate_capture_open(argv[2], &capture, error, sizeof error) == PALPATE_OK, "no capture");

  palpate_force_sample recorded = {.struct_size = sizeof recorded}, stepped = {.struct_size = sizeof stepped};
  int samples = 0, contacts = 0;
  int64_t now = 0;
  for (; next_sample(capture, &recorded); ++samples) {
    palpate_tool_state state = states[recorded.tick];
    expect(state.tick == recorded.tick, "a sample answers no tool state");
    state.struct_size = sizeof state;
    state.flags |= PALPATE_WANTS_TANGENT;
    double dt = 1e-9 * (double)(state.time_ns - now);
    now = state.time_ns;
    int code = palpate_scene_step(scene, &state, 1, dt, &stepped, error, sizeof error);
    expect(code == PALPATE_OK, "the scene does not step");
    expect(memcmp(stepped.force, recorded.force, sizeof stepped.force) == 0, "a force is another");
    expect(memcmp(stepped.tangent, recorded.tangent, sizeof stepped.tangent) == 0, "a tangent is another");
    contacts += (stepped.flags & PALPATE_IN_CONTACT) != 0;
  }
  expect(contacts > 10, "the tool hardly touched");
  printf("scene: %d samples, %d in contact, the same forces and tangents\n", samples, contacts);
  palpate_capture_close(capture);
  palpate_scene_close(scene);
  return 0;
}
