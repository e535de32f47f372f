// URIs inside glTF files.
#pragma once

#include <string>
#include <string_view>

#include "halflight/base/result.h"
#include "halflight/io/read_file.h"

namespace halflight {

// "data:[mime type];base64,..." (RFC 2397, RFC 4648). Only base64, as glTF writers use.
Result<Bytes> decode_data_uri(std::string_view uri, const std::string& where);

// "a%20b" to "a b". A percent sign without two hexadecimal digits stays as it is.
std::string percent_decoded(std::string_view uri);

}  // namespace halflight
