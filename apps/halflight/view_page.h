// The page of the live view, built from web/ and part of the program.
#pragma once

#include "halflight/view/view_routes.h"

namespace halflight::app {

PageFiles view_page();

}  // namespace halflight::app
