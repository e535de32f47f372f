// Which glTF extensions a scene may require.
#pragma once

#include "halflight/io/json_cursor.h"

namespace halflight {

// Throws ReadFailure naming the first entry of extensionsRequired that is not understood.
void check_required_extensions(const JsonCursor& root);

}  // namespace halflight
