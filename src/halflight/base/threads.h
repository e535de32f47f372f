// How many threads the system lets this process start: limits of users and containers are met by
// doing with fewer.
#pragma once

namespace halflight {

// Starts and ends up to `most` threads that all live at once; how many there were.
int startable_threads(int most);

}  // namespace halflight
