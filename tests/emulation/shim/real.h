#pragma once
#include <dlfcn.h>
#include <string>

namespace palpate::emulation {

/// The function that the program would have reached without the shim.
template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// The emulator's socket, from USBSHIM; empty: the shim does nothing.
const std::string& emulator_socket();
inline bool active() {
  return !emulator_socket().empty();
}

}  // namespace palpate::emulation
