#ifndef PALPATE_H
#define PALPATE_H
/// Palpate from C, C++ and whatever calls C. Two libraries, of which a program takes what it needs:
///   libpalpate-client   palpate_session_*, to feel a scene that `sim_server run` serves, with a device of
///                       your own; palpate_capture_*, to read captures
///   libpalpate-sim      palpate_scene_*, to open a scene in your own process and step it
///
/// Units: m, s, N, N m; times called _ns are nanoseconds. Frames: the world W is that of the mesh file at
/// rest; the device frame D is that of your device, and [workspace] of the client file says how it lies in
/// W. Forces act on the tool.
///
/// Errors: functions return PALPATE_OK, PALPATE_FAILED or PALPATE_WRONG_INPUT, and where they take `error`
/// and `error_size`, a sentence that says what, where and what to do; empty with PALPATE_OK; both may be 0.
/// No exception, signal or abort leaves them. A handle that is NULL is wrong input; to close it does nothing.
///
/// Threads: different handles may be used at the same time. A handle is for one thread at a time, but where a
/// function says otherwise. Only palpate_session_tick and palpate_session_rearm are for a haptic loop: they
/// never allocate, lock, wait, log or throw. All others may allocate; the open functions may take seconds,
/// and print warnings about their files on stderr.
///
/// Structs: set `struct_size` to sizeof before each call, and what you do not use to 0. Later releases only
/// append fields.
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/// The exit codes of the programs.
enum {
  PALPATE_OK = 0,
  PALPATE_FAILED = 1,      ///< at run time: no answer, no memory
  PALPATE_WRONG_INPUT = 2  ///< a file, an argument
};

/// Bits of `flags` of a tool state.
enum {
  PALPATE_LOST = 1,           ///< nothing is known of the place: the tool touches nothing, no force follows
  PALPATE_REARMED = 2,        ///< captured only: a latched fault was cleared
  PALPATE_CLUTCHED = 4,       ///< captured only: the tool stays while the hand moves
  PALPATE_WANTS_TANGENT = 8,  ///< to a scene: asks for PALPATE_HAS_TANGENT
  PALPATE_HAS_VELOCITY = 1 << 16  ///< `velocity` is known; without, it is taken from the positions
};

/// State of a tool: sent to a session (frame D) or a scene (frame W), or read from a capture (W).
typedef struct palpate_tool_state {
  uint32_t struct_size;
  uint32_t flags;
  uint32_t buttons;        ///< one bit each, 16 of them
  uint32_t tool;           ///< captured: which of the scene
  double position[3];      ///< of the tool's tip, m
  double velocity[3];      ///< m/s
  double orientation[4];   ///< unit quaternion w, x, y, z; all 0: not turned
  int64_t time_ns;         ///< captured: when the device was read, on the client's clock
  uint64_t tick;           ///< captured: of the client, from 1
  uint64_t newest_sample;  ///< captured: number of the newest sample that the client had
} palpate_tool_state;

/// Bits of `flags` of a force sample.
enum {
  PALPATE_IN_CONTACT = 1,
  PALPATE_FLAGGED = 2,      ///< the step found no settled answer; the force is the best there is
  PALPATE_HAS_TANGENT = 4,  ///< `normal`, `gap`, `tangent` and `surface_velocity` are known
  PALPATE_HAS_MEAN = 256    ///< `mean_force` is known: contact is solved several times a step
};

