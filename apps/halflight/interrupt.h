// Ctrl-C and SIGTERM end the work early with a valid result; a second one ends the program.
#pragma once

#include "halflight/base/progress.h"

namespace halflight::app {

class Interruptible {
 public:
  explicit Interruptible(Progress& progress);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  bool interrupted() const;
};

}  // namespace halflight::app
