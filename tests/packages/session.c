/// Feels a block that a live server deforms: comes down on it, presses 3 mm deep, slides. Writes the force of
/// each tick, and counts what this thread allocates while it ticks.
/// usage: session CLIENT SERVER KEY OUT.csv
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TICKS = 2000, NANOSECONDS = 2000000 };

static palpate_rendered rendered[TICKS];
static char error[512];

/// Whatever the libraries allocate comes through here.
static __thread long allocations;
void* __libc_malloc(size_t size);
void* malloc(size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

static void expect(int right, const char* what) {
  if (right) return;
  fprintf(stderr, "session: %s; %s\n", what, error);
  exit(1);
}

static palpate_tool_state hand_at(double t) {
  const double down = t < 1 ? t : 1;
  palpate_tool_state tool = {.struct_size = sizeof tool};
  tool.position[0] = t < 2 ? 0 : 0.005 * (1 - cos(3 * (t - 2)));
  tool.position[1] = 0.012 - 0.009 * down;
  return tool;
}

static void wait_for_tick(struct timespec* deadline) {
  deadline->tv_nsec += NANOSECONDS;
  if (deadline->tv_nsec >= 1000000000) {
    deadline->tv_nsec -= 1000000000;
    ++deadline->tv_sec;
  }
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, deadline, NULL);
}

int main(int argc, char** argv) {
  expect(argc == 5, "usage: session CLIENT SERVER KEY OUT.csv");
  palpate_session_options options = {
      .struct_size = sizeof options, .client_file = argv[1], .server = argv[2], .key_file = argv[3]};
  palpate_session* session = NULL;
  expect(palpate_session_open(&options, &session, error, sizeof error) == PALPATE_OK, "no session");

  struct timespec deadline;
  clock_gettime(CLOCK_MONOTONIC, &deadline);
  const long before = allocations;
  int pressed = 0;
  for (int i = 0; i < TICKS; ++i) {
    wait_for_tick(&deadline);
    palpate_tool_state tool = hand_at(1e-9 * NANOSECONDS * i);
    rendered[i].struct_size = sizeof rendered[i];
    expect(palpate_session_tick(session, &tool, &rendered[i]) == PALPATE_OK, "a tick failed");
    const int in_contact = (rendered[i].flags & PALPATE_IN_CONTACT) != 0;
    pressed += in_contact && rendered[i].normal[1] > 0.5 && rendered[i].force[1] > 0.3;
  }
  const long ticked = allocations - before;
  expect(before > 0, "allocations are not counted");
  expect(ticked == 0, "a tick allocated");
  expect(rendered[TICKS - 1].state == PALPATE_LIVE && rendered[TICKS - 1].fault == PALPATE_NO_FAULT, "not live");
  expect(pressed > TICKS / 10, "the block hardly pushed back");
  palpate_session_close(session);

  FILE* out = fopen(argv[4], "w");
  expect(out != NULL, "the forces cannot be written");
  fprintf(out, "tick,fx_n,fy_n,fz_n\n");
  for (int i = 0; i < TICKS; ++i)
    fprintf(out, "%d,%.17g,%.17g,%.17g\n", (int)rendered[i].tick, rendered[i].force[0], rendered[i].force[1],
            rendered[i].force[2]);
  expect(fclose(out) == 0, "the forces cannot be written");
  printf("session: %d ticks, %d of them pressed, %ld allocations\n", TICKS, pressed, ticked);
  return 0;
}