/// The force that the simulation computed for a tool state; all in W. No limit was put to it: what goes to
/// motors comes from palpate_session_tick.
typedef struct palpate_force_sample {
  uint32_t struct_size;
  uint32_t flags;
  uint32_t tool;
  uint32_t reserved;
  uint64_t number;             ///< from 1
  uint64_t tick;               ///< of the tool state that it answers, as are:
  int64_t time_ns;             ///< on the client's clock; of a scene: since it began
  double position[3];          ///< m
  double force[3];             ///< N
  double torque[3];            ///< about the tip, N m
  double normal[3];            ///< of the surface near the tool, towards it, unit; 0: none near
  double gap;                  ///< between surface and tool, m; 0 in contact
  double tangent[9];           ///< dF/dp, N/m, symmetric; free of contact: as it will be
  double surface_velocity[3];  ///< of the organ near the tool, by its supports alone, m/s
  double mean_force[3];        ///< over the step, N
  int64_t step_ns;             ///< captured: that the server spent on the step
} palpate_force_sample;

/* ---- A scene in your own process: libpalpate-sim ---- */

typedef struct palpate_scene palpate_scene;

/// Reads a scene file and sets it up. Keeps nothing on disk. `*scene` is NULL unless it returns PALPATE_OK.
PALPATE_API int palpate_scene_open(const char* file, palpate_scene** scene, char* error, size_t error_size);

/// Returns the number of tools of the scene, 1 to 8; 0 of NULL. Any thread.
PALPATE_API size_t palpate_scene_tools(const palpate_scene* scene);

/// Steps by `dt` s, 0 to 3600, rounded to an integer number of ns, without a clock: equal arguments return
/// equal bytes. `tools` and `samples`: one for each tool of the scene, in its order; lift a tool with
/// PALPATE_LOST. Tissue in motion (`tensor_mass`, `hybrid`, `reduced`, `implicit`) goes in steps of one
/// length: there, `dt` other than 0 and 1 / rate_hz of the scene (within 1e-5 of it) is wrong input. A value
/// that is not finite, or beyond 1e9, is wrong input, and nothing happens. Uses both cores of large models.
/// Allocates with the model `implicit`, and with any model of tissue that can be cut.
PALPATE_API int palpate_scene_step(palpate_scene* scene, const palpate_tool_state* tools, size_t count,
                                   double dt, palpate_force_sample* samples, char* error, size_t error_size);

PALPATE_API void palpate_scene_close(palpate_scene* scene);

/* ---- A session with a server: libpalpate-client ---- */

typedef struct palpate_session palpate_session;

/// NULL where a text is not given: what the client file says, else its default.
typedef struct palpate_session_options {
  uint32_t struct_size;
  uint32_t insecure;        ///< 1: leave this machine without a key
  const char* client_file;  ///< TOML; its device, operator, trajectory, rate and scores are not used
  const char* server;       ///< "ADDR:PORT"
  const char* key_file;     ///< the key that the server has; see `sim_server keygen`
  const char* method;       ///< the law; `haptic_client run --help` lists them
  double max_force;         ///< N, above 0: lowers [limits] force; 0: does not
} palpate_session_options;

/// Values of `state`.
enum {
  PALPATE_WAITING = 0,  ///< no sample yet
  PALPATE_LIVE = 1,     ///< the newest sample is not older than 300 ms
  /// Newest sample older than 300 ms, as while a page pauses the simulation. The force fades to none, and
  /// rises again by itself over 1 s.
  PALPATE_SILENT = 2
};

/// Values of `fault`: why the force is latched off, until palpate_session_rearm.
enum {
  PALPATE_NO_FAULT = 0,
  PALPATE_NOT_FINITE = 1,  ///< some stage made a NaN or an infinity
  PALPATE_STORM = 2,       ///< the slew limit was at work over half of 1 s: something oscillates
  PALPATE_WILD = 3         ///< over 100 times the largest force was asked for, 0.5 s long
};

/// The force of one tick with what it is made of; all in D.
typedef struct palpate_rendered {
  uint32_t struct_size;
  uint32_t state;
  uint32_t fault;
  uint32_t flags;   ///< of the newest sample
  uint64_t tick;    ///< from 1
  uint64_t sample;  ///< number of the newest sample; 0: none yet
  double
      force[3];  ///< N, behind passivity, watchdog and limiter: write this, and nothing else, to the motors
  double law_newton;  ///< magnitude of the law's force before them
  double gain;        ///< share of the wall's stiffness that passivity leaves, (0, 1]
  double age;         ///< s since the tool was at the place of the newest sample; -1: none yet
  double normal[3];   ///< of the surface near the tool, at the newest sample; 0: none near, or not known
  double gap;         ///< from there to the tool, at the newest sample, m
} palpate_rendered;

