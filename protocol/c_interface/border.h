#pragma once
/// Frame of every function of the C interface: it lets no exception out.
#include <algorithm>
#include <cstring>
#include <new>

#include "common/error.h"
#include "protocol/c_interface/palpate.h"

namespace palpate::c_interface {

/// Puts `what` into the caller's text, cut to its room.
inline void report(const char* what, char* error, std::size_t size) noexcept {
  if (error == nullptr || size == 0) return;
  const std::size_t length = std::min(std::strlen(what), size - 1);
  std::memcpy(error, what, length);
  error[length] = 0;
}

/// Runs `body`; what it throws becomes a code and a text.
template <class Body>
int guarded(char* error, std::size_t size, Body&& body) noexcept {
  report("", error, size);
  try {
    body();
    return PALPATE_OK;
  } catch (const Error& e) {
    report(e.what(), error, size);
    return e.exit_code();
  } catch (const std::bad_alloc&) {
    report("not enough memory", error, size);
  } catch (const std::exception& e) {
    report(e.what(), error, size);
  } catch (...) {
    report("failed for a reason that has no name", error, size);
  }
  return PALPATE_FAILED;
}

/// True if the caller passed a struct with the fields of this release; it may have more, of a later one. When
/// fields are appended, this has to allow the size without them, too.
template <class Struct>
bool is_complete(const Struct* s) noexcept {
  constexpr std::uint32_t kLargest = 1 << 16;  // beyond, nobody set it
  return s != nullptr && s->struct_size >= sizeof(Struct) && s->struct_size <= kLargest;
}

/// Throws unless it is.
template <class Struct>
void require_complete(const Struct* s, const char* name) {
  if (!is_complete(s)) fail("{}: NULL, or struct_size is not sizeof ({} bytes)", name, sizeof(Struct));
}

template <class Handle>
void require_handle(const Handle* handle, const char* name) {
  if (handle == nullptr) fail("{}: is NULL", name);
}

}  // namespace palpate::c_interface
