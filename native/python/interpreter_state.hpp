// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Python.h>
#include <dlfcn.h>

namespace unitylink::python {

// The Python state of a thread that C++ has started. It is kept from the first call to the end of the thread, because
// making it for each step of a plant takes longer than a small step. If the program ends before the thread, the state
// is not freed, because the interpreter does not run any more.
class InterpreterState {
 public:
  InterpreterState() : held_(PyGILState_Ensure()), state_(PyEval_SaveThread()) {}
  InterpreterState(const InterpreterState&) = delete;
  InterpreterState& operator=(const InterpreterState&) = delete;
  ~InterpreterState() {
    if (!ending()) {
      PyEval_RestoreThread(state_);
      PyGILState_Release(held_);
    }
  }

 private:
  static bool ending() noexcept {
#if defined(Py_LIMITED_API)
    // Each version from 3.12 on has this function, by one of two names. The stable ABI has it from 3.13 on.
    static const auto ask = [] {
      void* found = dlsym(RTLD_DEFAULT, "Py_IsFinalizing");
      return reinterpret_cast<int (*)()>(found != nullptr ? found : dlsym(RTLD_DEFAULT, "_Py_IsFinalizing"));
    }();
    return ask == nullptr || ask() != 0;
#elif PY_VERSION_HEX >= 0x030D0000
    return Py_IsFinalizing() != 0;
#else
    return _Py_IsFinalizing() != 0;
#endif
  }

  PyGILState_STATE held_;
  PyThreadState* state_;
};

inline void keep_interpreter_state() { thread_local const InterpreterState kept; }

}  // namespace unitylink::python