/// Former name of palpate_rendered, for one release more.
#if defined(__GNUC__)
typedef palpate_rendered palpate_felt __attribute__((deprecated("write palpate_rendered")));
#else
typedef palpate_rendered palpate_felt;
#endif

/// Connects to a server, which gives the session a tool of its scene; tries for 5 s. Starts one thread, for
/// the network, in which all signals are blocked. `options` NULL: all defaults. `*session` is NULL unless it
/// returns PALPATE_OK.
PALPATE_API int palpate_session_open(const palpate_session_options* options, palpate_session** session,
                                     char* error, size_t error_size);

/// Runs one tick of the haptic loop, 100 to 4000 times a second, evenly. Sends `tool`, and returns the force
/// on it by the chosen law, through the complete safety ladder (README.md of Palpate, "The safety ladder").
/// Read the device right before it, as the age of the force counts from this call. A pose that is not finite,
/// beyond 1e9 m or turned by no unit quaternion counts as PALPATE_LOST: no force at once, and again over 1 s.
/// Where it does not return PALPATE_OK, write zero force to the motors. Haptic thread. No watchdog guards the
/// loop of the caller: should it stop, the device holds its last force unless its driver ends it.
PALPATE_API int palpate_session_tick(palpate_session* session, const palpate_tool_state* tool,
                                     palpate_rendered* rendered);

/// Asks the next tick to clear a latched fault; the force rises again over 1 s. Any thread.
PALPATE_API int palpate_session_rearm(palpate_session* session);

/// Says good-bye to the server and ends the thread. Write zero force to the motors before. No tick may run.
PALPATE_API void palpate_session_close(palpate_session* session);

/* ---- Captures: libpalpate-client ---- */

typedef struct palpate_capture palpate_capture;

/// Values of `type`; others are in Palpate's protocol/README.md.
enum { PALPATE_END = 0, PALPATE_TOOL_STATE = 6, PALPATE_FORCE_SAMPLE = 7, PALPATE_NOT_OURS = 255 };

/// Values of `direction`.
enum { PALPATE_UNKNOWN = 0, PALPATE_TO_SERVER = 1, PALPATE_TO_CLIENT = 2 };

typedef struct palpate_datagram {
  uint32_t struct_size;
  uint32_t type;
  uint32_t direction;
  uint32_t bytes;    ///< as sent, without the headers below UDP
  int64_t time_ns;   ///< of the capture, since 1970
  uint64_t session;  ///< 0: none yet
  uint64_t sequence;
} palpate_datagram;

/// Opens a pcap or pcapng file, of --record, `sim_server record` or tcpdump. `*capture` is NULL unless it
/// returns PALPATE_OK.
PALPATE_API int palpate_capture_open(const char* file, palpate_capture** capture, char* error,
                                     size_t error_size);

/// The next UDP datagram; PALPATE_END behind the last one. A datagram that holds several tool states, as slow
/// links carry them, comes once for each, the oldest first. `tool` is written with PALPATE_TOOL_STATE only,
/// `sample` with PALPATE_FORCE_SAMPLE only; both may be NULL. A capture that breaks off is PALPATE_FAILED
/// there, and PALPATE_END from then on.
PALPATE_API int palpate_capture_next(palpate_capture* capture, palpate_datagram* datagram,
                                     palpate_tool_state* tool, palpate_force_sample* sample, char* error,
                                     size_t error_size);

PALPATE_API void palpate_capture_close(palpate_capture* capture);

#ifdef __cplusplus
}
#endif
#endif
